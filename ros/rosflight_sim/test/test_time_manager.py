# SPDX-License-Identifier: BSD-3-Clause
"""The time manager by itself: its rate and factor, pause and steps, and whom time waits for."""

import math
import os
import random
import signal
import time
from functools import partial

from rcl_interfaces.msg import ParameterType
from rcl_interfaces.srv import GetParameters
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rosflight_msgs.msg import SimState
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu
from sim_contract import check_module
from sim_rig import ALL, ALL_BEST_EFFORT, SimPeer, node, set_parameters, sim_state, stamp
from std_srvs.srv import Trigger

TICK_NS = 2_500_000
NEWEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)


def newest_ns(received):
    """The time of the newest message of a clock, -1 before the first."""
    return received[-1].clock.sec * 1_000_000_000 + received[-1].clock.nanosec if received else -1


def test_time(peer):
    with node("standalone_time_manager", at_launch="standalone_time_manager", start_paused="true",
              single_step_us=2500.0, default_pub_rate_us=1250.0) as process:
        check_module(peer, "time")
        received = peer.listen(Clock, "/clock", ALL_BEST_EFFORT)
        now_ns = partial(newest_ns, received)
        peer.wait(lambda: received, "time, which is published again and again while it stands")
        first = int(peer.call(Trigger, "time_manager/take_step").message.split()[2])
        for count in range(1, 11):
            answer = peer.call(Trigger, "time_manager/take_step")
            assert answer.success and int(answer.message.split()[2]) == first + count * TICK_NS
        peer.wait(lambda: now_ns() == first + 10 * TICK_NS, "the last step")
        assert peer.call(Trigger, "time_manager/toggle_pause").message == "running"
        peer.wait(lambda: now_ns() > first + 1_000_000_000, "time to run")
        refused = peer.call(Trigger, "time_manager/take_step")
        assert not refused.success and "paused" in refused.message
        assert peer.call(Trigger, "time_manager/toggle_pause").message == "paused"
        times = [m.clock.sec * 1_000_000_000 + m.clock.nanosec for m in received]
        assert all(later >= earlier for earlier, later in zip(times, times[1:]))
        assert all(m.clock.nanosec < 1_000_000_000 for m in received)
        # A factor that the world does not hold is reported with what is reached.
        truth = peer.publisher(SimState, "sim/truth_state", ALL)
        assert set_parameters(peer, "standalone_time_manager", real_time_multiplier=100.0)[0].successful
        peer.call(Trigger, "time_manager/toggle_pause")

        def behind():
            truth.publish(sim_state(now_ns()))
            return "cannot hold real_time_multiplier 100.00: time runs at " in process.text()
        peer.poll(behind, "the warning of a slow world")
        assert not set_parameters(peer, "standalone_time_manager", real_time_multiplier=0.0)[0].successful


def test_a_whole_number_is_good_for_a_decimal_one(peer):
    """`real_time_multiplier:=3` is an integer for ROS."""
    with node("standalone_time_manager", at_launch="standalone_time_manager", real_time_multiplier=3):
        value, = peer.call(GetParameters, "standalone_time_manager/get_parameters", names=["real_time_multiplier"]).values
        assert (value.type, value.double_value) == (ParameterType.PARAMETER_DOUBLE, 3.0)


def test_the_clock_ticks_between_the_steps(peer):
    """/clock has every step and times between them, on whole ticks, never one before another; /clock_steps the steps alone."""
    with node("standalone_time_manager", at_launch="standalone_time_manager", real_time_multiplier=0.1):
        clock, steps = (peer.listen(Clock, topic, ALL_BEST_EFFORT) for topic in ("/clock", "/clock_steps"))

        def times(received):
            return [m.clock.sec * 1_000_000_000 + m.clock.nanosec for m in list(received)]
        peer.wait(lambda: len(set(times(steps))) > 20 and len(set(times(clock))) > 200, "twenty steps and ten times as many ticks")
        assert all(time_ns % TICK_NS == 0 for time_ns in times(steps))
        told = times(clock)
        assert all(later >= earlier for earlier, later in zip(told, told[1:]))
        assert all(time_ns % 100_000 == 0 for time_ns in told)
        assert set_parameters(peer, "standalone_time_manager", clock_tick_us=2500.0)[0].successful
        last = times(clock)[-1]
        # What was published before the change may arrive late.
        peer.wait(lambda: times(clock)[-1] > last + 20 * TICK_NS and all(time_ns % TICK_NS == 0 for time_ns in times(clock)[-10:]),
                  "ten stamps on steps alone")


def test_a_truth_that_is_sent_again_does_not_move_time(peer):
    with node("standalone_time_manager", at_launch="standalone_time_manager", real_time_multiplier=10.0, start_paused="true"):
        received = peer.listen(Clock, "/clock", ALL_BEST_EFFORT)
        truth = peer.publisher(SimState, "sim/truth_state", ALL)
        peer.wait(lambda: received, "time")
        peer.poll(lambda: truth.get_subscription_count() > 0, "the time manager at the truth")
        now_ns = partial(newest_ns, received)
        first = now_ns()
        truth.publish(sim_state(first))
        assert peer.call(Trigger, "time_manager/toggle_pause").message == "running"
        peer.wait(lambda: now_ns() > first, "the next step")
        time.sleep(0.1)
        at = now_ns()
        for _ in range(20):
            truth.publish(sim_state(first))
            time.sleep(0.005)
        assert now_ns() == at
        truth.publish(sim_state(at))
        peer.wait(lambda: now_ns() > at, "time to go on")


def test_time_waits_for_a_topic_that_is_due(peer):
    """It stops a lag after the next stamp is due, goes on with the message, and after two seconds without one; seconds in which the
    machine stood still do not count. A first interval that was short does not stop it, and a message that was lost does not let it run
    further ahead."""
    lag_ns, step_ns, apart_ns = 5_000_000, 2_500_000, 20_000_000
    with node("standalone_time_manager", at_launch="standalone_time_manager", wait_for="follower", start_paused="true") as process:
        received = peer.listen(Clock, "/clock", ALL_BEST_EFFORT)
        follower = peer.publisher(Imu, "follower", ALL)
        peer.wait(lambda: received, "time")
        peer.poll(lambda: follower.get_subscription_count() > 0, "the time manager at the topic")
        now_ns = partial(newest_ns, received)

        def say(at_ns):
            follower.publish(stamp(Imu(), at_ns))
        at_ns = step_ns
        for interval_ns in (0, 3_000_000, *3 * [apart_ns]):  # the first timer was late
            at_ns += interval_ns
            say(at_ns)  # an answer to a request shows that the message before it has been read
            assert set_parameters(peer, "standalone_time_manager", max_lag_us=lag_ns / 1000)[0].successful
        assert peer.call(Trigger, "time_manager/toggle_pause").message == "running"
        for _ in range(30):
            due_ns = at_ns + apart_ns
            peer.wait(lambda due=due_ns: now_ns() > due, "time to run up to the next message")
            time.sleep(0.03)  # in which it would run on by 30 ms
            assert now_ns() <= due_ns + lag_ns + step_ns
            at_ns += apart_ns
            say(at_ns)
        at_ns += 2 * apart_ns  # of two messages one is lost
        say(at_ns)
        peer.wait(lambda: now_ns() > at_ns + apart_ns, "time to run on")
        before = now_ns()
        os.kill(process.process.pid, signal.SIGSTOP)
        time.sleep(3.0)
        os.kill(process.process.pid, signal.SIGCONT)
        time.sleep(0.5)
        given_up = "no /follower for 2 s: time goes on without it"
        assert given_up not in process.text() and now_ns() <= at_ns + apart_ns + lag_ns + step_ns
        process.until(given_up)
        peer.wait(lambda: now_ns() > before + 500_000_000, "time without the follower")


def test_a_node_that_is_late_hardly_finds_a_time_twice(peer):
    """A timer of 390 Hz as rcl has it: what is due is called, the next call is whole periods after the last, also when it was late; the
    stamp is the time when the work is done. Busy for less than half a period, and now and then for three."""
    period_ns, work_s = 2_564_000, random.Random(7)
    with node("standalone_time_manager", at_launch="standalone_time_manager", wait_for="estimate"):
        received = peer.listen(Clock, "/clock", NEWEST)  # as the time source of a node: who keeps more reads the past
        estimate = peer.publisher(Imu, "estimate", ALL)
        peer.wait(lambda: received, "time")
        peer.poll(lambda: estimate.get_subscription_count() > 0, "the time manager at the topic")
        now_ns = partial(newest_ns, received)
        stamps, late, due_ns = [], [], now_ns()
        for k in range(800):
            begin_s = time.monotonic()
            while now_ns() < due_ns:
                begin_s = time.monotonic()
                time.sleep(1e-4)
            due_ns += period_ns * max(1, math.ceil((now_ns() - due_ns) / period_ns))
            time.sleep(8e-3 if k % 25 == 0 else work_s.uniform(0.0, 1e-3))
            stamps.append(now_ns())
            estimate.publish(stamp(Imu(), stamps[-1]))
            late.append(time.monotonic() - begin_s > 0.5e-9 * period_ns)  # each 25th, and more on a busy machine
    learnt = 250
    intervals = [later - earlier for earlier, later in zip(stamps, stamps[1:])][learnt:]
    # This reader of the clock is in Python and polls: seldom, a tick is late by more than half a period.
    assert intervals.count(0) <= len(intervals) / 100, f"{intervals.count(0)} of {len(intervals)} times twice"
    mean_ns = sum(intervals) / len(intervals)
    late_share = sum(late[learnt:]) / len(late[learnt:])
    assert period_ns * 0.98 < mean_ns < period_ns * (1 + late_share), "each period is called once, but for one in each of the long works"


def test_scaled_time_has_the_factor(peer):
    """Judged by the node's own clock against the wall between two of its messages; a busy machine only makes it slower."""
    with node("standalone_time_manager", at_launch="standalone_time_manager", real_time_multiplier=0.5):
        received = peer.listen(Clock, "/clock", ALL_BEST_EFFORT)
        peer.wait(lambda: received, "time")
        start, first = time.monotonic(), received[-1]
        peer.wait(lambda: received[-1].clock.sec - first.clock.sec >= 1, "a second")
        elapsed = time.monotonic() - start
        passed = received[-1].clock.sec - first.clock.sec + 1e-9 * (received[-1].clock.nanosec - first.clock.nanosec)
        assert passed <= 0.51 * elapsed + 0.02
