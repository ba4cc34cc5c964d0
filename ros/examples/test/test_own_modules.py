# SPDX-License-Identifier: BSD-3-Clause
"""Modules of somebody else, derived from the exported base classes: built outside the tree against the installed packages, as C++17,
then flown, and each class asked for what it promises."""

import math
import os
import shutil
import subprocess
import sys

import pytest
from copter_flight import Flight
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
from std_srvs.srv import Trigger

STEP_NS = 2_500_000


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """The package, built and installed far from the tree; the libraries of the project are not to be found."""
    folder = tmp_path_factory.mktemp("elsewhere")
    shutil.copytree(ROOT / "ros/examples/own_modules", folder / "src")
    environment = {name: value for name, value in os.environ.items() if name != "rosflight_DIR"}
    configure = ["cmake", "-S", folder / "src", "-B", folder / "build", "-G", "Ninja", f"-DCMAKE_INSTALL_PREFIX={folder}/install",
                 "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache", f"-DPython3_EXECUTABLE={sys.executable}",
                 "-DCMAKE_EXE_LINKER_FLAGS=-Wl,--as-needed -Wl,--allow-shlib-undefined"]
    for command in (configure, ["cmake", "--build", folder / "build", "--target", "install"]):
        done = subprocess.run(list(map(str, command)), env=environment, capture_output=True, text=True)
        assert done.returncode == 0, (done.stdout + done.stderr)[-6000:]
    return folder / "install"


@pytest.fixture
def peer():
    with SimPeer() as peer:
        yield peer


def own(installed, program, *words):
    process = Process(installed / "lib/own_modules" / program, *words)
    process.until("ready")
    return process


@pytest.fixture(scope="module")
def flight(installed, tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("AMENT_PREFIX_PATH", f"{installed}:{os.environ['AMENT_PREFIX_PATH']}")
        with Flight("own_modules", "fly.launch.xml", tmp_path_factory.mktemp("memory")) as world:
            world.set_up()
            yield world


def test_a_mission_is_flown_on_forces_world_sensors_and_controller_of_others(flight):
    def owners(topic):
        return [end.node_name for end in flight.peer.node.get_publishers_info_by_topic(topic)]
    assert owners("/sim/forces_and_moments") == ["mav_forces_and_moments"]
    assert owners("/sim/truth_state") == ["dynamics"] and owners("/sim/sensors/imu/data") == ["sensors"]
    assert owners("/command") == ["controller"]
    assert "standalone" not in " ".join(owners("/sim/truth_state") + owners("/sim/sensors/imu/data"))
    flight.take_off()
    flight.until_phase("offboard")
    assert -2.0 > flight.place()[2] > -3.2, "up at takeoff_d_pos, which the launch file gives"
    flight.until(lambda: math.dist(flight.place(), (4, 4, -3)) < 1.0, "the last waypoint")
    for place in ((4, 0, -3), (4, 4, -3)):
        assert flight.nearest_to(place) < 1.0
    assert [p.data for p in flight.phases][-3:] == ["takeoff", "position_hold", "offboard"]
    assert not any(s.failsafe for s in flight.status)
    flight.until(lambda: "of the firmware is known" in flight.process.text(), "the mixer at the forces' node")
    assert "mixer 2 of the firmware is known" in flight.process.text(), "as vehicles/multirotor.yaml has it"


def test_time_of_others_moves_on_when_the_world_has_followed(installed):
    with own(installed, "own_world", "clock"), SimPeer() as peer:
        ticks, truths = peer.listen(Clock, "/clock", ALL_BEST_EFFORT), peer.listen(SimState, "sim/truth_state")
        wrenches = peer.publisher(WrenchStamped, "sim/forces_and_moments")
        peer.introduce(lambda: wrenches.publish(stamp(WrenchStamped(), STEP_NS)), truths, "sim/truth_state")
        assert peer.call(Trigger, "time_manager/toggle_pause").message == "paused"
        def now_ns():
            return ticks[-1].clock.sec * 1_000_000_000 + ticks[-1].clock.nanosec
        count = len(ticks)
        peer.wait(lambda: len(ticks) > count + 1, "time that stands, said again")
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


def test_forces_know_the_custom_mixer_by_its_inverse(installed):
    """A mixer of 10 x 10 that is asked for entry by entry; the program says when it has all."""
    with own(installed, "own_forces") as program, SimPeer() as peer:
        asked = []

        def answer(request, response):
            asked.append(request.name)
            response.exists, response.value = True, 11.0 if request.name == "PRIMARY_MIXER" else 0.0
            return response
        peer.node.create_service(ParamGet, "param_get", answer)
        program.until("mixer 11 of the firmware is known")
        assert len(set(asked)) == 2 + 10 + 200 and {"SECONDARY_MIXER", "PRI_MIXER_OUT_9", "SEC_MIXER_9_9"} <= set(asked)


def test_a_world_is_put_somewhere_or_says_no(installed):
    with own(installed, "own_world"), SimPeer() as peer:
        truths = peer.listen(SimState, "sim/truth_state")
        assert peer.call(SetSimState, "dynamics/set_sim_state", state=sim_state(0, -5.0)).success
        peer.wait(lambda: truths and truths[-1].pose.position.z == -5.0, "the truth there")
        assert not peer.call(SetSimState, "dynamics/set_sim_state", state=sim_state(0, 1.0)).success


# ---- roscopter --------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def copter(installed):
    with own(installed, "own_copter") as process:
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
    peer.poll(lambda: imu.get_subscription_count() and gnss.get_subscription_count(), "the estimator")
    for _ in range(100):
        step()
    assert not states, "disarmed: nothing is estimated"

    def armed():
        status.publish(Status(armed=True))
        step()
    peer.introduce(armed, states, "estimated_state")
    first = sent[0]
    for _ in range(400):
        step(0.25)
        peer.wait(lambda: states and stamp_ns(states[-1]) > sent[0] - 3 * STEP_NS, "an answer")
    peer.wait(lambda: len(states) >= 388, "390 a second of 400")
    assert len(states) <= 393 and all((stamp_ns(m) - first) % STEP_NS == 0 for m in states)
    assert states[-1].p == pytest.approx(0.25)
    for k in range(2):  # the first fix is the origin
        gnss.publish(stamp(GNSS(fix_type=3, lat=40.0 + k * 1e-5, lon=-111.0, alt=1400.0), sent[0]))
        peer.poll(lambda: step() or states[-1].initial_lat == 40.0, "the origin")
    peer.poll(lambda: step() or states[-1].p_n > 0, "a place")
    assert states[-1].p_n == pytest.approx(6378145.0 * math.radians(1e-5), rel=1e-4)
    for _ in range(100):
        baro.publish(Barometer(pressure=86000.0))
        peer.poll(lambda: step() or True, "")
    peer.poll(lambda: baro.publish(Barometer(pressure=85990.0)) or step() or states[-1].p_d < -0.5, "a height")
    assert states[-1].p_d > -3.0, "10 Pa are 0.9 m; more cannot pass the gate at once"


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
    peer.poll(lambda: step() or (commands and commands[-1].cmd2 == 2.0), "a command")
    assert stamp_ns(commands[-1]) <= 2 * 10**12 + count[0] * STEP_NS and commands[-1].cmd_valid and commands[-1].cmd1 == 1.0
    assert set_parameters(peer, "trajectory_follower", lead=0.5)[0].successful
    copter.until("lead 0.5")
    peer.poll(lambda: step() or commands[-1].cmd1 == 2.0, "a command with the new parameter")
    refused = set_parameters(peer, "trajectory_follower", lead=math.nan)[0]
    assert not refused.successful and refused.reason == "found nan or infinity, allowed finite numbers"
    assert peer.call(Trigger, "trajectory_follower/clear_integrators").success


# ---- rosplane ---------------------------------------------------------------------------------------------------------


def test_the_modules_of_a_plane_are_a_chain_from_state_to_command(installed):
    with own(installed, "own_plane") as program, SimPeer() as peer:
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

        def until(height, zone, throttle):
            step = fly(height)
            peer.poll(lambda: step() or (inner and commands and inner[-1].alt_zone == zone and
                                         commands[-1].u[0] == pytest.approx(throttle)), f"zone {zone}")
        until(0.0, ControllerInternals.ZONE_TAKE_OFF, 1.0)
        until(10.0, ControllerInternals.ZONE_CLIMB, 0.8)
        program.until("left the ground")
        until(58.0, ControllerInternals.ZONE_ALTITUDE_HOLD, 0.8)
        peer.poll(lambda: fly(58.0)() or commands[-1].u[4] == pytest.approx(-0.02, abs=1e-6), "the elevator at u4")
        assert commands[-1].mode == Command.MODE_PASS_THROUGH and commands[-1].u[3] == pytest.approx(0.1 * math.pi / 2, abs=0.02)
        assert paths[-1].path_type == CurrentPath.LINE_PATH and list(paths[-1].q) == pytest.approx([0.0, 1.0, 0.0])
        assert wanted[-1].h_c == 60.0 and wanted[-1].chi_c == pytest.approx(math.pi / 2, abs=0.02) and wanted[-1].va_c == 15.0
        for topic, period_ns in ((wanted, 100_000_000), (commands, 10_000_000)):
            times = [stamp_ns(m) for m in topic]
            assert all(b - a >= 0.9 * period_ns for a, b in zip(times, times[1:]))
