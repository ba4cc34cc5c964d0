# SPDX-License-Identifier: BSD-3-Clause
"""The package own_modules: built outside the tree as its README says, then flown; and what each base class promises, one by one."""

import math
import os
import re
import shutil
import subprocess

import copter_flight
import plane_flight
import pytest
from geometry_msgs.msg import WrenchStamped
from ros_rig import ROOT
from roscopter_msgs.msg import ControllerCommand, State, TrajectoryCommand, Waypoint
from rosflight_msgs.msg import Barometer, Command, GNSS, PwmOutput, SimState, Status
from rosflight_msgs.srv import ParamGet, SetSimState
from rosgraph_msgs.msg import Clock
from rosplane_msgs.msg import ControllerCommands, ControllerInternals, CurrentPath
from rosplane_msgs.msg import State as PlaneState
from rosplane_msgs.msg import Waypoint as PlaneWaypoint
from sensor_msgs.msg import Imu
from sim_rig import ALL, ALL_BEST_EFFORT, LATCHED, Process, SimPeer, set_parameters, sim_state, stamp, stamp_ns
from std_msgs.msg import Bool
from std_srvs.srv import Trigger

STEP_NS = 2_500_000


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """The copied package, built and installed far from the tree by the commands of its README. find_package(rosflight) must not be
    needed."""
    folder = tmp_path_factory.mktemp("elsewhere") / "own_modules"
    shutil.copytree(ROOT / "ros/examples/own_modules", folder)
    commands = re.findall(r"^    (cmake .*)$", (folder / "README.md").read_text(), re.M)
    assert len(commands) == 2
    environment = {name: value for name, value in os.environ.items() if name != "rosflight_DIR"}
    done = subprocess.run(["bash", "-ec", "\n".join(commands)], cwd=folder, capture_output=True, text=True,
                          env={**environment, "CMAKE_CXX_COMPILER_LAUNCHER": "ccache", "CMAKE_GENERATOR": "Ninja"})
    assert done.returncode == 0, (done.stdout + done.stderr)[-6000:]
    return folder / "install"


@pytest.fixture
def peer():
    with SimPeer() as peer:
        yield peer


def own(installed, program, nodes=1):
    process = Process(installed / "lib/own_modules" / program)
    process.until("ready", times=nodes)
    return process


@pytest.fixture
def found(installed, monkeypatch):
    """`ros2 launch` finds the package."""
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{installed}:{os.environ['AMENT_PREFIX_PATH']}")


@pytest.mark.parametrize("guidance", ("roscopter", "own"))
def test_a_copter_flies_a_mission_on_derived_classes(found, tmp_path, guidance):
    with copter_flight.Flight("own_modules", "fly.launch.xml", tmp_path, wait_for="sim/RC high_level_command command",
                              own_guidance=str(guidance == "own").lower()) as flight:
        flight.set_up()
        flight.process.until("read mixer 2 of the firmware")  # as vehicles/multirotor.yaml has it
        for topic in ("/sim/forces_and_moments", "/sim/truth_state", "/sim/sensors/imu/data", "/high_level_command", "/command"):
            assert len(flight.peer.node.get_publishers_info_by_topic(topic)) == 1, topic
        flight.take_off()
        flight.until_phase("offboard")
        assert -2.0 > flight.place()[2] > -3.2, "up at takeoff_d_pos, which the launch file gives"
        flight.until(lambda: math.dist(flight.place(), (4, 4, -3)) < 0.5, "the last waypoint")
        assert flight.nearest_to((4, 0, -3)) < 1.0
        assert [p.data for p in flight.phases][-3:] == ["takeoff", "position_hold", "offboard"]
        assert not any(s.failsafe for s in flight.status)


def test_a_plane_flies_a_mission_on_derived_classes(found, tmp_path):
    with plane_flight.Flight("own_modules", "fly_plane.launch.xml", tmp_path, wait_for="sim/RC controller_command command") as flight:
        flight.set_up()
        flight.arm()
        flight.let_go()
        flight.until(lambda: flight.inner[-1].alt_zone == ControllerInternals.ZONE_ALTITUDE_HOLD, "the zone altitude hold")
        flight.process.until("left the ground")
        aloft = flight.time_s()
        flight.until(lambda: math.dist(flight.place()[:2], (-150, -150)) < 60.0, "the orbit around the last waypoint")
        arrived = flight.time_s()
        flight.until(lambda: flight.time_s() > arrived + 32.0, "an orbit and a half")
        assert flight.nearest_to((300, -150, -40)) < 40.0, "half of R_min before the waypoint it turns"
        orbit = [m.pose.position for m in flight.truth if stamp_ns(m) * 1e-9 > arrived + 20.0]
        assert all(40.0 < math.dist((p.x, p.y), (-150, -150)) < 65.0 and 35.0 < -p.z < 45.0 for p in orbit), "R_min, the altitude"
        speeds = flight.speeds(aloft + 10.0, arrived + 32.0)
        assert 11.5 < min(speeds) and max(speeds) < 19.0
        assert not any(m.failsafe for m in flight.status)


def test_time_goes_on_when_the_world_has_followed(installed):
    with own(installed, "own_world", 3), SimPeer() as peer:
        ticks, truths = peer.listen(Clock, "/clock", ALL_BEST_EFFORT), peer.listen(SimState, "sim/truth_state")
        wrenches = peer.publisher(WrenchStamped, "sim/forces_and_moments")
        peer.introduce(lambda: wrenches.publish(stamp(WrenchStamped(), STEP_NS)), truths, "sim/truth_state")
        assert peer.call(Trigger, "time_manager/toggle_pause").message == "paused"
        def now_ns():
            return ticks[-1].clock.sec * 1_000_000_000 + ticks[-1].clock.nanosec
        count = len(ticks)
        peer.wait(lambda: len(ticks) > count + 1, "the time of the pause, repeated")
        stood = now_ns()
        assert peer.call(Trigger, "time_manager/toggle_pause").message == "running"
        for k in range(1, 20):
            wrenches.publish(stamp(WrenchStamped(), STEP_NS * (k + 1)))
            peer.wait(lambda: truths and stamp_ns(truths[-1]) == STEP_NS * (k + 1), "an answer of the world")
        peer.poll(lambda: now_ns() > stood, "time to go on")
        assert now_ns() <= stood + 21 * STEP_NS, "one step for a truth, and one before the first"


def test_forces_answer_each_pulse_under_its_stamp(installed):
    with own(installed, "own_forces"), SimPeer() as peer:
        wrenches, pulses = peer.listen(WrenchStamped, "sim/forces_and_moments"), peer.publisher(PwmOutput, "sim/pwm_output")
        message = stamp(PwmOutput(values=[1500] * 4 + [1000] * 10), 7 * STEP_NS)
        peer.introduce(lambda: pulses.publish(message), wrenches, "sim/forces_and_moments")
        pulses.publish(message)
        peer.wait(lambda: wrenches, "a wrench")
        assert stamp_ns(wrenches[0]) == 7 * STEP_NS and wrenches[0].header.frame_id == "aircraft_body"
        assert wrenches[0].wrench.force.z == pytest.approx(-4 * 36.0 * 0.25)
        assert wrenches[0].wrench.torque.x == pytest.approx(0, abs=1e-9)


def test_forces_read_the_custom_mixer(installed):
    with own(installed, "own_forces") as program, SimPeer() as peer:
        asked = []

        def answer(request, response):
            asked.append(request.name)
            response.exists, response.value = True, 11.0 if request.name == "PRIMARY_MIXER" else 0.0
            return response
        peer.node.create_service(ParamGet, "param_get", answer)
        program.until("read mixer 11 of the firmware")
        assert len(set(asked)) == 2 + 10 + 200
        assert {"SECONDARY_MIXER", "PRI_MIXER_OUT_9", "SEC_MIXER_9_9"} <= set(asked)
        changes = peer.publisher(Bool, "status/params_changed")
        peer.poll(changes.get_subscription_count, "the subscriber")
        changes.publish(Bool(data=True))
        program.until("read mixer 11 of the firmware", times=2)
        assert len(asked) >= 2 * 212


def test_a_state_is_set_or_refused(installed):
    with own(installed, "own_world", 3), SimPeer() as peer:
        truths = peer.listen(SimState, "sim/truth_state")
        assert peer.call(SetSimState, "dynamics/set_sim_state", state=sim_state(0, -5.0)).success
        peer.wait(lambda: truths and truths[-1].pose.position.z == -5.0, "the truth there")
        assert not peer.call(SetSimState, "dynamics/set_sim_state", state=sim_state(0, 1.0)).success


# ---- roscopter --------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def copter(installed):
    with own(installed, "own_copter", 3) as process:
        yield process


def test_an_estimator_runs_with_the_imu_from_the_first_arming_on(copter, peer):
    states = peer.listen(State, "estimated_state")
    imu, status = peer.publisher(Imu, "imu/data", ALL), peer.publisher(Status, "status")
    gnss, baro = peer.publisher(GNSS, "gnss"), peer.publisher(Barometer, "baro")
    sent = [0]

    def step(x=0.0):
        sent[0] += STEP_NS
        message = stamp(Imu(), sent[0])
        message.angular_velocity.x = x
        imu.publish(message)

    def answered(x=0.0):
        """390 states a second answer 400 samples: one of three is left out at the most."""
        step(x)
        peer.wait(lambda: stamp_ns(states[-1]) > sent[0] - 3 * STEP_NS, "an answer")
    peer.poll(lambda: all(p.get_subscription_count() for p in (imu, status, gnss, baro)), "the estimator")
    for _ in range(100):
        step()
    assert not states, "disarmed: nothing is estimated"

    def armed():
        status.publish(Status(armed=True))
        step()
    peer.introduce(armed, states, "estimated_state")
    peer.poll(lambda: step() or states, "a state")
    first = sent[0]
    for _ in range(400):
        answered(0.25)
    stamps = [stamp_ns(message) for message in states if stamp_ns(message) > first]
    assert 388 <= len(stamps) <= 393 and all((ns - first) % STEP_NS == 0 for ns in stamps)
    assert states[-1].p == pytest.approx(0.25)
    for k in range(2):  # the first fix is the origin
        gnss.publish(stamp(GNSS(fix_type=3, lat=40.0 + k * 1e-5, lon=-111.0, alt=1400.0), sent[0]))
        peer.poll(lambda: answered() or states[-1].initial_lat == 40.0, "the origin")
    peer.poll(lambda: answered() or states[-1].p_n > 0, "a position")
    assert states[-1].p_n == pytest.approx(6378145.0 * math.radians(1e-5), rel=1e-4)
    for k in range(100):  # the reference pressure; one at a time, because the estimator's queue holds ten
        baro.publish(Barometer(pressure=86000.0 + 5.0 * (-1)**k))
        answered()
    peer.poll(lambda: baro.publish(Barometer(pressure=85990.0)) or answered() or states[-1].p_d < -0.5, "an altitude")
    assert states[-1].p_d == pytest.approx(-10.0 / (1.0667 * 9.81), rel=0.01), "standard air at 1400 m: 1.0667 kg/m^3"
    baro.publish(Barometer(pressure=85000.0))
    peer.poll(lambda: answered() or states[-1].p_d < -1.5, "a jump of pressure")
    assert states[-1].p_d == pytest.approx(-10.0 / (1.0667 * 9.81) - 1.35, rel=0.01), "limited by baro_measurement_gate"


def test_a_path_manager_thins_states_and_keeps_the_list(copter, peer):
    setpoints, states = peer.listen(TrajectoryCommand, "trajectory_command"), peer.publisher(State, "estimated_state")
    waypoints = peer.publisher(Waypoint, "waypoints", LATCHED)
    peer.poll(lambda: states.get_subscription_count() >= 2 and waypoints.get_subscription_count(), "the path manager")
    waypoints.publish(Waypoint(w=[3.0, 2.0, -1.0]))
    count = [0]

    def step():
        count[0] += 1
        states.publish(stamp(State(), 10**12 + count[0] * STEP_NS))
    peer.poll(lambda: step() or (setpoints and list(setpoints[-1].position) == [3.0, 2.0, -1.0]), "the waypoint")
    assert peer.call(Trigger, "path_manager/print_waypoints").message == "1 waypoints"
    times = [stamp_ns(m) for m in setpoints]
    assert all(b - a >= 0.9 * 20_000_000 for a, b in zip(times, times[1:])), "50 Hz at most"
    assert peer.call(Trigger, "path_manager/clear_waypoints").success
    assert peer.call(Trigger, "path_manager/print_waypoints").message == "0 waypoints"


def test_a_follower_answers_states_under_their_stamps_and_takes_parameters(copter, peer):
    commands, states = peer.listen(ControllerCommand, "high_level_command"), peer.publisher(State, "estimated_state")
    inputs = peer.publisher(TrajectoryCommand, "trajectory_command")
    count = [0]

    def step():
        count[0] += 1
        inputs.publish(TrajectoryCommand(position=[1.0, 2.0, -3.0], velocity=[2.0, 0.0, 0.0]))
        states.publish(stamp(State(), 2 * 10**12 + count[0] * STEP_NS))

    def answers():  # the path manager's trajectory is followed, too
        return [command for command in list(commands) if command.cmd3 == -3.0]
    peer.poll(lambda: step() or answers(), "a command")
    first = answers()[0]
    assert stamp_ns(first) <= 2 * 10**12 + count[0] * STEP_NS and first.cmd_valid and (first.cmd1, first.cmd2) == (1.0, 2.0)
    assert set_parameters(peer, "trajectory_follower", lead=0.5)[0].successful
    copter.until("lead 0.5")
    peer.poll(lambda: step() or answers()[-1].cmd1 == 2.0, "a command with the new parameter")
    refused = set_parameters(peer, "trajectory_follower", lead=math.nan)[0]
    assert not refused.successful and refused.reason == "parameter lead: found nan or infinity, allowed a finite number"
    assert peer.call(Trigger, "trajectory_follower/clear_integrators").success


# ---- rosplane ---------------------------------------------------------------------------------------------------------


def test_the_modules_of_a_plane_are_a_chain_from_state_to_command(installed):
    with own(installed, "own_plane", 4) as program, SimPeer() as peer:
        paths, wanted = peer.listen(CurrentPath, "current_path"), peer.listen(ControllerCommands, "controller_command")
        commands, inner = peer.listen(Command, "command"), peer.listen(ControllerInternals, "controller_internals")
        states, waypoints = peer.publisher(PlaneState, "estimated_state"), peer.publisher(PlaneWaypoint, "waypoint_path", LATCHED)
        waypoints.publish(PlaneWaypoint(w=[0.0, 500.0, -60.0], va_d=15.0))
        count = [0]

        def fly(height):
            def step():
                count[0] += 1
                states.publish(stamp(PlaneState(p_d=-float(height), va=15.0), 10**12 + count[0] * STEP_NS))
            return step
        peer.introduce(fly(0.0), commands, "command")
        peer.poll(lambda: fly(0.0)() or (wanted and wanted[-1].h_c == 60.0), "the altitude of the waypoint")

        def until(height, zone):
            step = fly(height)
            peer.poll(lambda: step() or (inner and commands and inner[-1].alt_zone == zone), f"zone {zone} at {height} m")
        until(0.0, ControllerInternals.ZONE_TAKE_OFF)
        assert commands[-1].u[0] == 1.0 and commands[-1].u[4] == pytest.approx(1.8 * 0.2), "full throttle, elevator up"
        until(10.0, ControllerInternals.ZONE_CLIMB)
        program.until("left the ground")
        until(58.0, ControllerInternals.ZONE_ALTITUDE_HOLD)
        peer.poll(lambda: fly(58.0)() or commands[-1].u[3] == pytest.approx(1.1 * 0.6), "the aileron at u3")
        assert commands[-1].mode == Command.MODE_PASS_THROUGH and inner[-1].phi_c == pytest.approx(0.6), "max_roll"
        assert paths[-1].path_type == CurrentPath.LINE_PATH and list(paths[-1].q) == pytest.approx([0.0, 1.0, 0.0])
        assert wanted[-1].chi_c == pytest.approx(math.pi / 2, abs=0.02) and wanted[-1].va_c == 15.0
        for topic, period_ns in ((wanted, 100_000_000), (commands, 10_000_000)):
            times = [stamp_ns(m) for m in topic]
            assert all(b - a >= 0.9 * period_ns for a, b in zip(times, times[1:]))
