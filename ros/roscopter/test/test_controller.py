# SPDX-License-Identifier: BSD-3-Clause
"""The controller by itself, in front of a vehicle that is where it is put: all modes, gains, silence of its inputs."""

import math

import pytest
from copter_nodes import START_NS, copter, set_values, state
from roscopter_msgs.msg import ControllerCommand, State
from rosflight_msgs.msg import BatteryStatus, Command, Status
from sim_rig import LATCHED, SimPeer, stamp_ns
from std_msgs.msg import String
from std_srvs.srv import Trigger

IGNORE_ALL = 0x3FF


@pytest.fixture
def peer():
    with SimPeer() as it:
        yield it


class Flown:
    """A vehicle without dynamics in front of the controller: it is where it is put."""

    def __init__(self, peer):
        self.peer, self.ns, self.place = peer, START_NS, (0.0, 0.0, 0.0)
        self.commands = peer.listen(Command, "command")
        self.phases = peer.listen(String, "flight_phase", LATCHED)
        self.states = peer.publisher(State, "estimated_state")
        self.status = peer.publisher(Status, "status")
        self.given = peer.publisher(ControllerCommand, "high_level_command")
        self.wanted = ControllerCommand(mode=0, cmd_valid=True)
        self.armed = False
        peer.poll(lambda: all(p.get_subscription_count() for p in (self.states, self.status, self.given)), "subscribers")

    def step(self, status=True, given=True):
        """The Command that answers a State; 50 ms of stamps later than the one before."""
        self.ns += 50_000_000
        if status:
            self.status.publish(Status(armed=self.armed))
        if given:
            self.given.publish(self.wanted)
        self.states.publish(state(self.ns, self.place))
        self.peer.wait(lambda: self.commands and stamp_ns(self.commands[-1]) == self.ns, "a command")
        return self.commands[-1]

    def until(self, condition, what, **how):
        self.peer.poll(lambda: (self.step(**how), condition())[1], what)

    def phase(self):
        return self.phases[-1].data if self.phases else ""

    def take_off(self):
        self.peer.poll(lambda: (self.status.publish(Status()), self.states.publish(state(self.ns, self.place)),
                                self.commands)[2], "a first command")
        self.until(lambda: self.phase() == "disarmed", "phase disarmed")
        assert list(self.commands[-1].u) == [0.0] * 10 and self.commands[-1].mode == Command.MODE_PASS_THROUGH
        self.armed = True
        self.until(lambda: self.phase() == "takeoff", "phase takeoff")
        self.place = (0.0, 0.0, -2.0)
        self.until(lambda: self.phase() == "position_hold", "phase position_hold")
        self.until(lambda: self.phase() == "offboard", "phase offboard")


@pytest.fixture
def flown(peer):
    with copter("controller") as process:
        it = Flown(peer)
        it.process = process
        it.take_off()
        yield it


LEVEL = None  # angles and rates of zero, and a throttle that carries
MODES = [  # mode, four numbers at north 0, east 0, down -2 and heading 0; mode and u[2] to u[5] of the Command
    (0, (0, 0, -2, 0), 2, LEVEL),
    (1, (0, 0, -2, 0.2), 2, (None, 0, 0, 0.2)),
    (2, (0.1, 0, 0, 0.1), 2, (None, 0, -math.atan(0.1), 0.1)),
    (3, (0, 0, 0, -0.2), 2, (None, 0, 0, -0.2)),
    (4, (0, 0, 0, 0), 2, LEVEL),
    (5, (0.1, 0.05, 0, 0.5), 2, (0.5, 0.1, 0.05, 0)),
    (6, (0.2, 0.05, 0.3, 0.4), 2, (0.4, 0.2, 0.05, 0.3)),
    (7, (0.2, -0.1, 0.3, 0.45), 1, (0.45, 0.2, -0.1, 0.3)),
    (8, (0.2, -0.1, 0.3, 33.0), 0, (-33.0, 0.2, -0.1, 0.3)),
    (9, (0.15, 0.05, 0, 34.3), 2, (None, 0.15, 0.05, 0)),
    (10, (0.25, 0.05, 0.2, 34.3), 2, (None, 0.25, 0.05, 0.2)),
    (11, (0.25, 0.15, 0.1, 34.3), 1, (None, 0.25, 0.15, 0.1)),
]


def test_all_modes_reach_the_firmware_and_gains_act(flown):
    def given(mode, numbers):
        flown.wanted = ControllerCommand(mode=mode, cmd_valid=True, **{f"cmd{k + 1}": float(x) for k, x in enumerate(numbers)})

    def matches(mode, wanted):
        command = flown.commands[-1]
        wanted = (None, 0, 0, 0) if wanted is LEVEL else wanted
        close = all(x is None or abs(u - x) < 1e-3 for u, x in zip(command.u[2:6], wanted))
        return command.mode == mode and close and abs(command.u[2]) > 0.3 and command.ignore == 0
    for mode, numbers, firmware_mode, wanted in MODES:
        given(mode, numbers)
        flown.until(lambda m=firmware_mode, w=wanted: matches(m, w), f"what mode {mode} gives")

    # Velocity to acceleration in units of gravity: 0.2 g s/m times 0.5 m/s is 0.1 g, a pitch of -atan 0.1.
    alone = {f"vel_n_to_accel_{k}": v for k, v in (("kp", 0.2), ("ki", 0.0), ("kd", 0.0))}
    assert all(result.successful for result in set_values(flown.peer, "controller", **alone))
    given(3, (0.5, 0, 0, 0))
    flown.until(lambda: matches(2, (None, 0, -math.atan(0.1), 0)), "the pitch of the new gain")
    assert set_values(flown.peer, "controller", min_throttle=0.55)[0].successful
    given(6, (0.2, 0.05, 0.3, 0.4))
    flown.until(lambda: matches(2, (0.55, 0.2, 0.05, 0.3)), "the new least throttle")
    refused = set_values(flown.peer, "controller", max_throttle=0.3)[0]
    assert not refused.successful and "min_throttle: found 0.55, allowed less than max_throttle, 0.3" in refused.reason
    assert flown.phase() == "offboard"


def test_the_controller_holds_without_commands_and_hands_over_without_state(flown):
    flown.until(lambda: flown.phase() == "position_hold", "a hold command_timeout_s after the last command", given=False)
    held = flown.commands[-1]
    assert held.mode == Command.MODE_ROLL_PITCH_YAWRATE_THROTTLE and held.ignore == 0 and 0.3 < held.u[2] < 0.9
    flown.until(lambda: flown.phase() == "offboard", "commands followed again")
    for bad in (ControllerCommand(mode=12, cmd_valid=True), ControllerCommand(mode=0, cmd1=math.nan, cmd_valid=True),
                ControllerCommand(mode=0, cmd_valid=False)):
        flown.wanted = bad
        flown.until(lambda: flown.phase() == "position_hold", f"no flying of {bad}")
        flown.wanted = ControllerCommand(mode=0, cmd3=-2.0, cmd_valid=True)
        flown.until(lambda: flown.phase() == "offboard", "commands followed again")
    flown.peer.wait(lambda: flown.commands[-1].ignore == IGNORE_ALL, "the hand-over, state_timeout_s after the last state")
    flown.process.until("estimated_state is silent: the vehicle is the pilot's")
    flown.until(lambda: flown.phase() == "position_hold", "a hold when the state is back")
    assert flown.commands[-1].ignore == 0
    flown.until(lambda: flown.phase() == "offboard", "commands followed again")
    assert flown.peer.call(Trigger, "controller/land").success
    flown.until(lambda: flown.phase() == "landing", "phase landing")
    flown.armed = False
    flown.until(lambda: flown.phase() == "disarmed", "phase disarmed")
    answer = flown.peer.call(Trigger, "controller/land")
    assert not answer.success and "found phase disarmed, allowed in flight" in answer.message


@pytest.mark.parametrize("voltage, said", [
    (16.8, "found 16.8 V, 2.80 V in each of the 6 cells of the vehicle file, allowed 3.72 to 4.40 V: charge it; battery.cells must"),
    (33.6, "found 33.6 V, 5.60 V in each of the 6 cells of the vehicle file, allowed 3.72 to 4.40 V: battery.cells must")])
def test_a_pack_of_other_cells_than_the_vehicle_file_says_does_not_take_off(peer, voltage, said):
    """It would return and land as soon as it had taken off, or never."""
    with copter("controller") as process:
        flown = Flown(peer)
        battery = peer.publisher(BatteryStatus, "battery")
        peer.poll(battery.get_subscription_count, "a subscriber")

        def step(volts):
            battery.publish(BatteryStatus(voltage=volts, current=1.0))
            flown.step()
        peer.poll(lambda: (flown.status.publish(Status()), flown.states.publish(state(flown.ns, flown.place)),
                           flown.commands)[2], "a first command")
        for _ in range(20):
            step(voltage)
        flown.armed = True
        peer.poll(lambda: (step(voltage), f"no take-off: battery: {said}" in process.text())[1], "the refusal")
        for _ in range(20):
            step(voltage)
        peer.wait(flown.phase, "the first phase, latched")
        assert flown.phase() == "disarmed" and not any(flown.commands[-1].u)
        peer.poll(lambda: (step(25.2), flown.phase() == "takeoff")[1], "the take-off with six full cells")
