# SPDX-License-Identifier: BSD-3-Clause
"""The estimator by itself, fed by an rclpy peer with the sensors of a vehicle at rest: attitude, silence, a gap, a late clock."""

import math
import time

import pytest
from copter_nodes import START_NS, copter
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Quaternion, Vector3
from rcl_interfaces.srv import ListParameters
from rosgraph_msgs.msg import Clock
from roscopter_msgs.msg import State
from rosflight_msgs.msg import Attitude, Barometer, GNSS
from sensor_msgs.msg import Imu, MagneticField
from sim_rig import ALL, ALL_BEST_EFFORT, SimPeer, stamp, stamp_ns
from std_msgs.msg import Bool

GRAVITY = 9.80665


@pytest.fixture
def peer():
    with SimPeer() as it:
        yield it


class Resting:
    """The sensors of a vehicle at rest with the nose to the east: a field of 20 uT north, 45 uT down is 20 uT to the left."""

    def __init__(self, peer):
        self.received = peer.listen(State, "estimated_state")
        self.imu, self.mag = peer.publisher(Imu, "imu/data", ALL), peer.publisher(MagneticField, "magnetometer", ALL)
        self.baro, self.gnss = peer.publisher(Barometer, "baro", ALL), peer.publisher(GNSS, "gnss", ALL)
        peer.poll(lambda: all(p.get_subscription_count() for p in (self.imu, self.mag, self.baro, self.gnss)), "subscribers")
        self.peer, self.tick = peer, 0

    def ns(self):
        return START_NS + self.tick * 5_000_000

    def until(self, states):
        """Sends 200 samples in a second of their stamps until so many states have come."""
        def some():
            for _ in range(5):
                if self.tick % 4 == 0:
                    self.mag.publish(stamp(MagneticField(magnetic_field=Vector3(x=0.0, y=-2e-5, z=4.5e-5)), self.ns()))
                    self.baro.publish(stamp(Barometer(pressure=86_000.0), self.ns()))
                if self.tick % 40 == 0:
                    self.gnss.publish(stamp(GNSS(fix_type=3, num_sat=12, lat=40.0, lon=-111.0, alt=1400.0,
                                                 gnss_unix_seconds=1_780_000_000), self.ns()))
                self.imu.publish(stamp(Imu(linear_acceleration=Vector3(z=-GRAVITY)), self.ns()))
                self.tick += 1
            time.sleep(0.002)
            return len(self.received) >= states
        self.peer.poll(some, f"{states} states")


def test_the_estimator_finds_its_attitude_and_falls_silent_with_the_imu(peer):
    with copter("estimator", declination=0.0) as process:
        resting = Resting(peer)
        received = resting.received
        resting.until(100)
        last = received[-1]
        assert last.psi == pytest.approx(math.pi / 2, abs=0.02) and abs(last.phi) < 0.01 and abs(last.theta) < 0.01
        assert last.quat.z == pytest.approx(math.sin(math.pi / 4), abs=0.01)
        assert math.hypot(last.p_n, last.p_e, last.p_d) < 1.0
        assert (last.initial_lat, last.initial_lon) == pytest.approx((40.0, -111.0), abs=1e-5)
        assert last.initial_alt == pytest.approx(1400.0, abs=1.0)
        stamps = [stamp_ns(m) for m in received]
        assert all(later > earlier for earlier, later in zip(stamps, stamps[1:]))
        process.until("imu/data is silent: no state goes out")

        def silent():  # states that were under way when the line was written may still arrive
            count = len(received)
            time.sleep(0.2)
            return len(received) == count
        peer.poll(silent, "the end of the states")


@pytest.mark.parametrize("restarted", [False, True])
def test_after_a_gap_the_heading_is_the_flight_controllers_unless_it_restarted(peer, restarted):
    """The estimate points east, and the flight controller, whose samples were missing for 1 s, north."""
    with copter("estimator", declination=0.0):
        resting = Resting(peer)
        attitude, again = peer.publisher(Attitude, "attitude", ALL), peer.publisher(Bool, "status/restarted", ALL)
        peer.poll(lambda: attitude.get_subscription_count() and again.get_subscription_count(), "subscribers")
        resting.until(100)
        if restarted:
            again.publish(Bool(data=True))
        resting.tick += 200
        before = len(resting.received)

        def hinted():
            attitude.publish(stamp(Attitude(attitude=Quaternion(w=1.0)), resting.ns()))
            resting.until(len(resting.received) + 1)
            return len(resting.received) >= before + 200
        peer.poll(hinted, "200 states after the gap")
        turned = max(abs(state.psi - math.pi / 2) for state in resting.received[before:])
        assert (turned < 0.1) == restarted, turned


def test_a_clock_that_is_late_makes_no_topic_silent(peer):
    """0.3 s of IMU samples arrive before the simulated time that they are stamped with."""
    with copter("estimator", use_sim_time="true") as process:
        clock, imu = peer.publisher(Clock, "/clock", ALL_BEST_EFFORT), peer.publisher(Imu, "imu/data", ALL)
        peer.poll(lambda: clock.get_subscription_count() and imu.get_subscription_count(), "subscribers")

        def publish_time(ns, times=10):  # best effort
            message = Clock()
            message.clock.sec, message.clock.nanosec = divmod(ns, 1_000_000_000)
            for _ in range(times):
                clock.publish(message)
                time.sleep(0.02)

        def sample(ns):
            imu.publish(stamp(Imu(linear_acceleration=Vector3(z=-GRAVITY)), ns))

        def read():
            """An answer shows that what came before the request has been read."""
            assert peer.call(ListParameters, "estimator/list_parameters").result.names

        # The node follows the clock when it reports its health, which it does each second of it: it may know of the publisher later than
        # that knows of it.
        health, start_ns = peer.listen(DiagnosticArray, "/diagnostics"), START_NS

        def tick():
            nonlocal start_ns
            start_ns += 100_000_000
            publish_time(start_ns, 1)
        peer.poll(lambda: tick() or health, "the node's time")
        publish_time(start_ns)
        read()
        for ms in range(0, 300, 10):
            sample(start_ns + ms * 1_000_000)
            read()
        publish_time(start_ns + 310_000_000)
        read()
        sample(start_ns + 320_000_000)
        read()
        publish_time(start_ns + 500_000_000)
        process.until("imu/data is silent: no state goes out")
        assert process.text().count("is silent") == 1 and "is back" not in process.text()
