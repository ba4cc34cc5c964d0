# SPDX-License-Identifier: BSD-3-Clause
"""The launched simulator and stack, two flights: outside of a fence it returns and lands where it took off; with a battery that
has given some of its charge it does the same. Judged by the truth."""

import math
from pathlib import Path

import pytest
from copter_flight import Flight
from ros_rig import ROOT
from rosflight_msgs.msg import BatteryStatus, Fence
from sim_rig import LATCHED, VEHICLE

FENCE_M = 6.0  # less than the first waypoint of missions/default.yaml, 8 m north
# The levels of the charge, so high that the flight needs no minutes.
LEVELS = "  battery: {warn_charge: 0.985, return_charge: 0.97, land_charge: 0.2}\n"


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    folder = tmp_path_factory.mktemp("limits")
    vehicle = folder / "small_battery.yaml"
    text = Path(VEHICLE).read_text().replace("capacity_Ah: 8", "capacity_Ah: 2", 1).replace("autonomy:\n", "autonomy:\n" + LEVELS, 1)
    assert "capacity_Ah: 2" in text and LEVELS in text
    vehicle.write_text(text)
    with Flight("roscopter", "fly.launch.py", folder, vehicle_file=vehicle, mission_file=ROOT / "missions/default.yaml") as world:
        world.battery = world.peer.listen(BatteryStatus, "battery")
        world.fence = world.peer.publisher(Fence, "mission/fence", LATCHED)
        world.set_up()
        yield world


def from_take_off(flight, point):
    return math.hypot(point.x - flight.start[0], point.y - flight.start[1])


def land_at_the_start(flight):
    flight.until_phase("landing")
    flight.until_phase("landed")
    place = flight.truth[-1].pose.position
    assert from_take_off(flight, place) < 2.0 and abs(place.z) < 0.4
    assert "mission done" not in flight.process.text()
    speeds = [m.twist.linear.z for m in list(flight.truth) if -0.3 < m.pose.position.z < -0.1]
    assert max(speeds) < 1.0, "softly"
    flight.pilot("toggle_override", lambda: flight.status[-1].rc_override & 1, "the override")
    flight.disarm()
    flight.until_phase("disarmed")


def take_off(flight):
    flight.start = flight.place()
    flight.truth.clear()
    flight.take_off()
    flight.until_phase("offboard")


def test_outside_of_a_fence_it_returns_and_lands_where_it_took_off(flight):
    take_off(flight)
    flight.fence.publish(Fence(radius=FENCE_M, height=30.0))
    flight.process.until("fence: 6 m around the start, 30 m high")
    land_at_the_start(flight)
    assert flight.process.text().count("outside of the fence: returns (6 m around the start, 30 m high)") == 1
    farthest = max(from_take_off(flight, m.pose.position) for m in list(flight.truth))
    assert FENCE_M < farthest < FENCE_M + 5.0
    flight.judge_errors()
    flight.fence.publish(Fence(radius=math.nan, height=math.nan))
    flight.process.until("fence: none")


def test_a_low_battery_brings_it_back(flight):
    before = len(flight.process.lines)
    take_off(flight)
    land_at_the_start(flight)
    text = "\n".join(flight.process.lines[before:])
    assert text.count("battery low (") == text.count("battery low: returns (") == 1, text[-3000:]
    assert "battery low: lands" not in text
    assert max(from_take_off(flight, m.pose.position) for m in list(flight.truth)) > 7.0, "it was on its way"
    assert min(m.voltage for m in list(flight.battery)[-500:]) > 20.0
