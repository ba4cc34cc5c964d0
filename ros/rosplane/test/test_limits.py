# SPDX-License-Identifier: BSD-3-Clause
"""path_manager by itself: what battery, fence, another list and other settings make of a flight."""

import math

import pytest
from plane_rig import World, start, waypoint
from rosflight_msgs.msg import Fence
from rosflight_msgs.srv import ParamFile
from rosplane_msgs.msg import FlightPhase, MissionSettings, Waypoint
from rosplane_msgs.srv import AddWaypoint
from sim_rig import LATCHED, set_parameters
from std_srvs.srv import Trigger

CELLS = 6  # of vehicles/anaconda.yaml
NORTH = {"north": 200.0, "height": 60.0}  # on the first leg, more than a return lands from
EAST = {"north": 400.0, "east": 150.0, "course": math.pi / 2, "height": 60.0}  # on the second
SETTINGS = {"at_end": MissionSettings.LAND, "takeoff_height": math.nan, "turn_radius": math.nan, "landing_course": math.nan}


@pytest.fixture
def manager():
    with start("path_manager", use_sim_time="true") as process:
        yield process


class Mission(World):
    """A list of three waypoints, in flight on its first leg."""

    def __init__(self, peer, process, listed=True):
        super().__init__(peer)
        self.process = process
        self.waypoints = peer.publisher(Waypoint, "waypoint_path", LATCHED)
        self.settings = peer.publisher(MissionSettings, "mission_settings", LATCHED)
        self.fence = peer.publisher(Fence, "mission/fence", LATCHED)
        self.voltage = CELLS * 4.0
        if listed:
            self.send_list()

    def send_list(self):
        self.waypoints.publish(Waypoint(clear_wp_list=True))
        for place in ((400, 0, -60), (400, 400, -60), (0, 400, -60)):
            self.waypoints.publish(waypoint(*place))

    def take_off(self):
        standing = {"height": 0.0, "airspeed": 0.0}
        self.until_phase(FlightPhase.DISARMED, **standing)
        for _ in range(20):
            self.tick(**standing)
        self.armed = True
        self.until_phase(FlightPhase.TAKEOFF, **standing)
        self.until_phase(FlightPhase.MISSION, height=50.0)
        return self

    def fly(self, ticks=60, **fields):
        """The phases of so many ticks."""
        first = len(self.phases)
        for _ in range(ticks):
            self.tick(**fields)
        self.peer.poll(lambda: self.tick(**fields) or len(self.phases) > first + ticks // 2, "phases")
        return self.phases[first + 5:]

    def round_the_corner(self):
        for north, east, course in ((340.0, 0.0, 0.0), (370.0, 8.0, 0.6), (395.0, 35.0, 1.3)):
            self.fly(10, north=north, east=east, course=course, height=60.0)
        self.peer.poll(lambda: self.tick(**EAST) or self.phases[-1].waypoint == 1, "the second waypoint")

    def until_said(self, part, **fields):
        self.peer.poll(lambda: self.tick(**fields) or part in self.process.text(), part)

    def said(self, part):
        return self.process.text().count(part)


def test_settings_that_come_in_flight_do_not_start_the_list_again(peer, manager):
    world = Mission(peer, manager).take_off()
    world.round_the_corner()
    world.settings.publish(MissionSettings(**SETTINGS))
    assert {m.waypoint for m in world.fly(**EAST)} == {1}
    world.settings.publish(MissionSettings(**{**SETTINGS, "turn_radius": 60.0}))
    turned = world.fly(**EAST)
    assert {m.waypoint for m in turned} == {1} and {m.phase for m in turned} == {FlightPhase.MISSION}


def test_a_waypoint_that_is_added_in_flight_does_not_start_the_list_again(peer, manager, tmp_path):
    """Each one is followed by the settings of the mission."""
    mission = tmp_path / "mission.yaml"
    mission.write_text("mission:\n  - {w: [400, 0, -60]}\n  - {w: [400, 400, -60]}\n")
    with start("path_planner"):
        world = Mission(peer, manager, listed=False)
        assert peer.call(ParamFile, "load_mission_from_file", filename=str(mission)).success
        world.take_off()
        world.round_the_corner()
        added = peer.call(AddWaypoint, "add_waypoint", w=[0.0, 400.0, -60.0], va_d=15.0)
        assert added.success and "3 waypoints, 3 published" in added.message
        assert {m.waypoint for m in world.fly(**EAST)} == {1}


def test_a_new_list_ends_a_return_that_was_asked_for_and_nothing_else_does(peer, manager):
    world = Mission(peer, manager).take_off()
    assert peer.call(Trigger, "return_to_base").success
    world.until_phase(FlightPhase.RETURN, **NORTH)
    world.settings.publish(MissionSettings(**SETTINGS))
    world.waypoints.publish(waypoint(0, 800, -60))  # one more
    assert set_parameters(peer, "path_manager", default_airspeed=16.0)[0].successful
    assert {m.phase for m in world.fly(**NORTH)} == {FlightPhase.RETURN}
    world.send_list()
    world.until_phase(FlightPhase.MISSION, **NORTH)
    assert {m.phase for m in world.fly(**NORTH)} == {FlightPhase.MISSION}


def test_outside_of_the_fence_it_returns_and_lands_until_there_is_another(peer, manager):
    world = Mission(peer, manager).take_off()
    world.fence.publish(Fence(radius=90.0, height=120.0))
    world.until_said("fence: 90 m around the start, 120 m high", height=60.0)
    assert {m.phase for m in world.fly(height=60.0)} == {FlightPhase.MISSION}
    world.until_phase(FlightPhase.RETURN, north=150.0, height=60.0)
    world.process.says("outside of the fence: returns (90 m around the start, 120 m high)")
    world.fence.publish(Fence(radius=900.0, height=120.0))
    world.until_phase(FlightPhase.MISSION, north=150.0, height=60.0)
    world.fence.publish(Fence(radius=120.0, height=120.0))
    world.until_phase(FlightPhase.RETURN, north=150.0, height=60.0)
    world.until_phase(FlightPhase.APPROACH, north=20.0, height=60.0)
    world.process.says("outside of the fence: returns", 2)


def test_a_battery_is_reported_then_returns_then_lands(peer, manager):
    world = Mission(peer, manager).take_off()
    world.voltage = CELLS * 3.74
    world.until_said("battery low (3.7", **NORTH)
    assert {m.phase for m in world.fly(**NORTH)} == {FlightPhase.MISSION}
    world.voltage = CELLS * 3.70
    world.until_phase(FlightPhase.RETURN, **NORTH)
    world.process.says("battery low: returns (3.70 V in each of 6 cells at rest, ")
    world.send_list()
    assert {m.phase for m in world.fly(**NORTH)} == {FlightPhase.RETURN}, "no list takes that back"
    world.voltage = CELLS * 3.60
    world.until_phase(FlightPhase.APPROACH, **NORTH)
    world.process.says("battery low: lands (3.60 V in each of 6 cells at rest, ")
    assert world.said("[ERROR]") == 1
    world.process.says("battery low", 3)


def test_a_pack_of_other_cells_than_the_vehicle_file_says_does_not_take_off(peer, manager):
    world = Mission(peer, manager)
    standing = {"height": 0.0, "airspeed": 0.0}
    world.voltage = 16.8
    world.until_phase(FlightPhase.DISARMED, **standing)
    for _ in range(20):
        world.tick(**standing)
    world.armed = True
    world.until_said("no take-off: battery: found 16.8 V, 2.80 V in each of the 6 cells of the vehicle file", **standing)
    assert {m.phase for m in world.fly(**standing)} == {FlightPhase.DISARMED}
    world.voltage = CELLS * 4.2
    world.until_phase(FlightPhase.TAKEOFF, **standing)
    assert world.said("found no voltage") == 0


def test_a_battery_that_is_not_measured_is_named_at_the_take_off(peer, manager):
    world = Mission(peer, manager)
    world.voltage = None
    world.take_off()
    world.process.says("battery: found no voltage: the flight does not end when it is low")
