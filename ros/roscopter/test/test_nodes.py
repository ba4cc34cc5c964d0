# SPDX-License-Identifier: BSD-3-Clause
"""Each node by itself, fed message by message by an rclpy peer: its contract, what it does when its input stops, its
parameters, and numbers worked out by hand. The planner and the controller have files of their own."""

import math
import time

import pytest
from copter_nodes import LATCHED_ALL, START_NS, WITHOUT_VEHICLE, Path, copter, going, set_values, state
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import DescribeParameters, ListParameters, SetParameters
from roscopter_msgs.msg import ControllerCommand, State, TrajectoryCommand, Waypoint
from rosflight_msgs.msg import Attitude, Barometer, BatteryStatus, Command, Fence, GNSS, SimState, Status
from sensor_msgs.msg import Imu, MagneticField
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sim_contract import TRIGGER, Module, Out, check_module
from sim_rig import LATCHED, VEHICLE, Process, SimPeer, executable, launch, stamp, stamp_ns
from std_msgs.msg import String
from std_srvs.srv import Trigger
from visualization_msgs.msg import Marker

GRAVITY, MASS = 9.80665, 3.5  # of vehicles/multirotor.yaml

PARAM_FILE = "rosflight_msgs/srv/ParamFile"
MODULES = [
    ("estimator", Module("estimator", {"estimated_state": Out(State)},
                         {"imu/data": Imu, "gnss": GNSS, "baro": Barometer, "magnetometer": MagneticField, "status": Status})),
    ("path_planner", Module("path_planner", {"waypoints": Out(Waypoint, latched=True), "mission/fence": Out(Fence, latched=True)},
                             {"estimated_state": State},
                            {"path_planner/add_waypoint": "roscopter_msgs/srv/AddWaypoint",
                             "path_planner/clear_waypoints": TRIGGER, "path_planner/load_mission_from_file": PARAM_FILE,
                             "path_planner/print_waypoints": TRIGGER, "path_planner/publish_next_waypoint": TRIGGER})),
    ("path_manager", Module("path_manager", {"trajectory_command": Out(TrajectoryCommand)},
                            {"estimated_state": State, "waypoints": Waypoint, "battery": BatteryStatus, "mission/fence": Fence},
                            {"path_manager/clear_waypoints": TRIGGER, "path_manager/print_waypoints": TRIGGER,
                             "path_manager/return_to_base": TRIGGER})),
    ("trajectory_follower", Module("trajectory_follower", {"high_level_command": Out(ControllerCommand)},
                                   {"estimated_state": State, "trajectory_command": TrajectoryCommand, "status": Status},
                                   {"trajectory_follower/clear_integrators": TRIGGER})),
    ("controller", Module("controller", {"command": Out(Command), "flight_phase": Out(String, latched=True)},
                          {"estimated_state": State, "high_level_command": ControllerCommand, "status": Status, "battery": BatteryStatus},
                          {"controller/land": TRIGGER})),
    ("ext_att_transcriber", Module("ext_att_transcriber", {"external_attitude": Out(Attitude)}, {"estimated_state": State})),
    ("rviz_waypoint_publisher", Module("rviz_waypoint_publisher", {"rviz/waypoint": Out(Marker, latched=True)}, {"waypoints": Waypoint})),
    ("sim_state_transcriber", Module("roscopter_truth", {"sim/roscopter/state": Out(State)}, {"sim/truth_state": SimState})),
    ("signal_generator", Module("signal_generator", {"high_level_command": Out(ControllerCommand)}, {},
                                {f"signal_generator/{name}": TRIGGER for name in (
                                    "toggle_step_signal", "reset_signal", "pause_signal", "start_continuous_signal",
                                    "start_single_period_signal")})),
]


@pytest.fixture
def peer():
    with SimPeer() as it:
        yield it


@pytest.mark.parametrize("name, module", MODULES)
def test_the_graph_shows_every_topic_and_service(peer, name, module):
    with copter(name):
        check_module(peer, module)


@pytest.mark.parametrize("name, parameters, said", [
    ("controller", {"vehicle_file": "/no/such.yaml"}, "/no/such.yaml: found no such file"),
    ("controller", {"vehicle_file": VEHICLE, "min_throttle": "0.8", "max_throttle": "0.4"}, "min_throttle: found 0.8, allowed less than"),
    ("trajectory_follower", {"vehicle_file": VEHICLE, "u_n_kp": "5000.0"}, "u_n_kp"),
    ("path_planner", {"vehicle_file": VEHICLE, "mission_file": "/no/such.yaml"}, "/no/such.yaml: found no such file"),
    ("estimator", {"vehicle_file": VEHICLE, "hotstart_estimator": "true"}, "hotstart_estimator: found true, allowed false"),
    ("signal_generator", {"signal_type": "noise"}, "signal_type: found 'noise', allowed step, square"),
])
def test_what_a_node_refuses_is_one_line_and_code_2(name, parameters, said):
    words = [word for key, value in parameters.items() for word in ("-p", f"{key}:={value}")]
    with Process(executable("roscopter", name), "--ros-args", *words) as process:
        assert process.end() == 2
        assert process.lines[-1].startswith(f"{name}: ") and said in process.lines[-1], process.text()


@pytest.mark.parametrize("name", [name for name, _ in MODULES if name not in WITHOUT_VEHICLE] + ["signal_generator"])
def test_every_parameter_says_what_it_is(peer, name):
    """For rqt_reconfigure and ros2 param: a text each, and a range for every number."""
    with copter(name):
        names = [n for n in peer.call(ListParameters, f"{name}/list_parameters").result.names if n != "use_sim_time"]
        assert len(names) >= 3
        for each in peer.call(DescribeParameters, f"{name}/describe_parameters", names=names).descriptors:
            assert each.description, each.name
            if each.type == ParameterType.PARAMETER_DOUBLE:
                assert each.floating_point_range[0].from_value < each.floating_point_range[0].to_value, each.name


def test_the_tuning_launch_starts_what_it_names(peer):
    received = peer.listen(ControllerCommand, "high_level_command")
    with launch("roscopter", "roscopter_tuning.launch.py", controller_mode=11, controller_output=4, signal_type="triangle",
                signal_magnitude="4.0", default_cmd4="30.0") as world:
        world.until("ready: 5 nodes in ")
        peer.wait(lambda: received, "a command")
        assert (received[-1].mode, received[-1].cmd4) == (11, 30.0)
        assert peer.call(Trigger, "signal_generator/start_continuous_signal").success
        peer.wait(lambda: received[-1].cmd4 > 30.5, "the signal")


# ---- path manager --------------------------------------------------------------------------------


def test_the_path_manager_flies_legs_of_the_closed_form(peer):
    with copter("path_manager", max_velocity=4.0, max_acceleration=3.0) as process:
        path = Path(peer, (1.0, 2.0, -3.0))
        assert path.silent(), "nothing to fly"
        path.waypoints.publish(Waypoint(type=Waypoint.TYPE_GOTO, w=[9.0, 2.0, -3.0]))
        peer.poll(lambda: "1 waypoints" in peer.call(Trigger, "path_manager/print_waypoints").message, "the waypoint")
        path.step()
        # From rest over 8 m: T = max(1.875 d/v, sqrt(10/sqrt(3) d/a)) = max(3.75, 3.924) s.
        duration = math.sqrt(10 / math.sqrt(3) * 8 / 3)

        def north_m(since_ns):
            tau = min(since_ns * 1e-9 / duration, 1.0)
            return 1 + 8 * (6 * tau**5 - 15 * tau**4 + 10 * tau**3)

        # It begins where the vehicle is, at a State that may be one of before: some come after the waypoint, and the answer to
        # the first may be gone before anybody listens.
        first = path.received[0]
        assert tuple(first.position)[1:] == pytest.approx((2.0, -3.0), abs=1e-6)
        began_ns = next(ns for ns in range(stamp_ns(first), START_NS - 1, -50_000_000)
                        if first.position[0] == pytest.approx(north_m(stamp_ns(first) - ns), abs=1e-5))
        speeds = []
        while path.place[0] < 9.0 - 1e-5:
            since_ns = stamp_ns(path.step()) - began_ns
            assert path.place[0] == pytest.approx(north_m(since_ns), abs=1e-4)
            speeds.append(path.received[-1].velocity[0])
        assert max(speeds) == pytest.approx(1.875 * 8 / duration, rel=2e-3)
        assert (path.ns - began_ns) * 1e-9 == pytest.approx(duration, abs=0.06)
        path.step()
        process.until("waypoint 1 reached")

        assert set_values(peer, "path_manager", max_velocity=1.0)[0].successful
        refused = set_values(peer, "path_manager", max_velocity=-1.0)[0]
        assert not refused.successful and refused.reason
        path.waypoints.publish(Waypoint(type=Waypoint.TYPE_GOTO, w=[9.0, 6.0, -3.0]))
        peer.poll(lambda: "2 waypoints" in peer.call(Trigger, "path_manager/print_waypoints").message, "the waypoint")
        path.received.clear()
        while path.place[1] < 5.99:
            path.step(0.1)
        assert max(m.velocity[1] for m in path.received) == pytest.approx(1.0, rel=0.01), "the new limit"
        assert peer.call(Trigger, "path_manager/clear_waypoints").success
        here = path.place
        for _ in range(20):
            path.step()
        assert path.place == pytest.approx(here, abs=0.05), "a list that is cleared in flight leaves it where it is"


def test_the_clock_of_the_path_runs_only_while_the_controller_follows(peer):
    phases = peer.publisher(String, "flight_phase", LATCHED)
    phases.publish(String(data="position_hold"))
    with copter("path_manager"):
        path = Path(peer, (0.0, 0.0, -2.0))
        path.waypoints.publish(Waypoint(type=Waypoint.TYPE_GOTO, w=[5.0, 0.0, -2.0]))
        peer.poll(lambda: "1 waypoints" in peer.call(Trigger, "path_manager/print_waypoints").message, "the waypoint")
        for _ in range(60):
            path.step()
        assert path.place == pytest.approx((0.0, 0.0, -2.0), abs=1e-6), "it waits, however long"
        phases.publish(String(data="offboard"))
        while path.place[0] < 0.5:
            step = path.step()
            assert step.velocity[0] < 2.0, "from rest, not where the clock would be"


def test_a_return_leads_up_then_over_the_take_off_and_lands(peer):
    landings = []
    phases = peer.publisher(String, "flight_phase", LATCHED)
    phases.publish(String(data="disarmed"))

    def land(_, response):
        landings.append(path.place)
        response.success = True
        return response
    peer.node.create_service(Trigger, "controller/land", land)
    with copter("path_manager"):  # return_height_m is 5
        def back():
            return peer.call(Trigger, "path_manager/return_to_base")
        path = Path(peer, (1.0, 2.0, 0.0))  # where it takes off
        path.waypoints.publish(Waypoint(type=Waypoint.TYPE_GOTO, w=[9.0, 2.0, -3.0]))
        peer.poll(lambda: "1 waypoints" in peer.call(Trigger, "path_manager/print_waypoints").message, "the waypoint")
        path.step()
        answer = back()
        assert not answer.success and answer.message == "found no take-off, allowed after one"
        phases.publish(String(data="takeoff"))
        peer.poll(lambda: back().message == "found no path in flight, allowed on one", "the take-off")
        phases.publish(String(data="offboard"))
        while path.place[0] < 6.0:
            path.step()
        left = path.place
        assert left[2] > -3.0 and back().success
        assert back().message == "found a return, allowed once in a flight"
        path.waypoints.publish(Waypoint(type=Waypoint.TYPE_GOTO, w=[50.0, 2.0, -3.0]))
        while not landings:
            path.step()
            assert path.place[0] < 9.0, "it brakes"
            if path.place[0] < left[0] - 0.5:
                assert path.place[2] == pytest.approx(-5.0, abs=0.01), "up before it goes back"
        assert path.place == pytest.approx((1.0, 2.0, -5.0), abs=1e-3)
        for _ in range(20):
            path.step()
        assert path.place == pytest.approx((1.0, 2.0, -5.0), abs=1e-3) and len(landings) == 1
        phases.publish(String(data="takeoff"))
        peer.poll(lambda: back().message == "found no path in flight, allowed on one", "the next take-off")
        assert peer.call(Trigger, "path_manager/print_waypoints").message == "2 waypoints", "those of the mission"


# ---- follower ------------------------------------------------------------------------------------


def test_the_follower_obeys_its_gains_and_stops_when_set_points_do(peer):
    gains = {"u_n_kp": 6.0, "u_n_ki": 0.0, "u_e_ki": 0.0, "u_d_ki": 0.0}
    with copter("trajectory_follower", **gains):
        received = peer.listen(ControllerCommand, "high_level_command")
        states, setpoints = peer.publisher(State, "estimated_state"), peer.publisher(TrajectoryCommand, "trajectory_command")
        peer.poll(lambda: states.get_subscription_count() and setpoints.get_subscription_count(), "subscribers")
        ns = START_NS

        def answer():
            nonlocal ns
            ns += 10_000_000
            states.publish(state(ns))
            peer.wait(lambda: received and stamp_ns(received[-1]) == ns, "a command")
            return received[-1]

        def followed(north):
            """The command once the setpoint has arrived: no velocity, no acceleration, no integral."""
            setpoints.publish(stamp(TrajectoryCommand(position=[north, 0.0, 0.0]), ns))

        states.publish(state(ns))
        time.sleep(0.2)
        assert not received, "nothing before the first setpoint"
        peer.poll(lambda: (followed(0.5), states.publish(state(ns)), received)[2], "the first command")

        def until_pitch(acceleration):
            pitch, thrust = -math.atan(acceleration / GRAVITY), MASS * math.hypot(acceleration, GRAVITY)
            peer.poll(lambda: (followed(0.5), abs(answer().cmd2 - pitch) < 1e-5)[1], f"a pitch of {pitch}")
            assert received[-1].mode == ControllerCommand.MODE_ROLL_PITCH_YAWRATE_THRUST_TO_MIXER and received[-1].cmd_valid
            assert received[-1].cmd1 == pytest.approx(0.0, abs=1e-5) and received[-1].cmd4 == pytest.approx(thrust, rel=1e-5)
        until_pitch(6.0 * 0.5)
        assert set_values(peer, "trajectory_follower", u_n_kp=2.0)[0].successful
        until_pitch(2.0 * 0.5)
        refused = set_values(peer, "trajectory_follower", u_n_kp=5000.0)[0]
        assert not refused.successful and "u_n_kp" in refused.reason
        until_pitch(2.0 * 0.5)
        assert peer.call(Trigger, "trajectory_follower/clear_integrators").success
        peer.poll(lambda: not answer().cmd_valid, "an end of valid commands, trajectory_timeout_s after the last setpoint")
        peer.poll(lambda: (followed(0.5), answer().cmd_valid)[1], "valid commands again")


# ---- transcribers, signal ---------------------------------------------------------------------------


def test_the_transcribers_copy(peer):
    with copter("ext_att_transcriber"), copter("sim_state_transcriber"):
        attitudes, states = peer.listen(Attitude, "external_attitude"), peer.listen(State, "sim/roscopter/state")
        estimate, truth = peer.publisher(State, "estimated_state"), peer.publisher(SimState, "sim/truth_state")
        in_estimate = state(START_NS, psi=1.0)
        in_estimate.p, in_estimate.q, in_estimate.r = 0.1, 0.2, 0.3
        in_truth = stamp(SimState(), START_NS)
        in_truth.pose.position.x, in_truth.twist.linear.x, in_truth.twist.angular.z = 3.0, 2.0, 0.5
        in_truth.pose.orientation.w = in_truth.pose.orientation.z = math.sqrt(0.5)
        peer.introduce(lambda: estimate.publish(in_estimate), attitudes, "external_attitude")
        peer.introduce(lambda: truth.publish(in_truth), states, "sim/roscopter/state")
        estimate.publish(in_estimate)
        truth.publish(in_truth)
        peer.wait(lambda: attitudes and states, "the copies")
        out = attitudes[-1]
        assert (out.attitude.w, out.attitude.z) == pytest.approx((math.cos(0.5), math.sin(0.5)))
        assert (out.angular_velocity.x, out.angular_velocity.y, out.angular_velocity.z) == pytest.approx((0.1, 0.2, 0.3))
        copy = states[-1]
        assert (copy.p_n, copy.v_x, copy.v_y, copy.r) == pytest.approx((3.0, 2.0, 0.0, 0.5), abs=1e-6)
        assert copy.psi == pytest.approx(math.pi / 2) and copy.initial_lat == 0.0 and stamp_ns(copy) == START_NS


@pytest.mark.parametrize("name, topics", [
    ("estimator", ["imu/data", "attitude", "baro", "gnss", "magnetometer", "range"]), ("path_planner", ["estimated_state"]),
    ("path_manager", ["estimated_state", "battery"]), ("trajectory_follower", ["estimated_state", "trajectory_command"]),
    ("controller", ["estimated_state", "high_level_command"]), ("ext_att_transcriber", ["estimated_state"])])
def test_what_comes_again_and_again_is_not_acknowledged(peer, name, topics):
    """Each acknowledgement costs two processes a wake-up."""
    with copter(name):
        for topic in topics:
            peer.poll(lambda t=topic: peer.node.get_subscriptions_info_by_topic(f"/{t}"), f"a subscription of {topic}")
            assert {end.qos_profile.reliability for end in peer.node.get_subscriptions_info_by_topic(f"/{topic}")} == {
                ReliabilityPolicy.BEST_EFFORT}, topic


@pytest.mark.parametrize("reliability", [ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT])
def test_publishers_of_either_reliability_arrive(peer, reliability):
    with copter("ext_att_transcriber"):
        attitudes = peer.listen(Attitude, "external_attitude")
        states = peer.publisher(State, "estimated_state", QoSProfile(depth=1, reliability=reliability))
        peer.poll(lambda: states.publish(state(START_NS)) or attitudes, "an attitude")


def test_the_planner_leaves_the_state_alone_once_it_knows_the_origin(peer):
    with copter("path_planner"):
        states = peer.publisher(State, "estimated_state")
        peer.poll(lambda: states.get_subscription_count() == 1, "the subscription")
        known = state(START_NS)
        known.initial_lat, known.initial_lon = 40.0, -111.0
        peer.poll(lambda: states.publish(known) or states.get_subscription_count() == 0, "its end")


def test_the_truth_is_subscribed_to_while_somebody_reads_its_copy(peer):
    truth = peer.publisher(SimState, "sim/truth_state")
    with copter("sim_state_transcriber"):
        peer.poll(lambda: peer.node.count_publishers("sim/roscopter/state") == 1, "the node's topic")
        for _ in range(2):
            peer.poll(lambda: truth.get_subscription_count() == 0, "an end of the subscription")
            with peer.reads(State, "sim/roscopter/state"):
                peer.poll(lambda: truth.get_subscription_count() == 1, "the subscription")


def test_waypoints_are_shown_in_rviz_until_they_are_cleared(peer):
    waypoints = peer.publisher(Waypoint, "waypoints", LATCHED)
    for north in (1.0, 5.0):
        waypoints.publish(going(north))
    with copter("rviz_waypoint_publisher"):
        received = peer.listen(Marker, "rviz/waypoint", LATCHED_ALL)
        peer.wait(lambda: [m.text for m in received if m.type == Marker.TEXT_VIEW_FACING] == ["1", "2"], "two numbers")
        line = [m for m in received if m.type == Marker.LINE_STRIP][-1]
        assert [(p.x, p.y, p.z) for p in line.points] == [(1.0, 0.0, -5.0), (5.0, 0.0, -5.0)] and line.header.frame_id == "NED"
        waypoints.publish(Waypoint(clear_wp_list=True))
        peer.wait(lambda: received[-1].action == Marker.DELETEALL, "nothing left")


def test_the_signal_generator_makes_its_waves(peer):
    with copter("signal_generator", controller_mode=11, controller_output=2, signal_type="sine", signal_magnitude=2.0,
                frequency_hz=4.0, default_cmd2=1.0, default_cmd4=30.0):
        received = peer.listen(ControllerCommand, "high_level_command")
        peer.wait(lambda: len(received) > 10, "commands")
        assert {(m.mode, m.cmd1, m.cmd2, m.cmd4, m.cmd_valid) for m in received} == {(11, 0.0, 1.0, 30.0, True)}
        answer = peer.call(Trigger, "signal_generator/toggle_step_signal")
        assert not answer.success and "allowed step" in answer.message
        assert peer.call(Trigger, "signal_generator/start_continuous_signal").success
        received.clear()
        peer.wait(lambda: len(received) > 100, "a second of commands")
        values = [m.cmd2 for m in received]
        assert 1.0 <= min(values) < 1.1 and 2.9 < max(values) <= 3.0
        assert peer.call(Trigger, "signal_generator/pause_signal").success
        assert peer.call(Trigger, "signal_generator/reset_signal").success
        peer.poll(lambda: received[-1].cmd2 == 1.0, "the lower end")
        received.clear()
        assert peer.call(Trigger, "signal_generator/start_single_period_signal").success
        peer.wait(lambda: received and max(m.cmd2 for m in received) > 2.9, "the top")
        peer.wait(lambda: received[-1].cmd2 == 1.0, "the end of the period")

        text = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value="step")
        change = [Parameter(name="signal_type", value=text)]
        assert peer.call(SetParameters, "signal_generator/set_parameters", parameters=change).results[0].successful
        assert peer.call(Trigger, "signal_generator/toggle_step_signal").success
        peer.wait(lambda: received[-1].cmd2 == 3.0, "the upper end of the step")
        assert not peer.call(Trigger, "signal_generator/start_continuous_signal").success
