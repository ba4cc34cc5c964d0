# SPDX-License-Identifier: BSD-3-Clause
"""Each node of rosplane by itself, fed by an rclpy peer: its contract, what it makes of its input, how it stops."""

import math
import subprocess
from pathlib import Path

import pytest
from geometry_msgs.msg import Vector3Stamped
from plane_rig import NODES, VEHICLE, WITHOUT_VEHICLE, falls_silent, now_ns, start, state
from ros_rig import ROOT, TIMEOUT_S
from rosflight_msgs.msg import Airspeed, Barometer, Command, GNSS, RCRaw, SimState, Status
from rosplane_msgs.msg import ControllerCommands, ControllerInternals, CurrentPath, FlightPhase, State, Waypoint
from sensor_msgs.msg import Imu, MagneticField
from sim_contract import check_module
from sim_rig import ALL, LATCHED, NEWEST, executable, parameter, set_parameters, stamp, stamp_ns
from std_srvs.srv import Trigger
from visualization_msgs.msg import Marker

NAN = math.nan


@pytest.mark.parametrize("name", NODES)
def test_contract(peer, name):
    """Names, topics, types, quality of service and services are those of rosplane."""
    with start(name):
        check_module(peer, NODES[name])


@pytest.mark.parametrize("name", [name for name in NODES if name not in WITHOUT_VEHICLE])
def test_a_vehicle_that_is_none_is_one_line(name):
    words = [executable("rosplane", name), "--ros-args", "-p", "vehicle_file:=/no/such.yaml"]
    done = subprocess.run(words, capture_output=True, text=True, timeout=TIMEOUT_S)
    assert done.returncode == 2
    assert "/no/such.yaml: found no such file, allowed a YAML file" in done.stderr.strip().splitlines()[-1]


@pytest.mark.parametrize("name, words, said", [
    ("controller", ["--ros-args", "-p", f"vehicle_file:={ROOT / 'vehicles/multirotor.yaml'}"],
     "found a vehicle of type multirotor, allowed fixedwing"),
    ("controller", ["total_enrgy"], "control type: found 'total_enrgy', allowed total_energy, successive_loop or vehicle"),
    ("signal_generator", ["--ros-args", "-p", "signal_type:=saw"], "signal_type: found 'saw', allowed step, square"),
    ("signal_generator", ["--ros-args", "-p", "controller_output:=yaw"], "controller_output: found 'yaw', allowed roll"),
    ("input_mapper", ["--ros-args", "-p", "rudder_input:=rc"], "rudder_input: found 'rc', allowed yaw_damper or rc_rudder"),
])
def test_bad_words_are_one_line(name, words, said):
    done = subprocess.run([executable("rosplane", name), *words], capture_output=True, text=True, timeout=TIMEOUT_S)
    assert done.returncode == 2 and said in done.stderr.strip().splitlines()[-1], done.stderr


class Feed:
    """States at the wall's time, until an answer on a topic fulfils a condition."""

    def __init__(self, peer, kind, topic):
        self.peer, self.received = peer, peer.listen(kind, topic)
        self.states = peer.publisher(State, "estimated_state")
        self.others = []

    def also(self, kind, topic, make):
        self.others.append((self.peer.publisher(kind, topic, NEWEST), make))

    def give(self, **fields):
        ns = now_ns()
        for publisher, make in self.others:
            publisher.publish(make(ns))
        self.states.publish(state(ns, **fields))

    def until(self, condition, what, **fields):
        """The first answer from now on that fulfils the condition."""
        first = len(self.received)

        def found():
            self.give(**fields)
            return next((m for m in self.received[first:] if condition(m)), None)
        self.peer.poll(found, what)
        return next(m for m in self.received[first:] if condition(m))


# ---- path_follower -------------------------------------------------------------------------------


def line(ns):
    return stamp(CurrentPath(path_type=CurrentPath.LINE_PATH, va_d=15.0, r=[0.0, 0.0, -60.0], q=[1.0, 0.0, 0.0]), ns)


def orbit(ns):
    return stamp(CurrentPath(path_type=CurrentPath.ORBIT_PATH, va_d=16.0, c=[0.0, 0.0, -70.0], rho=50.0,
                             lamda=CurrentPath.CLOCKWISE), ns)


def test_path_follower_follows_stops_and_takes_gains(peer):
    with start("path_follower", chi_infty=1.2, k_path=0.03, k_orbit=2.0) as process:
        feed = Feed(peer, ControllerCommands, "controller_command")
        for _ in range(20):
            feed.give(east=10.0)
        feed.also(CurrentPath, "current_path", line)
        # chi_c = -chi_infty 2/pi atan(k_path e): Beard & McLain, Small Unmanned Aircraft, 2012, eq. 10.8
        course = -1.2 * 2 / math.pi * math.atan(0.03 * 10.0)
        answer = feed.until(lambda m: abs(m.chi_c - course) < 1e-4, "a course to the line", east=10.0)
        assert (answer.va_c, answer.h_c, answer.aux_valid, answer.aux[0]) == (15.0, 60.0, True, 0.0)
        assert stamp_ns(answer) in range(stamp_ns(feed.received[0]), now_ns())  # that of the state

        assert set_parameters(peer, "path_follower", k_path=0.1)[0].successful
        course = -1.2 * 2 / math.pi * math.atan(0.1 * 10.0)
        feed.until(lambda m: abs(m.chi_c - course) < 1e-4, "the new gain", east=10.0)
        refused = set_parameters(peer, "path_follower", k_path=-1.0)[0]
        assert not refused.successful and refused.reason
        assert parameter(peer, "path_follower", "k_path").double_value == 0.1

        feed.others = []
        feed.also(CurrentPath, "current_path", orbit)
        # 20 m outside of the circle, due north of it: chi_c = pi/2 + atan(k (d - rho)/rho), eq. 10.14
        answer = feed.until(lambda m: m.va_c == 16.0, "an orbit", north=70.0, course=math.pi / 2)
        assert answer.chi_c == pytest.approx(math.pi / 2 + math.atan(2.0 * 20 / 50), abs=1e-4)
        assert answer.h_c == 70.0
        on_it = feed.until(lambda m: abs(m.chi_c - math.pi / 2) < 1e-3, "the circle itself", north=50.0, course=math.pi / 2)
        assert on_it.phi_ff == pytest.approx(math.atan(15.0**2 / (9.80665 * 50)), rel=1e-3)  # coordinated turn

        # No path any more: commands end, and it reports that once.
        feed.others = []
        peer.poll(lambda: feed.give() or "current_path is silent" in process.text(), "a word about the silence")
        assert falls_silent(feed.received, feed.give) and process.text().count("is silent") == 1


@pytest.mark.parametrize("broken", [{"q": [0.0, 0.0, 0.0]}, {"q": [0.0, 0.0, 1.0]}, {"q": [NAN, 0.0, 0.0]},
                                    {"path_type": 7}, {"va_d": NAN}, {"path_type": 0, "rho": 0.0}])
def test_path_follower_follows_nothing_that_is_no_path(peer, broken):
    with start("path_follower"):
        feed = Feed(peer, ControllerCommands, "controller_command")
        feed.also(CurrentPath, "current_path", line)
        feed.until(lambda m: True, "a command")

        def bad(ns):
            message = line(ns)
            for name, value in broken.items():
                setattr(message, name, value)
            return message
        feed.others = []
        feed.also(CurrentPath, "current_path", bad)
        assert falls_silent(feed.received, feed.give)


# ---- controller ----------------------------------------------------------------------------------


def wanted(course=0.0, **more):
    return lambda ns: stamp(ControllerCommands(va_c=15.0, h_c=60.0, chi_c=course, **more), ns)


def phase(number, **given):
    def make(ns):
        message = stamp(FlightPhase(phase=number, idle=number == FlightPhase.DISARMED), ns)
        for name in ("roll", "pitch", "climb_rate", "throttle", "ground_course", "glide_airspeed", "min_pitch", "max_pitch",
                     "max_roll", "max_throttle"):
            setattr(message, name, given.get(name, NAN))
        return message
    return make


def status(armed=True):
    return lambda ns: stamp(Status(armed=armed), ns)


def bank_of(feed, condition, what, **fields):
    """Flies until controller_internals fulfils the condition."""
    inner = feed.inner
    first = len(inner)
    feed.peer.poll(lambda: feed.give(**fields) or any(condition(m) for m in inner[first:]), what)
    return next(m for m in inner[first:] if condition(m))


@pytest.mark.parametrize("law", ["total_energy", "successive_loop"])
def test_controller_flies_stops_and_takes_gains(peer, law, tmp_path):
    from sim_rig import Process
    # The state stands still whatever the surfaces do: ailerons are not watched.
    vehicle = tmp_path / "unwatched.yaml"
    unwatched = "autonomy:\n  controller: {full_aileron_rad_s: 0}\n"
    vehicle.write_text(Path(VEHICLE).read_text().replace("autonomy:\n", unwatched, 1))
    with Process(executable("rosplane", "controller"), law, "--ros-args", "-p", f"vehicle_file:={vehicle}",
                 "-p", "max_roll:=30.0") as process:
        process.until("ready")
        feed = Feed(peer, Command, "command")
        feed.inner = peer.listen(ControllerInternals, "controller_internals")
        feed.also(Status, "status", status())
        feed.also(FlightPhase, "flight_phase", phase(FlightPhase.DISARMED))
        on_ground = feed.until(lambda m: True, "a command on the ground", height=0.0)
        assert on_ground.mode == Command.MODE_PASS_THROUGH and on_ground.ignore == 0 and not any(on_ground.u)

        feed.others = feed.others[:1]
        feed.also(FlightPhase, "flight_phase", phase(FlightPhase.MISSION))
        feed.also(ControllerCommands, "controller_command", wanted(math.pi / 2))
        turning = feed.until(lambda m: m.u[3] > 0.3, "aileron for a turn to the right")
        assert 0.0 < turning.u[0] <= 1.0 and not any(turning.u[6:])
        assert abs(bank_of(feed, lambda m: abs(m.phi_c - math.radians(30.0)) < 1e-3, "the limit of the bank").theta_c) < 0.5
        assert bank_of(feed, lambda m: True, "a zone").alt_zone == ControllerInternals.ZONE_ALTITUDE_HOLD

        assert all(r.successful for r in set_parameters(peer, "controller", max_roll=15.0))
        bank_of(feed, lambda m: abs(m.phi_c - math.radians(15.0)) < 1e-3, "the new limit")
        assert all(r.successful for r in set_parameters(peer, "controller", r_kp=0.0, r_ki=0.0, r_kd=0.0))
        feed.until(lambda m: m.u[3] == 0.0, "no aileron without gains")
        refused = set_parameters(peer, "controller", r_kp=-0.5)[0]
        assert not refused.successful and refused.reason

        # The command's own roll and pitch, with ROSflight 2.x's override parameters.
        assert all(r.successful for r in set_parameters(peer, "controller", roll_command_override=True,
                                                        pitch_command_override=True, max_roll=45.0))
        feed.others.pop()
        feed.also(ControllerCommands, "controller_command", wanted(0.0, phi_c=-0.2, theta_c=0.1))
        inner = bank_of(feed, lambda m: abs(m.phi_c + 0.2) < 1e-3, "the roll of the command")
        assert inner.theta_c == pytest.approx(0.1)
        assert all(r.successful for r in set_parameters(peer, "controller", roll_command_override=False,
                                                        pitch_command_override=False))
        # Commands end: it circles at lost_roll_deg of the vehicle file. Phases end too: it flies on.
        feed.others = feed.others[:1]
        bank_of(feed, lambda m: abs(m.phi_c - math.radians(20.0)) < 1e-3, "the circle of a lost fixed wing")
        process.until("controller_command is silent: circles")
        # The state ends: every entry goes to the pilot, until it is back.
        count = len(feed.received)
        peer.wait(lambda: any(m.ignore == 0x3FF for m in feed.received[count:]), "the pilot's turn")
        process.until("estimated_state is silent: the pilot has control")
        feed.until(lambda m: m.ignore == 0, "flight again")
        # A state that is none counts as silence.
        broken = feed.received[:]
        peer.poll(lambda: feed.give(height=NAN) or any(m.ignore == 0x3FF for m in feed.received[len(broken):]), "no trust in NaN")


def test_controller_says_that_the_ailerons_have_no_effect_and_banks_by_the_rudder(peer):
    from sim_rig import Process
    with Process(executable("rosplane", "controller"), "--ros-args", "-p", f"vehicle_file:={VEHICLE}") as process:
        process.until("ready")
        feed = Feed(peer, Command, "command")
        feed.inner = peer.listen(ControllerInternals, "controller_internals")
        feed.also(Status, "status", status())
        feed.also(FlightPhase, "flight_phase", phase(FlightPhase.MISSION))
        feed.also(ControllerCommands, "controller_command", wanted(math.pi / 2))
        feed.until(lambda m: m.u[5] > 0.1, "a rudder for the turn to the right")
        process.until("the ailerons have no effect: the rudder rolls")
        bank_of(feed, lambda m: abs(m.phi_c - math.radians(15.0)) < 1e-3, "a bank of 15 degrees")


def test_controller_takes_off_by_itself_without_a_path_manager(peer):
    with start("controller", alt_toz=5.0, alt_hz=10.0, max_takeoff_throttle=0.8):
        feed = Feed(peer, Command, "command")
        feed.inner = peer.listen(ControllerInternals, "controller_internals")
        feed.also(Status, "status", status())
        assert not any(feed.until(lambda m: True, "a command", height=0.0).u)  # nobody wants anything
        feed.also(ControllerCommands, "controller_command", wanted(1.0))
        assert feed.until(lambda m: m.u[0] > 0.5, "take-off", height=0.0, airspeed=5.0).u[0] <= 0.8 + 1e-6
        assert bank_of(feed, lambda m: True, "a zone", height=0.0).alt_zone == ControllerInternals.ZONE_TAKE_OFF
        climb = bank_of(feed, lambda m: m.alt_zone == ControllerInternals.ZONE_CLIMB, "the climb", height=20.0)
        assert climb.phi_c == pytest.approx(0.0, abs=0.05)
        bank_of(feed, lambda m: m.alt_zone == ControllerInternals.ZONE_ALTITUDE_HOLD and m.phi_c > 0.1, "the course", height=55.0)


# ---- estimator -----------------------------------------------------------------------------------


class Sensors:
    """What an aircraft's sensors measure while it stands at 1400 m, 100 times a second of its own time."""

    def __init__(self, peer):
        self.peer, self.ns, self.ticks = peer, 1_000_000_000_000, 0
        self.states = peer.listen(State, "estimated_state")
        self.to = {topic: peer.publisher(kind, topic, ALL) for topic, kind in NODES["estimator"].inputs.items()}
        self.gnss, self.armed = True, False

    def tick(self):
        self.ns += 10_000_000
        self.ticks += 1

        def send(topic, message):
            self.to[topic].publish(stamp(message, self.ns))
        if self.ticks % 10 == 0:
            send("status", Status(armed=self.armed))
        if self.ticks % 2 == 0:
            send("baro", Barometer(pressure=85600.0))
            field = MagneticField()
            field.magnetic_field.x, field.magnetic_field.z = 2.1e-5, 4.6e-5
            send("magnetometer", field)
            send("airspeed", Airspeed(differential_pressure=0.0))
        if self.ticks % 20 == 0 and self.gnss:
            send("gnss", GNSS(fix_type=GNSS.GNSS_FIX_TYPE_3D_FIX, lat=40.0, lon=-111.0, alt=1400.0))
        imu = Imu()
        imu.linear_acceleration.z = -9.80665
        send("imu/data", imu)

    def run(self, seconds):
        """Each tick waits for its state, so that none is lost."""
        for _ in range(round(100 * seconds)):
            count = len(self.states)
            self.tick()
            self.peer.wait(lambda c=count: len(self.states) > c, "a state")
        return self.states[-1]


def test_estimator_starts_tells_and_says_what_it_does_not_know(peer):
    with start("estimator", declination=10.0, estimator_update_frequency=200.0) as process:
        sensors = Sensors(peer)
        peer.poll(lambda: sensors.tick() or sensors.states, "a first state")
        still = sensors.run(1.0)
        assert (still.initial_lat, still.initial_lon) == pytest.approx((40.0, -111.0))
        assert math.hypot(still.p_n, still.p_e, still.p_d) < 1.0 and abs(still.phi) < 0.01
        assert still.psi == pytest.approx(math.radians(10.0), abs=0.01)  # the field points to magnetic north
        assert stamp_ns(still) == sensors.ns and math.isnan(still.w_n)
        # Armed and without GNSS for longer than dead_reckoning_s: it reports an unknown position and goes on.
        sensors.armed, sensors.gnss = True, False
        lost = sensors.run(32.0)
        assert math.isnan(lost.p_n) and math.isnan(lost.p_e)
        assert math.isfinite(lost.p_d) and abs(lost.phi) < 0.05
        sensors.gnss = True
        assert math.isfinite(sensors.run(2.0).p_n)
        # No IMU: no state.
        process.until("imu/data is silent")
        count = len(sensors.states)
        sensors.to["baro"].publish(stamp(Barometer(pressure=85600.0), sensors.ns + 10_000_000))
        assert len(sensors.states) == count


# ---- tools ---------------------------------------------------------------------------------------


def test_truth_becomes_a_state(peer):
    with start("sim_state_transcriber"):
        received = peer.listen(State, "sim/rosplane/state")
        truth = peer.publisher(SimState, "sim/truth_state")
        message = SimState()
        message.pose.position.x, message.pose.position.z = 3.0, -40.0
        half = math.radians(15.0)  # 30 degrees of heading
        message.pose.orientation.w, message.pose.orientation.z = math.cos(half), math.sin(half)
        message.twist.linear.x, message.twist.linear.y, message.twist.linear.z = 15.0, 0.0, 1.5
        peer.poll(lambda: truth.publish(stamp(message, now_ns())) or received, "a state")
        out = received[-1]
        assert (out.p_n, out.p_e, out.p_d, out.v_x) == (3.0, 0.0, -40.0, 15.0)
        assert out.psi == pytest.approx(math.radians(30.0), abs=1e-6) and out.chi == pytest.approx(out.psi, abs=1e-6)
        assert out.va == pytest.approx(math.hypot(15.0, 1.5)) and out.alpha == pytest.approx(math.atan2(1.5, 15.0))
        assert (out.initial_lat, out.initial_alt) == (40.2463724, 1387.0)  # of the vehicle file


def test_the_truth_is_subscribed_to_while_somebody_reads_its_copy(peer):
    publishers = [peer.publisher(kind, f"sim/truth_{name}")
                  for kind, name in ((SimState, "state"), (Vector3Stamped, "wind"), (Imu, "imu_bias"))]

    def counts():
        return {publisher.get_subscription_count() for publisher in publishers}
    with start("sim_state_transcriber"):
        peer.poll(lambda: peer.node.count_publishers("sim/rosplane/state") == 1, "the node's topic")
        for _ in range(2):
            peer.poll(lambda: counts() == {0}, "an end of the subscriptions")
            with peer.reads(State, "sim/rosplane/state"):
                peer.poll(lambda: counts() == {1}, "the subscriptions")


def test_signal_generator_puts_its_signal_on_one_command(peer):
    with start("signal_generator", controller_output="altitude", signal_type="step", signal_magnitude=10.0, default_h_c=60.0):
        received = peer.listen(ControllerCommands, "controller_command")
        peer.wait(lambda: received, "a command")
        assert (received[-1].h_c, received[-1].va_c, received[-1].phi_c) == (60.0, 15.0, 0.0)
        assert peer.call(Trigger, "toggle_step_signal").success
        peer.wait(lambda: received[-1].h_c == 70.0, "the step")
        assert not peer.call(Trigger, "start_continuous_signal").success  # a step has no periods
        assert all(r.successful for r in set_parameters(peer, "signal_generator", controller_output="course", default_h_c=50.0))
        peer.wait(lambda: received[-1].h_c == 50.0 and received[-1].chi_c == 10.0, "another output")
        refused = set_parameters(peer, "signal_generator", controller_output="yaw")[0]
        assert not refused.successful and "allowed roll" in refused.reason


def test_input_mapper_mixes_axis_by_axis(peer):
    with start("input_mapper"), start("controller"):
        feed = Feed(peer, ControllerCommands, "mapped_controller_command")
        mapped = peer.listen(Command, "mapped_command")
        feed.also(ControllerCommands, "input_controller_command", wanted(1.0))
        feed.also(Command, "input_command", lambda ns: stamp(Command(ignore=0x2), ns))
        assert feed.until(lambda m: True, "a command").chi_c == 1.0  # all of the autopilot
        peer.poll(lambda: feed.give() or mapped, "an output")
        assert mapped[-1].ignore == 0x2

        # The pilot's angles: full right stick, and the controller is set to take them.
        feed.also(RCRaw, "rc_raw", lambda ns: stamp(RCRaw(values=[2000, 1250, 1500, 1500, 1000, 1000, 1000, 1000]), ns))
        assert peer.call(Trigger, "input_mapper/set_angle_control_mode").success
        answer = feed.until(lambda m: m.phi_c > 0.4, "the stick's angle")
        assert answer.phi_c == pytest.approx(0.5) and answer.theta_c == pytest.approx(-0.25)
        for name in ("roll_command_override", "pitch_command_override"):
            peer.poll(lambda n=name: parameter(peer, "controller", n).bool_value, f"{name} of the controller")
        assert parameter(peer, "input_mapper", "aileron_input").string_value == "rc_roll_angle"
        # Rates: the course moves with the stick from where it is.
        assert peer.call(Trigger, "input_mapper/set_altitude_course_airspeed_control_mode").success
        first = feed.until(lambda m: abs(m.chi_c - 0.3) < 0.1, "a course from that of the state", course=0.3).chi_c
        feed.until(lambda m: m.chi_c > first + 0.05, "a course that moves right", course=0.3)
        feed.until(lambda m: m.h_c < 59.9, "a height that goes down", course=0.3)
        # Straight through: the bits of all four outputs.
        assert peer.call(Trigger, "input_mapper/set_rc_passthrough_mode").success
        peer.poll(lambda: feed.give() or mapped[-1].ignore == 0x2 | 0x8 | 0x10 | 0x1 | 0x20, "all outputs for the pilot")
        peer.poll(lambda: not parameter(peer, "controller", "roll_command_override").bool_value, "the override's end")
        assert peer.call(Trigger, "input_mapper/set_path_follower_mode").success
        peer.poll(lambda: feed.give() or mapped[-1].ignore == 0x2, "the autopilot again")
        refused = set_parameters(peer, "input_mapper", aileron_input="rc_altitude")[0]
        assert not refused.successful and "allowed path_follower" in refused.reason


def test_waypoints_are_shown_in_rviz(peer):
    waypoints = peer.publisher(Waypoint, "waypoint_path", LATCHED)
    for north in (100.0, 300.0):
        waypoints.publish(Waypoint(w=[north, -50.0, -60.0]))
    with start("rviz_waypoint_publisher"):
        received = peer.listen(Marker, "rviz/waypoint", LATCHED)
        peer.wait(lambda: [m.text for m in received if m.type == Marker.TEXT_VIEW_FACING] == ["1", "2"], "two numbers")
    line = [m for m in received if m.type == Marker.LINE_STRIP][-1]
    assert [(p.x, p.y, p.z) for p in line.points] == [(100.0, -50.0, -60.0), (300.0, -50.0, -60.0)]
    assert line.header.frame_id == "NED"
