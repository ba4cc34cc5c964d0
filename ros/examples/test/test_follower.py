# SPDX-License-Identifier: BSD-3-Clause
"""A trajectory follower in Python in place of roscopter's flies a shipped mission."""

import math

from copter_flight import Flight
from ros_rig import ROOT


def test_a_mission_is_flown_on_a_follower_in_python(tmp_path):
    with Flight("rosflight_examples", "own_follower.launch.xml", tmp_path, mission_file=ROOT / "missions/hop.yaml") as flight:
        flight.set_up()

        def followers():
            names = [end.node_name for end in flight.peer.node.get_publishers_info_by_topic("/high_level_command")]
            return names if "_NODE_NAME_UNKNOWN_" not in names else []  # rmw's word until the node's name has come too
        flight.until(followers, "somebody who follows")  # Python starts later than the rest
        assert followers() == ["trajectory_follower"]
        assert "roscopter/lib" not in flight.process.text() and "roscopter/trajectory_follower" not in flight.process.text()
        flight.take_off()
        flight.until_phase("landed")
        told = flight.process.text()
        assert "waypoint 1 reached" in told and "waypoint 2 reached" in told, told[-3000:]
    flown = [m.position for m in list(flight.setpoints)]
    assert max(p[0] for p in flown) > 3.9 and max(p[1] for p in flown) > 3.9
    for place in ((4, 0, -3), (4, 4, -3)):
        assert flight.nearest_to(place) < 2.0
    for state, to in nearest(list(flight.states), list(flight.setpoints)):
        assert math.dist((state.p_n, state.p_e, state.p_d), to.position) < 1.5, "it stays with the trajectory"


def nearest(states, setpoints):
    """Pairs of state and setpoint of one stamp, while offboard."""
    by_stamp = {(m.header.stamp.sec, m.header.stamp.nanosec): m for m in states}
    return [(by_stamp[key], m) for m in setpoints if (key := (m.header.stamp.sec, m.header.stamp.nanosec)) in by_stamp]
