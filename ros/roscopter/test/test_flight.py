# SPDX-License-Identifier: BSD-3-Clause
"""The launched simulator and stack fly a shipped mission on the estimate, judged by the truth; then again, with another
mission that is loaded and changed in flight."""

import math

import pytest
from busy import busy
from copter_flight import Flight
from roscopter_msgs.msg import ControllerCommand, Waypoint
from roscopter_msgs.srv import AddWaypoint
from ros_rig import ROOT
from rosflight_msgs.srv import ParamFile
from sim_rig import parameter, set_parameters
from std_srvs.srv import Trigger

HOP = ROOT / "missions/hop.yaml"
HOP_PLACES = [(4, 0, -3), (4, 4, -3)]


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    with Flight("roscopter", "fly.launch.py", tmp_path_factory.mktemp("memory"), mission_file=HOP) as world:
        world.set_up()
        yield world


def errors(flight):
    """Between estimate and truth at the same times, horizontally and in height [m]."""
    truth = {(m.header.stamp.sec, round(m.header.stamp.nanosec, -6)): m.pose.position for m in list(flight.truth)}
    pairs = [(m, truth.get((m.header.stamp.sec, round(m.header.stamp.nanosec, -6)))) for m in list(flight.states)]
    return [(math.hypot(m.p_n - p.x, m.p_e - p.y), abs(m.p_d - p.z)) for m, p in pairs if p]


def test_a_shipped_mission_is_flown_on_the_estimate(flight):
    assert flight.phase() == "disarmed"
    with busy():  # the world slows down
        flight.take_off()
        flight.until_phase("offboard")
    assert -2.0 > flight.place()[2] > -3.2, "it rose to the take-off height of the mission"
    flight.until_phase("landing")
    flight.until_phase("landed")
    for place in HOP_PLACES:
        assert flight.nearest_to(place) < 2.0  # of the truth: the estimate is off by what GNSS is off
    assert "waypoint 1 reached" in flight.process.text() and "waypoint 2 reached" in flight.process.text()
    x, y, z = flight.place()
    assert abs(z) < 0.4 and math.hypot(x - 4, y - 4) < 2.5
    assert [p.data for p in flight.phases][-5:] == ["takeoff", "position_hold", "offboard", "landing", "landed"]
    valid = [c for c in list(flight.commands) if c.cmd_valid]  # the follower marks those that a slow machine made too late
    assert len(valid) > 500
    assert all(c.mode == ControllerCommand.MODE_ROLL_PITCH_YAWRATE_THRUST_TO_MIXER for c in valid)
    seen = errors(flight)
    assert len(seen) > 500
    flight.judge_errors()
    flight.judge_steps()
    rms = [math.sqrt(sum(e[k] ** 2 for e in seen) / len(seen)) for k in (0, 1)]
    assert rms[0] < 2.0 and rms[1] < 1.5, f"estimate off by {rms} m rms"  # docs/autonomy/estimation.md: 0.8 m
    flight.pilot("toggle_override", lambda: flight.status[-1].rc_override & 1, "the override")
    flight.pilot("toggle_arm", lambda: not flight.status[-1].armed, "being disarmed")
    flight.until_phase("disarmed")


def test_a_second_flight_with_waypoints_added_and_gains_changed_in_flight(flight):
    """The list is made by services; armed again it takes off again; a lower limit of speed and another gain act in flight."""
    peer = flight.peer
    assert peer.call(Trigger, "path_planner/clear_waypoints").success
    here = flight.states[-1]
    start = (here.p_n, here.p_e)

    def waypoint(north, height):
        return Waypoint(type=Waypoint.TYPE_GOTO, w=[start[0] + north, start[1], -height], psi=here.psi)
    for north in (0.0, 12.0):
        assert peer.call(AddWaypoint, "path_planner/add_waypoint", wp=waypoint(north, 4.0), publish_now=True).success
    flight.truth.clear()
    flight.take_off()
    flight.until_phase("offboard")
    flight.until(lambda: flight.states[-1].p_n > start[0] + 2.0, "the way to the second waypoint")
    assert set_parameters(flight.peer, "path_manager", max_velocity=1.0)[0].successful
    assert set_parameters(flight.peer, "trajectory_follower", u_d_kp=6.0)[0].successful
    assert parameter(peer, "trajectory_follower", "u_d_kp").double_value == 6.0
    flight.until(lambda: flight.states[-1].p_n > start[0] + 11.0 and not any(flight.setpoints[-1].velocity), "the second waypoint")
    flight.setpoints.clear()
    back = peer.call(AddWaypoint, "path_planner/add_waypoint", wp=waypoint(6.0, 4.0), publish_now=True)
    assert back.success, back.message
    flight.until(lambda: flight.states[-1].p_n < start[0] + 7.0, "the way back")
    speeds = [math.hypot(*m.velocity) for m in list(flight.setpoints)]
    assert 0.9 < max(speeds) < 1.01, "the new limit of the leg"
    assert not peer.call(ParamFile, "path_planner/load_mission_from_file", filename=str(ROOT / "missions/racetrack.yaml")).success
    assert flight.phase() == "offboard", "a refused mission changes nothing"
    assert peer.call(Trigger, "controller/land").success
    flight.until_phase("landed")
    assert abs(flight.place()[2]) < 0.4
