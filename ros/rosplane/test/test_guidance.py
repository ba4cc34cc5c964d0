# SPDX-License-Identifier: BSD-3-Clause
"""path_planner and path_manager: missions with results, late joiners, phases, refusals."""

import math

import pytest
from plane_rig import World, falls_silent, now_ns, start, state, waypoint
from ros_rig import ROOT
from rosflight_msgs.srv import ParamFile
from rosplane_msgs.msg import CurrentPath, FlightPhase, MissionSettings, State, Waypoint
from rosplane_msgs.srv import AddWaypoint
from sim_rig import LATCHED, SimPeer, set_parameters
from std_srvs.srv import Trigger

MISSIONS = ROOT / "missions"
# fixedwing_mission.yaml of rosplane 2.0.0
HOURGLASS = [(400, -250, -70), (-400, -50, -70), (-400, -250, -70), (400, -50, -70)]


def places(received):
    """Waypoints since the last order to forget them."""
    out = []
    for message in received:
        out = [] if message.clear_wp_list else [*out, tuple(message.w)]
    return out


def load(peer, file):
    return peer.call(ParamFile, "load_mission_from_file", filename=str(file)).success


def add(peer, *w, **more):
    return peer.call(AddWaypoint, "add_waypoint", w=[float(x) for x in w], **{"va_d": 15.0, **more})


def test_planner_loads_adds_clears_and_tells_latecomers(peer):
    with start("path_planner") as planner:
        received = peer.listen(Waypoint, "waypoint_path", LATCHED)
        settings = peer.listen(MissionSettings, "mission_settings", LATCHED)
        assert load(peer, MISSIONS / "reference_fixedwing.yaml")  # ROSflight 2.x's own form
        peer.wait(lambda: places(received) == HOURGLASS, "all four waypoints")
        assert all(m.va_d == 17.0 and not m.use_chi for m in received if not m.clear_wp_list)
        # A mission of ours: what a Waypoint cannot say comes beside it.
        assert load(peer, MISSIONS / "hourglass_dubins.yaml")
        peer.wait(lambda: len(places(received)) == 6, "six waypoints")
        assert received[-1].use_chi and received[-1].chi_d == pytest.approx(1.1518)
        peer.wait(lambda: settings and settings[-1].at_end == MissionSettings.LAND, "the end")
        with SimPeer("late") as late:  # joins when all has been said
            all_of_it = late.listen(Waypoint, "waypoint_path", LATCHED)
            late.wait(lambda: places(all_of_it) == places(received), "all that is in force")

        # One by one, with results.
        answer = peer.call(Trigger, "clear_waypoints")
        assert answer.success and "6 waypoints" in answer.message
        peer.wait(lambda: received[-1].clear_wp_list, "the order to forget")
        assert add(peer, 300, 0, -60).success
        assert "to the waypoint before" in (refused := add(peer, 310, 0, -60)).message and not refused.success
        for why, answer in {"va_d": add(peer, 300, 300, -60, va_d=40.0), "height": add(peer, 300, 300, 10),
                            "from the origin": add(peer, 99999, 0, -60), "chi_d": add(peer, 300, 300, -60, chi_d=9.0),
                            "lla": add(peer, 40.2, -111.6, 1450, lla=True), "climb": add(peer, 300, 300, -140),
                            "set_current": add(peer, 300, 300, -60, set_current=True), "NaN": add(peer, math.nan, 0, -60)}.items():
            assert not answer.success and "allowed" in answer.message, (why, answer)
        assert add(peer, 300, 300, -60).success
        assert "2 waypoints, 2 published" in peer.call(Trigger, "print_waypoints").message
        assert "waypoint 2: north 300.0, east 300.0" in planner.until("waypoint 2")
        assert places(received) == [(300, 0, -60), (300, 300, -60)]

        # As many as asked for, then one by one.
        assert all(r.successful for r in set_parameters(peer, "path_planner", num_waypoints_to_publish_at_start=3))
        assert load(peer, MISSIONS / "fixedwing.yaml")
        peer.wait(lambda: places(received) == HOURGLASS[:3], "three of four")
        peer.wait(lambda: settings[-1].at_end == MissionSettings.HOLD, "waiting there")
        assert peer.call(Trigger, "publish_next_waypoint").success
        peer.wait(lambda: places(received) == HOURGLASS and settings[-1].at_end == MissionSettings.LAND, "the last")
        nothing = peer.call(Trigger, "publish_next_waypoint")
        assert not nothing.success and "nothing is left" in nothing.message


def test_planner_takes_places_on_earth_once_it_knows_the_origin(peer):
    with start("path_planner"):
        received = peer.listen(Waypoint, "waypoint_path", LATCHED)
        assert "origin" in add(peer, 40.2, -111.6, 1450, lla=True).message
        states = peer.publisher(State, "estimated_state")
        message = state(now_ns())
        message.initial_lat, message.initial_lon, message.initial_alt = 40.25, -111.65, 1390.0
        peer.poll(lambda: states.publish(message) or add(peer, 40.252, -111.65, 1450, lla=True).success, "the origin")
        # 0.002 degrees of latitude are 222.1 m at 40 degrees (111.035 km a degree, WGS-84).
        assert received[-1].w[0] == pytest.approx(222.1, abs=0.6) and received[-1].w[2] == pytest.approx(-60.0, abs=0.1)
        assert not received[-1].lla


@pytest.mark.parametrize("text, said", [
    (None, "no such file"), ("mission: [", ""), ("mission:\n  - {w: [0, 0, -60], speed: 99}\n", "speed: found 99"),
    ("mission:\n  - {w: [100, 0, -60]}\n  - {w: [120, 0, -60]}\n", "w: found 20 m to the waypoint before"),
    ("path: line\nmission:\n  - {w: [300, 0, -60]}\n", "found path line, allowed path fillet or dubins over ROS")])
def test_planner_refuses_a_bad_file_whole_and_says_why(peer, tmp_path, text, said):
    file = tmp_path / "mission.yaml"
    if text is not None:
        file.write_text(text)
    with start("path_planner") as planner:
        assert load(peer, MISSIONS / "fixedwing.yaml") and not load(peer, file)
        assert "mission.yaml" in planner.until(said or "[ERROR]")
        assert "4 waypoints, 4 published" in peer.call(Trigger, "print_waypoints").message


def test_path_manager_from_take_off_to_circles(peer):
    with start("path_manager", use_sim_time="true", R_min=60.0, default_altitude=55.0) as manager:
        world = World(peer)
        south = {"east": 60.0, "course": math.pi}
        standing = {**south, "height": 0.0, "airspeed": 0.0}
        world.until_phase(FlightPhase.DISARMED, **standing)
        assert world.phases[-1].idle and not world.paths
        world.armed = True
        for _ in range(20):  # no waypoints and not yet 10 s: it stays
            world.tick(**standing)
        assert {m.phase for m in world.phases} == {FlightPhase.DISARMED}
        world.t_s += 10.0
        world.until_phase(FlightPhase.TAKEOFF, **standing)
        rolling = world.phases[-1]
        assert rolling.roll == 0.0 and abs(rolling.ground_course) == pytest.approx(math.pi, abs=1e-5)
        assert math.isnan(rolling.climb_rate) and not rolling.idle
        world.until_phase(FlightPhase.CLIMB, height=6.0, **south)
        climb = world.until_path(lambda m: m.path_type == CurrentPath.LINE_PATH and m.q[2] < 0, "the climb", height=6.0, **south)
        assert climb.q[0] < -0.9
        world.until_phase(FlightPhase.MISSION, height=55.0, **south)
        # Without waypoints: the origin, clockwise. It is on that circle already.
        there = world.until_path(lambda m: m.path_type == CurrentPath.ORBIT_PATH, "the orbit", height=55.0, **south)
        assert tuple(there.c) == pytest.approx((0.0, 0.0, -55.0), abs=0.01) and there.rho == 60.0
        assert there.lamda == CurrentPath.CLOCKWISE and there.q[0] == pytest.approx(-1.0)

        # A list in flight, from where it is; its corner is rounded off with R_min.
        for _ in range(5):
            world.tick(height=60.0)
        listed = peer.publisher(Waypoint, "waypoint_path", LATCHED)
        for message in (Waypoint(clear_wp_list=True), waypoint(400, 0, -60), waypoint(400, 400, -60), waypoint(0, 400, -60)):
            listed.publish(message)
        first = world.until_path(lambda m: m.path_type == CurrentPath.LINE_PATH, "a line north", height=60.0)
        assert first.q[0] == pytest.approx(1.0, abs=0.01)
        corner = world.until_path(lambda m: m.path_type == CurrentPath.ORBIT_PATH, "the fillet", north=345.0, height=60.0)
        assert corner.c[0] == pytest.approx(340.0, abs=2.0) and corner.c[1] == pytest.approx(60.0, abs=2.0)
        # What cannot be flown is refused with the reason.
        refused = set_parameters(peer, "path_manager", R_min=500.0)[0]
        assert not refused.successful and refused.reason.startswith("waypoint ") and "found" in refused.reason, refused
        assert set_parameters(peer, "path_manager", R_min=50.0)[0].successful
        corner = world.until_path(lambda m: m.path_type == CurrentPath.ORBIT_PATH and abs(m.rho - 50.0) < 1e-3, "the new radius",
                                  north=352.0, height=60.0)
        # No place: a circle at a fixed bank. The state ends: so does everything.
        world.until_phase(FlightPhase.LOITER, north=math.nan, height=60.0)
        assert "position lost" in manager.until("position lost")
        world.until_phase(FlightPhase.MISSION, north=200.0, height=60.0)
        assert falls_silent(world.phases, lambda: world.tick(height=math.nan))


def test_path_manager_lands_on_request_only_when_it_flies(peer):
    with start("path_manager", use_sim_time="true"):
        world = World(peer)
        world.until_phase(FlightPhase.DISARMED, height=0.0, airspeed=0.0)
        answer = peer.call(Trigger, "land")
        assert not answer.success and answer.message == "phase disarmed"
        peer.publisher(Waypoint, "waypoint_path", LATCHED).publish(waypoint(300, 0, -60))
        world.armed = True
        world.until_phase(FlightPhase.TAKEOFF, height=0.0, airspeed=0.0)
        world.until_phase(FlightPhase.MISSION, height=50.0)
        assert peer.call(Trigger, "return_to_base").success
        world.until_phase(FlightPhase.RETURN, height=50.0)
        assert peer.call(Trigger, "land").success
        world.until_phase(FlightPhase.APPROACH, height=50.0)


def test_the_throttle_of_the_failsafe_command_is_no_dead_motor(peer):
    with start("path_manager", use_sim_time="true") as manager:
        world = World(peer)
        world.until_phase(FlightPhase.DISARMED, height=0.0, airspeed=0.0)
        peer.publisher(Waypoint, "waypoint_path", LATCHED).publish(waypoint(300, 0, -60))
        world.armed = True
        world.until_phase(FlightPhase.TAKEOFF, height=0.0, airspeed=0.0)
        world.until_phase(FlightPhase.MISSION, height=50.0)
        # Full throttle commanded, and it sinks at 2 m/s. At first another's throttle turns the motor.
        sinking = {"height": 50.0, "climb": -2.0}
        world.failsafe, world.throttle = True, 1.0
        peer.poll(lambda: world.tick(**sinking) or "receiver lost" in manager.text(), "that the failsafe command flies")
        first = len(world.phases)
        peer.poll(lambda: world.tick(**sinking) or len(world.phases) > first + 250, "5 s of phases")
        assert {m.phase for m in world.phases[first:]} == {FlightPhase.LOITER}  # from where the failsafe command has led
        world.failsafe = False
        world.until_phase(FlightPhase.GLIDE, **sinking)
