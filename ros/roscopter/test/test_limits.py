# SPDX-License-Identifier: BSD-3-Clause
"""The path manager by itself: what battery and fence make of a flight, and what a new list of waypoints makes of a return."""

import contextlib
import math
import time

import pytest
from copter_nodes import START_NS, Path, copter, state
from roscopter_msgs.msg import State, TrajectoryCommand, Waypoint
from rosflight_msgs.msg import BatteryStatus, Fence
from sim_rig import LATCHED, SimPeer
from std_msgs.msg import String
from std_srvs.srv import Trigger

START = (1.0, 2.0, 0.0)
HOME = (1.0, 2.0, -5.0)  # return_height_m is 5
CELLS = 6  # of vehicles/multirotor.yaml


@pytest.fixture
def peer():
    with SimPeer() as it:
        yield it


def to(north):
    return Waypoint(type=Waypoint.TYPE_GOTO, w=[float(north), 2.0, -3.0])


class InFlight(Path):
    """On its way from START to a waypoint 60 m north of it; the controller is this peer."""

    def __init__(self, peer, process, phases):
        self.landings, self.process, self.phase = [], process, phases
        self.fence = peer.publisher(Fence, "mission/fence", LATCHED)
        self.battery = peer.publisher(BatteryStatus, "battery")
        self.cell = 4.0

        def land(_, response):
            self.landings.append(self.place)
            response.success = True
            return response
        peer.node.create_service(Trigger, "controller/land", land)
        super().__init__(peer, START)
        peer.poll(self.battery.get_subscription_count, "a subscription of battery")
        self.waypoints.publish(to(61))
        self.until_listed(1)
        for _ in range(20):  # it knows battery and place before it takes off
            self.step()
            time.sleep(0.02)
        self.enter("takeoff")
        peer.poll(lambda: self.back().message == "found no path in flight, allowed on one", "the take-off")
        self.enter("offboard")
        self.until(lambda: self.place[0] > 3.0, "the first metres")

    def back(self):
        return self.peer.call(Trigger, "path_manager/return_to_base")

    def enter(self, phase):
        self.phase.publish(String(data=phase))

    def until_listed(self, count):
        self.peer.poll(lambda: f"{count} waypoints" == self.peer.call(Trigger, "path_manager/print_waypoints").message, "the waypoints")

    def step(self, seconds=0.05):
        self.battery.publish(BatteryStatus(voltage=CELLS * self.cell, current=0.0))
        return super().step(seconds)

    def until(self, condition, what):
        for _ in range(4000):
            if condition():
                return
            self.step()
        raise AssertionError(f"no {what}; at {self.place}\n{self.process.text()}")

    def said(self, part):
        return self.process.text().count(part)


@contextlib.contextmanager
def in_flight(peer, **parameters):
    phases = peer.publisher(String, "flight_phase", LATCHED)
    phases.publish(String(data="disarmed"))
    with copter("path_manager", **parameters) as process:
        yield InFlight(peer, process, phases)


def test_outside_of_the_fence_it_returns_to_the_take_off_and_lands(peer):
    with in_flight(peer, max_velocity=3.0) as flight:
        flight.fence.publish(Fence(radius=10.0, height=50.0))
        flight.process.until("fence: 10 m around the start, 50 m high")
        farthest = 0.0

        def landed():
            nonlocal farthest
            farthest = max(farthest, flight.place[0] - START[0])
            return flight.landings
        flight.until(landed, "landing")
        assert 10.0 < farthest < 25.0, "half a second beyond it, then it brakes"
        assert flight.landings[0] == pytest.approx(HOME, abs=1e-3)
        flight.process.says("outside of the fence: returns (10 m around the start, 50 m high)")
        assert flight.said("waypoint") == 0, "those of the return are nobody's"
        # Another flight with the same list, and with what was added meanwhile.
        for north in (62, 63):
            flight.waypoints.publish(to(north))
        flight.process.until("found one during a return, kept for the next flight")
        flight.enter("takeoff")
        flight.until_listed(3)


def test_a_fence_that_was_there_before_the_flight_counts_too_and_so_does_its_height(peer):
    fences = peer.publisher(Fence, "mission/fence", LATCHED)
    fences.publish(Fence(radius=math.inf, height=2.5))
    with in_flight(peer) as flight:
        flight.until(lambda: flight.landings, "landing")
        assert flight.landings[0] == pytest.approx((*HOME[:2], -0.9 * 2.5), abs=1e-3), "the return is no higher than the fence"
        flight.process.says("outside of the fence: returns")


def test_a_new_list_ends_the_return_of_a_fence(peer):
    with in_flight(peer, max_velocity=3.0) as flight:
        flight.fence.publish(Fence(radius=10.0, height=50.0))
        flight.until(lambda: flight.said("outside of the fence: returns"), "return")
        flight.until(lambda: flight.place[2] < -4.9 and flight.place[0] < 9.0, "place inside of the fence on the way back")
        flight.waypoints.publish(Waypoint(clear_wp_list=True))
        flight.waypoints.publish(to(6))
        flight.until(lambda: math.dist(flight.place, (6.0, 2.0, -3.0)) < 0.05, "new waypoint")
        for _ in range(100):
            flight.step()
        assert not flight.landings and flight.place == pytest.approx((6.0, 2.0, -3.0), abs=1e-3)
        assert flight.back().success, "it may be called back again"


def test_a_battery_is_reported_then_returns_then_lands_where_it_is(peer):
    with in_flight(peer, max_velocity=2.0) as flight:
        flight.until(lambda: flight.place[0] > 20.0, "place far from the take-off")
        flight.cell = 3.74
        flight.until(lambda: flight.said("battery low"), "warning")
        flight.process.says("battery low (3.74 V in each of 6 cells at rest, ")
        north = flight.place[0]
        for _ in range(100):
            flight.step()
        assert flight.place[0] > north + 1.0, "it flies on"
        flight.cell = 3.71
        flight.until(lambda: flight.said("battery low: returns (3.71 V in each of 6 cells at rest, "), "return")
        turned = flight.place[0]
        flight.until(lambda: flight.place[0] < turned - 0.5, "way back")
        assert flight.place[2] == pytest.approx(-5.0, abs=0.01)
        # What the battery asks for no list takes back.
        flight.waypoints.publish(Waypoint(clear_wp_list=True))
        flight.waypoints.publish(to(200))
        for _ in range(60):
            flight.step()
        assert flight.place[0] < turned - 0.5 and not flight.landings
        flight.cell = 3.60
        flight.until(lambda: flight.landings, "landing")
        assert flight.landings[0][0] > START[0] + 2.0, "where it is"
        flight.process.says("battery low: lands (3.60 V in each of 6 cells at rest, ")
        assert flight.said("[ERROR]") == 1
        flight.process.says("battery low", 3)


def test_a_low_battery_returns_from_a_hold_too_and_from_where_the_pilot_has_flown_it(peer):
    with in_flight(peer) as flight:
        flight.enter("position_hold")
        flight.until(lambda: not any(flight.received[-1].velocity), "rest")
        flight.cell = 3.70
        flight.until(lambda: flight.said("battery low: returns"), "return")
        flight.place = (20.0, 30.0, -3.0)  # by the pilot
        flight.step()
        flight.enter("offboard")
        flight.until(lambda: flight.place[2] < -4.9, "climb")
        assert flight.place == pytest.approx((20.0, 30.0, -5.0), abs=0.2)
        flight.until(lambda: flight.landings, "landing")
        assert flight.landings[0] == pytest.approx(HOME, abs=1e-3)


def test_without_a_take_off_that_was_seen_a_low_battery_lands(peer):
    """Started again in the air, it has no place to return to."""
    phases = peer.publisher(String, "flight_phase", LATCHED)
    phases.publish(String(data="offboard"))
    landings = []
    peer.node.create_service(Trigger, "controller/land", lambda _, response: (landings.append(1), response)[1])
    with copter("path_manager") as process:
        path = Path(peer, (1.0, 2.0, -3.0))
        battery = peer.publisher(BatteryStatus, "battery")
        peer.poll(battery.get_subscription_count, "a subscription of battery")
        path.waypoints.publish(to(61))
        peer.poll(lambda: "1 waypoints" in peer.call(Trigger, "path_manager/print_waypoints").message, "the waypoint")

        def landing():
            battery.publish(BatteryStatus(voltage=CELLS * 3.70, current=0.0))
            path.step()
            return landings
        peer.poll(landing, "the landing")
        process.until("battery low: returns")
        process.says("lands: no take-off was seen")


def test_a_battery_that_is_not_measured_is_named_at_the_take_off(peer):
    with in_flight(peer) as flight:
        assert flight.said("found no voltage") == 0
        flight.cell = 0.0
        for _ in range(5):
            flight.step()
        flight.enter("takeoff")
        flight.process.until("battery: found no voltage: the flight does not end when it is low")


def test_a_vehicle_that_another_node_commands_is_landed(peer):
    """Two that command would not bring it back."""
    phases = peer.publisher(String, "flight_phase", LATCHED)
    phases.publish(String(data="disarmed"))
    landings = []
    peer.node.create_service(Trigger, "controller/land", lambda _, response: (landings.append(1), response)[1])
    with copter("path_manager") as process:
        states = peer.publisher(State, "estimated_state")
        battery = peer.publisher(BatteryStatus, "battery")
        setpoints = peer.listen(TrajectoryCommand, "trajectory_command")
        peer.poll(lambda: states.get_subscription_count() and battery.get_subscription_count(), "subscribers")
        ns = START_NS

        def tick(cell):
            nonlocal ns
            ns += 50_000_000
            battery.publish(BatteryStatus(voltage=CELLS * cell, current=0.0))
            states.publish(state(ns, (1.0, 2.0, -3.0)))
        for _ in range(50):  # it knows where it stands before it takes off
            tick(4.0)
            time.sleep(0.02)
        phases.publish(String(data="takeoff"))
        no_path = "found no path in flight, allowed on one"  # that there is no take-off is over
        peer.poll(lambda: tick(4.0) or peer.call(Trigger, "path_manager/return_to_base").message == no_path, "the take-off")
        phases.publish(String(data="offboard"))
        peer.poll(lambda: tick(3.70) or landings, "the landing")
        process.until("battery low: returns")
        process.says("lands: the commands that are flown are not this path's")
        assert not setpoints
