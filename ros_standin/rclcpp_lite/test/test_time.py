# SPDX-License-Identifier: BSD-3-Clause
"""Timers and clocks of rclcpp_lite, on wall time and on a /clock that rclpy publishes."""

import time

from builtin_interfaces.msg import Time
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import SetParameters
from rosgraph_msgs.msg import Clock
from ros_peer import Process, best_effort, lite_program, until
from std_msgs.msg import Int64

SECOND = 1_000_000_000


def test_wall_timer_counts_without_gaps(tester, peer):
    received = tester.subscribe(Int64, "wall_ticks", 1000)  # also when this process waits for a processor
    until(lambda: len(received) >= 20, "20 ticks")
    counts = [message.data for message in received]
    assert counts == list(range(counts[0], counts[0] + len(counts)))


def test_ros_time_is_wall_time_without_simulated_time(tester, peer):
    received = tester.subscribe(Int64, "ros_ticks")
    until(lambda: received, "a tick")
    assert abs(received[0].data - time.time_ns()) < 60 * SECOND


class SimulatedTime:
    """Publishes /clock and receives the ticks of the peer's timer of 0.1 s."""

    def __init__(self, tester):
        self.clock = tester.publisher(Clock, "/clock", best_effort(1))
        self.ticks = tester.subscribe(Int64, "/sim/ros_ticks", 1000)
        tester.matched("/sim/ros_ticks")
        self.now_ns = 0

    def show(self, time_ns: int):
        self.now_ns = time_ns
        self.clock.publish(Clock(clock=Time(sec=time_ns // SECOND, nanosec=time_ns % SECOND)))

    def tick_at(self, time_ns: int):
        """Shows the time until the timer has said so: /clock is best effort."""
        before = len(self.ticks)

        def ticked():
            self.show(time_ns)
            time.sleep(0.002)
            return [tick.data for tick in self.ticks[before:] if tick.data == time_ns]
        until(ticked, f"a tick at {time_ns} ns; ticks: {[tick.data for tick in self.ticks]}")


def test_timer_on_simulated_time_follows_the_clock_and_its_jumps(tester):
    words = ["--ros-args", "-p", "use_sim_time:=true", "-r", "__ns:=/sim"]
    with Process(lite_program("peer_node", *words)):
        sim = SimulatedTime(tester)
        jumps = tester.subscribe(Int64, "/sim/jumps")
        tester.matched("/sim/jumps")
        wall = tester.subscribe(Int64, "/sim/wall_ticks")
        until(lambda: len(wall) > 20, "wall time goes on")
        assert not sim.ticks, "no /clock, no tick"
        for step in range(10, 16):
            sim.tick_at(step * SECOND // 10)
        assert [tick.data for tick in sim.ticks] == [n * SECOND // 10 for n in range(10, 16)]
        # Standing still: many messages with the same time are no reason to tick.
        for _ in range(50):
            sim.show(sim.now_ns)
        seen = len(wall)
        until(lambda: len(wall) > seen + 10, "wall time goes on")
        assert len(sim.ticks) == 6
        # A jump forward gives one tick, not one for each period that was missed.
        sim.tick_at(1000 * SECOND)
        sim.show(sim.now_ns)
        seen = len(wall)
        until(lambda: len(wall) > seen + 10, "wall time goes on")
        assert len(sim.ticks) == 7
        until(lambda: jumps, "the jump forward is reported")
        # After a jump back the timer goes on from there.
        until(lambda: sim.show(5 * SECOND) or len(jumps) > 1, "the jump back is reported")
        sim.tick_at(5 * SECOND + SECOND // 5)
        assert [jump.data for jump in jumps] == [1000 * SECOND - 15 * SECOND // 10, -995 * SECOND]


def test_sleep_on_simulated_time_ends_when_the_clock_says_so(tester):
    words = ["sim_nap", "--ros-args", "-r", "__node:=sleeper"]
    with Process(lite_program("waiting_program", *words)) as process:
        clock = tester.publisher(Clock, "/clock", best_effort(1))
        until(lambda: "waiting" in process.said(), "the program sleeps")
        for _ in range(20):
            clock.publish(Clock(clock=Time(sec=99, nanosec=SECOND - 1)))
            time.sleep(0.005)
        assert process.process.poll() is None, "woken too early"
        until(lambda: clock.publish(Clock(clock=Time(sec=101))) or
              process.process.poll() is not None, "the program wakes")
        assert f"slept: 1 until {101 * SECOND}" in process.said()


def test_simulated_time_can_be_switched_on_and_off_while_running(tester):
    def switch(on: bool):
        parameter = Parameter(name="use_sim_time", value=ParameterValue(type=1, bool_value=on))
        assert tester.call(SetParameters, "/switched/peer/set_parameters",
                           parameters=[parameter]).results[0].successful
    with Process(lite_program("peer_node", "--ros-args", "-r", "__ns:=/switched")):
        ticks = tester.subscribe(Int64, "/switched/ros_ticks")
        until(lambda: ticks, "a tick on wall time")
        switch(True)
        clock = tester.publisher(Clock, "/clock", best_effort(1))
        ticks.clear()
        for now in range(50, 400):
            clock.publish(Clock(clock=Time(sec=now)))
            time.sleep(0.005)
            if any(tick.data < 1000 * SECOND for tick in ticks):
                break
        assert any(50 * SECOND <= tick.data < 400 * SECOND for tick in ticks), ticks
        switch(False)
        ticks.clear()
        until(lambda: [tick for tick in ticks if abs(tick.data - time.time_ns()) < 60 * SECOND],
              "ticks on wall time again")
