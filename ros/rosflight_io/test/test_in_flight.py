# SPDX-License-Identifier: BSD-3-Clause
"""Faults in flight: the vehicle is in the air, its pilot's sticks hold it level, and ROS leans it. The node is in simulated time,
which goes on with the wall's from FIRST_S."""

import math
import re
import signal
import time

import pytest
import yaml
from io_streams import STREAMS
from ros_rig import ROOT, Rig, wait_for, write_parameters
from rosflight_msgs.msg import Attitude, Command, Status
from rosflight_msgs.srv import ParamFile
from rosgraph_msgs.msg import Clock
from sim_rig import BEST_EFFORT, SimPeer, stamp_ns
from std_srvs.srv import Trigger

FIRST_S = 103.0  # the first tick
TICK_S = 0.005
WITHOUT_TIME_S = 1.0  # of the node, with a board that sends
ARM_S, TAKE_OFF_S, RELEASE_S = 20.0, 21.5, 23.0  # after all has been set up
THROTTLE = 0.75  # of RC_MAX_THR: climbs slowly, for as long as the tests take
LEAN_RAD = 0.2
LEVEL_RAD = 0.05
GNSS_DELAY_S = 0.3  # longer than it takes to synchronise: fixes of before the first tick are received after it
IGNORE_ALL = sum(getattr(Command, f"IGNORE_VALUE{k}") for k in range(10))
EMPTY = re.compile(r"pass-through commands in flight that are all zeros, which stops the motors: (\d+)")
ABSENT_ALOFT = {"range"}  # the vehicle climbs out of its reach while a slow machine is at work


def pilot(folder):
    script = folder / "rc.yaml"
    script.write_text(f"""start: {{throttle: 0.0, attitude_override: 1.0, attitude_mode: 1.0}}
events:
  - {{at_s: {ARM_S}, switch: arm, on: true}}
  - {{at_s: {TAKE_OFF_S}, ramp: throttle, to: {THROTTLE}, over_s: 0.5}}
  - {{at_s: {RELEASE_S}, switch: attitude_override, on: false}}
""")
    return script


class SimulatedTime:
    """Publishes /clock from WITHOUT_TIME_S after somebody subscribes to it, and keeps all that rosflight_io publishes."""

    def __init__(self, peer):
        self.received = {name: peer.listen(kind, name) for name, kind in STREAMS.items()}
        self.clock = peer.publisher(Clock, "/clock", BEST_EFFORT)
        self.subscribed_s = self.begin_s = self.early = None
        peer.node.create_timer(TICK_S, self._tick)

    def now_s(self):
        return FIRST_S + time.monotonic() - self.begin_s

    def _tick(self):
        if self.subscribed_s is None:
            if self.clock.get_subscription_count():
                self.subscribed_s = time.monotonic()
            return
        if self.begin_s is None:
            if time.monotonic() - self.subscribed_s < WITHOUT_TIME_S:
                return
            self.early = self.counts()
            self.begin_s = time.monotonic()
        message = Clock()
        message.clock.sec, message.clock.nanosec = divmod(int(self.now_s() * 1e9), 1_000_000_000)
        self.clock.publish(message)

    def counts(self):
        return {name: len(messages) for name, messages in self.received.items()}

    def counts_at_rest(self):
        """When what is under way has come."""
        counts = None
        while counts != self.counts():
            counts = self.counts()
            time.sleep(0.2)
        return counts

    def first_s(self, counts):
        """Earliest stamp of each topic behind so many messages; waits until there is one of each but those of ABSENT_ALOFT."""
        def new(name):
            return list(self.received[name])[counts[name]:]
        wait_for(lambda: all(new(name) for name in counts.keys() - ABSENT_ALOFT), "all topics", self.counts)
        return {name: min(map(stamp_ns, new(name))) * 1e-9 for name in counts if new(name)}


class Flight:
    """A vehicle in the air. `lean` publishes a roll angle at 50 Hz as long as it is not None; the throttle stays the
    pilot's. `empty` publishes pass-through commands without a value, which the firmware ignores."""

    def __init__(self, folder, **options):
        late = f"vehicle.sensors.gnss.delay_us={GNSS_DELAY_S * 1e6:.0f}"
        self.rig = Rig(folder, "--rc", pilot(folder), "--set", late, **options)
        self.attitude = self.rig.peer.listen(Attitude, "attitude")
        self.status = self.rig.peer.listen(Status, "status")
        self.publisher = self.rig.peer.node.create_publisher(Command, "command", 1)
        self.lean, self.empty = None, False
        self.rig.peer.node.create_timer(0.02, self._publish)

    def take_off(self):
        folder = self.rig.folder
        firmware = yaml.safe_load((ROOT / "vehicles/multirotor.yaml").read_text())["firmware"]
        write_parameters(folder / "vehicle.yaml", firmware)
        answer = self.rig.peer.call(ParamFile, "param_load_from_file", filename=str(folder / "vehicle.yaml"))
        assert answer.success, self.rig.io.lines[-10:]
        assert self.rig.peer.call(Trigger, "calibrate_imu").success
        assert self.rig.peer.call(Trigger, "param_write").success
        assert not (self.status and self.status[-1][1].armed), "the pilot armed before all was set up"
        wait_for(lambda: self.status and self.status[-1][1].armed, "arming", lambda: self.rig.io.lines[-10:])

    def _publish(self):
        if self.lean is not None:
            command = Command(mode=Command.MODE_ROLL_PITCH_YAWRATE_THROTTLE)
            command.ignore = Command.IGNORE_VALUE0 | Command.IGNORE_VALUE1 | Command.IGNORE_VALUE2
            command.u[3] = self.lean
            self.publisher.publish(command)
        if self.empty:
            self.publisher.publish(Command(mode=Command.MODE_PASS_THROUGH, ignore=IGNORE_ALL))

    def roll(self):
        q = self.attitude[-1][1].attitude
        return math.atan2(2 * (q.w * q.x + q.y * q.z), 1 - 2 * (q.x ** 2 + q.y ** 2))

    def wait_roll(self, wanted_rad, offboard):
        """Until the vehicle leans so, commanded by ROS or by the pilot. A busy machine has pauses that are longer than a command is valid."""
        def state():
            return self.roll(), self.status[-1][1].offboard
        wait_for(lambda: abs(state()[0] - wanted_rad) < LEVEL_RAD and state()[1] == offboard, f"roll {wanted_rad}, {offboard=}", state)

    def wait_new(self, count=10):
        """Until so many states arrived after this moment."""
        before = len(self.status)
        wait_for(lambda: len(self.status) >= before + count, "states", lambda: self.rig.io.lines[-10:])

    def close(self):
        self.lean = None
        self.rig.close()


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    with SimPeer("time") as peer:
        simulated = SimulatedTime(peer)
        flight = Flight(tmp_path_factory.mktemp("flight"), node_arguments=["-p", "use_sim_time:=true"])
        flight.time = simulated
        try:
            flight.take_off()
            yield flight
        finally:
            flight.close()


def test_no_message_is_older_than_the_first_tick(flight):
    assert set(flight.time.early.values()) == {0}, "published while there was no time"
    assert min(flight.time.first_s(flight.time.early).values()) >= FIRST_S


def test_ros_leans_the_vehicle_and_the_pilot_has_it_back_when_ros_stops(flight):
    flight.lean = LEAN_RAD
    flight.wait_roll(LEAN_RAD, offboard=True)
    flight.lean = None
    flight.wait_roll(0.0, offboard=False)
    assert flight.status[-1][1].armed


def test_commands_without_a_value_are_logged_once_a_second_with_their_number(flight):
    flight.lean = LEAN_RAD
    flight.wait_roll(LEAN_RAD, offboard=True)
    begin_s, flight.empty = flight.time.now_s(), True

    def counts():
        return [int(found[1]) for line in flight.rig.io.lines if (found := EMPTY.search(line))]
    wait_for(lambda: len(counts()) >= 3, "three lines", lambda: flight.rig.io.lines[-10:])
    assert len(counts()) < flight.time.now_s() - begin_s + 1.5
    assert counts()[0] == 1 and counts()[2] > 10, "those of a second, at 50 Hz, however slow the machine"
    flight.lean, flight.empty = None, False


def test_node_killed_in_flight_pilot_has_it_then_ros_again(flight):
    flight.lean = LEAN_RAD
    flight.wait_roll(LEAN_RAD, offboard=True)
    flight.rig.io.stop(signal.SIGKILL)
    flight.lean = None
    before, killed_s = flight.time.counts_at_rest(), flight.time.now_s()
    flight.rig.start_io()
    flight.wait_new()
    state = flight.status[-1][1]
    assert state.armed and not state.failsafe and not state.offboard
    first_s = flight.time.first_s(before)
    assert min(first_s.values()) >= killed_s, first_s
    flight.wait_roll(0.0, offboard=False)
    flight.lean = -LEAN_RAD
    flight.wait_roll(-LEAN_RAD, offboard=True)
    flight.lean = None
