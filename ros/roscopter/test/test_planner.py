# SPDX-License-Identifier: BSD-3-Clause
"""The path planner by itself: what it publishes, what it refuses, missions and positions on earth."""

import math

import pytest
from copter_nodes import LATCHED_ALL, START_NS, copter, going, state
from roscopter_msgs.msg import State, Waypoint
from roscopter_msgs.srv import AddWaypoint
from ros_rig import ROOT
from rosflight_msgs.msg import Fence
from rosflight_msgs.srv import ParamFile
from sim_rig import LATCHED, Process, SimPeer, executable
from std_msgs.msg import String
from std_srvs.srv import Trigger


@pytest.fixture
def peer():
    with SimPeer() as it:
        yield it


def test_the_planner_publishes_so_many_and_late_joiners_get_all(peer, tmp_path):
    mission = tmp_path / "long.yaml"
    mission.write_text("mission:\n" + "".join(f"  - {{type: goto, w: [{k}, 0, -5], psi: 0}}\n" for k in range(40)))
    with copter("path_planner", mission_file=mission, num_waypoints_to_publish_at_start=30):
        late = peer.listen(Waypoint, "waypoints", LATCHED_ALL)
        peer.wait(lambda: late and late[-1].w[0] == 29.0, "30 waypoints")
        in_force = late[max(k for k, m in enumerate(late) if m.clear_wp_list) + 1:]
        assert [m.w[0] for m in in_force] == list(range(30)), "more than roscopter keeps, in order"
        ends = peer.listen(String, "mission/at_end", LATCHED)
        peer.wait(lambda: ends and ends[-1].data == "hold", "hold: waypoints wait")
        for k in range(10):
            answer = peer.call(Trigger, "path_planner/publish_next_waypoint")
            assert answer.success and f"waypoint {31 + k} of 40" in answer.message
        answer = peer.call(Trigger, "path_planner/publish_next_waypoint")
        assert not answer.success and "nothing is left" in answer.message
        peer.wait(lambda: ends[-1].data == "land", "the end of the file")
        inserted = peer.call(AddWaypoint, "path_planner/add_waypoint", wp=going(77), publish_now=True)
        assert inserted.success and "41 waypoints, 41 published" in inserted.message
        peer.wait(lambda: late[-1].w[0] == 77.0, "the added waypoint")
        assert "41 waypoints" in peer.call(Trigger, "path_planner/print_waypoints").message
        assert peer.call(Trigger, "path_planner/clear_waypoints").success
        peer.wait(lambda: late[-1].clear_wp_list, "the clear marker")




@pytest.mark.parametrize("waypoint, said", [
    (going(10, height=500.0), "wp.w: found a height of 500 m, allowed 0.5 to 120 m"),
    (going(99_999), "wp.w: found a position"),
    (going(math.nan), "wp.w: found"),
    (going(10, speed=99.0), "wp.speed: found 99, allowed 0.1 to 8"),
    (going(10, psi=9.0), "wp.psi: found 9"),
    (going(10, hold_indefinitely=True), "wp.hold_indefinitely: found true at a goto"),
    (Waypoint(type=7), "wp.type: found 7, allowed 0 (hold) or 1 (goto)"),
    (going(10, use_lla=True), "wp.use_lla: found true, allowed false: the origin is not known yet"),
])
def test_the_planner_names_what_is_wrong_with_a_waypoint(planner, waypoint, said):
    peer, _ = planner
    answer = peer.call(AddWaypoint, "path_planner/add_waypoint", wp=waypoint)
    assert not answer.success and said in answer.message
    assert peer.call(Trigger, "path_planner/print_waypoints").message == "0 waypoints, 0 published"


@pytest.fixture(scope="module")
def planner():
    """One for many tests, in a namespace of its own so that nobody else receives its waypoints."""
    with SimPeer("planner_peer", "apart") as it, copter("path_planner", namespace="/apart") as process:
        yield it, process


def test_missions_load_whole_or_not_at_all_and_geodetic_ones_with_an_origin(planner, tmp_path):
    peer, process = planner
    received = peer.listen(Waypoint, "waypoints", LATCHED_ALL)

    def load(file):
        return peer.call(ParamFile, "path_planner/load_mission_from_file", filename=str(file)).success
    assert load(ROOT / "missions/reference_example.yaml"), "the form of ROSflight 2.x"
    peer.wait(lambda: received and received[-1].w[2] == -40.0, "its last waypoint")
    assert received[-1].type == Waypoint.TYPE_HOLD and received[-1].hold_seconds == 10.0 and received[-2].w[1] == -20.0
    bad = tmp_path / "bad.yaml"
    bad.write_text("mission:\n  - {type: goto, w: [1, 0, -5], psi: 0}\n  - {type: goto, w: [1, 0, -5], psi: 0, sped: 3}\n")
    assert not load(bad)
    process.until("bad.yaml:3: mission.1.sped: found an unknown key, allowed")
    assert "5 waypoints" in peer.call(Trigger, "path_planner/print_waypoints").message, "the list before stays"
    assert not load(ROOT / "missions/figure_eight.yaml")
    process.until("figure_eight: found one, allowed none over ROS")

    geodetic = tmp_path / "geodetic.yaml"
    geodetic.write_text("mission:\n  - {type: goto, w: [40.001, -111.0, 1410], use_lla: true, psi: 0}\n")
    assert not load(geodetic)
    process.until("use_lla: found true, allowed false, because the start has no known position")
    states = peer.publisher(State, "estimated_state")
    origin = state(START_NS)
    origin.initial_lat, origin.initial_lon, origin.initial_alt = 40.0, -111.0, 1400.0

    def loaded():
        states.publish(origin)
        return load(geodetic)
    peer.poll(loaded, "the origin")
    # A meridian's radius at 40 deg on WGS-84, a(1-e^2)/(1-e^2 sin^2)^1.5 = 6361815.8 m, and the height of the origin.
    peer.wait(lambda: abs(received[-1].w[0] - math.radians(0.001) * (6361815.8 + 1400.0)) < 0.01, "the position")
    assert abs(received[-1].w[1]) < 1e-3 and abs(received[-1].w[2] + 10.0) < 0.01 and not received[-1].use_lla


@pytest.mark.parametrize("package, vehicle, waypoint", [
    ("roscopter", "multirotor", "w: [10, 0, -5], psi: 0"), ("rosplane", "anaconda", "w: [100, 0, -50], speed: 17")])
def test_the_fence_of_a_mission_is_published_until_there_is_another(peer, tmp_path, package, vehicle, waypoint):
    prefix = "path_planner/" if package == "roscopter" else ""

    def mission(name, head):
        file = tmp_path / name
        file.write_text(f"{head}\nmission:\n  - {{type: goto, {waypoint}}}\n")
        return file

    def load(file):
        return peer.call(ParamFile, f"{prefix}load_mission_from_file", filename=str(file)).success
    fenced = mission("fenced.yaml", "fence: {radius_m: 200, height_m: 90}")
    with Process(executable(package, "path_planner"), "--ros-args", "-p", f"mission_file:={fenced}",
                 "-p", f"vehicle_file:={ROOT / f'vehicles/{vehicle}.yaml'}") as process:
        process.until("ready")
        fences = peer.listen(Fence, "mission/fence", LATCHED)  # later than it was published
        peer.wait(lambda: fences and (fences[-1].radius, fences[-1].height) == (200.0, 90.0), "the fence of the file")
        assert load(mission("open.yaml", ""))
        peer.wait(lambda: math.isnan(fences[-1].radius) and math.isnan(fences[-1].height), "no fence")
        assert load(mission("other.yaml", "fence: {radius_m: 300, height_m: 80}"))
        peer.wait(lambda: (fences[-1].radius, fences[-1].height) == (300.0, 80.0), "another fence")
        assert peer.call(Trigger, f"{prefix}clear_waypoints").success
        peer.wait(lambda: math.isnan(fences[-1].radius), "no fence without a mission")


def test_a_waypoint_outside_of_the_fence_in_force_is_refused(peer, tmp_path):
    mission = tmp_path / "fenced.yaml"
    mission.write_text("fence: {radius_m: 50, height_m: 20}\nmission:\n  - {type: goto, w: [10, 0, -5], psi: 0}\n")
    with copter("path_planner", mission_file=mission):
        def add(waypoint):
            return peer.call(AddWaypoint, "path_planner/add_waypoint", wp=waypoint)
        outside = "w: found a position 60 m from the start, 5 m high, allowed inside of the fence: 50 m and 20 m"
        assert add(going(60)).message == outside
        assert not add(going(10, height=30.0)).success
        assert add(going(40)).success
        assert peer.call(Trigger, "path_planner/clear_waypoints").success
        assert add(going(60)).success, "no mission, no fence"
