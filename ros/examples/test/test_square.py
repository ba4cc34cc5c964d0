# SPDX-License-Identifier: BSD-3-Clause
"""Both examples fly their square in the launched simulator; where they were is judged from outside. The second flight
is on forces and moments of somebody else, in Python."""

import math
import sys
import threading
import time

import pytest
from ros_rig import ROOT, free_udp_port
from rosflight_msgs.msg import SimState, Status
from rosgraph_msgs.msg import Clock
from sim_rig import BEST_EFFORT, Process, SimPeer, executable, last_s, launch, stamp, stamp_ns
from std_srvs.srv import Trigger

PYTHON_FORCES = ROOT / "ros/rosflight_sim/test/python_forces.py"
CORNERS = [(0, 0), (3, 0), (3, 3), (0, 3), (0, 0)]
FASTEST = "10.0"  # more than this machine holds: as fast as it can, and time waits for the world


def distance_to_square(x, y):
    """From the outline, inside or outside."""
    inside = min(x, 3 - x, y, 3 - y)
    return inside if inside >= 0 else math.hypot(max(-x, 0, x - 3), max(-y, 0, y - 3))


@pytest.mark.parametrize("program, modules, forces", [
    ("square", {}, None), ("square.py", {"forces": "false"}, PYTHON_FORCES)])
def test_a_square_is_flown(tmp_path, program, modules, forces):
    ports = {"simulation_port": free_udp_port(), "ROS_port": free_udp_port()}
    with SimPeer("judge") as judge, launch("rosflight_sim", "multirotor_standalone.launch.xml", use_sim_time="true",
                                           real_time_multiplier=FASTEST, memory_folder=tmp_path, **ports, **modules) as world:
        theirs = Process(sys.executable, forces) if forces else None
        try:
            world.until("ready: ")
            truth, status = judge.listen(SimState, "sim/truth_state"), judge.listen(Status, "status")
            judge.wait(lambda: truth and status, "the world")  # without forces it does not move, and time waits for nobody
            with launch("rosflight_sim", "multirotor_init_firmware.launch.py") as init:
                assert init.end() == 0, init.text()
            truth.clear()
            with launch("rosflight_examples", "square.launch.xml", exec=program, use_sim_time="true") as flight:
                judge.wait_simulated(lambda: flight.process.poll() is not None, "the end of the square", lambda: last_s(truth))
                assert flight.end() == 0, flight.text() + world.text()
            assert "[square]: done" in flight.text()
        finally:
            if theirs:
                theirs.stop()
        judge.wait(lambda: not status[-1].armed, "the motors to stop")
        stopped_ns = stamp_ns([m for m in status if m.armed][-1])
        judge.wait(lambda: stamp_ns(truth[-1]) >= stopped_ns, "the truth until then")
    truth = [m for m in truth if stamp_ns(m) <= stopped_ns]
    flown = [(m.pose.position.x, m.pose.position.y, -m.pose.position.z) for m in truth]
    at_height = [(x, y) for x, y, height in flown if height > 1.5]
    for corner in CORNERS:
        assert min(math.dist(corner, place) for place in at_height) < 0.3
    assert max(distance_to_square(x, y) for x, y in at_height) < 0.6
    assert 1.7 < max(height for _, _, height in flown) < 2.6
    assert flown[-1][2] < 0.4 and math.hypot(*flown[-1][:2]) < 0.5
    assert any(m.armed and m.offboard and not m.rc_override & 3 for m in status)
    assert not status[-1].armed and not any(m.failsafe for m in status)


@pytest.fixture(params=["square", "square.py"])
def square(request):
    """Starts one of the two programs with parameters."""
    program = executable("rosflight_examples", request.param)
    return lambda *given: Process(program, "--ros-args", *(word for text in given for word in ("-p", text)))


def test_its_time_to_wait_begins_when_simulated_time_does(square):
    """Also where the simulator has run for long. It gives up a minute of its time later, because nobody is there."""
    with SimPeer() as peer, square("use_sim_time:=true", "side_m:=5") as program:
        clock = peer.publisher(Clock, "/clock", BEST_EFFORT)
        program.until("waiting for the simulator")
        peer.poll(clock.get_subscription_count, "the program's clock")
        now = [1000.0]

        def tick():
            now[0] += 0.5
            message = Clock()
            message.clock.sec, message.clock.nanosec = int(now[0]), int(now[0] % 1 * 1e9)
            clock.publish(message)
            return program.process.poll() is not None
        peer.poll(tick, "the end")
        assert program.end() == 1 and program.lines[-1].endswith("gave up: nothing moves on")
        assert now[0] > 1060.0


def test_a_switch_is_asked_for_again_only_after_its_answer_and_a_newer_status(square):
    """It flips each time: asked twice by a busy machine, it would disarm in flight."""
    with SimPeer() as peer, square("use_sim_time:=true") as program:
        clock, status = peer.publisher(Clock, "/clock", BEST_EFFORT), peer.publisher(Status, "status")
        truth = peer.publisher(SimState, "sim/truth_state")
        asked, answer = [], threading.Event()

        def flip(_, response):
            asked.append(now[0])
            answer.wait(60)
            return response
        now, newest = [100.0], [100.0]
        peer.node.create_service(Trigger, "toggle_arm", flip)

        def tick(following=True):
            now[0] += 0.1
            newest[0] = now[0] if following else newest[0]
            message = Clock()
            message.clock.sec, message.clock.nanosec = divmod(round(now[0] * 1e9), 1_000_000_000)
            clock.publish(message)
            truth.publish(stamp(SimState(), round(now[0] * 1e9)))
            status.publish(stamp(Status(), round(newest[0] * 1e9)))
        peer.poll(lambda: tick() or asked, "the first call")
        for _ in range(50):
            tick()
            time.sleep(0.02)
        assert len(asked) == 1  # it has not been answered
        newest[0] = now[0]
        answer.set()
        for _ in range(50):
            tick(following=False)
            time.sleep(0.02)
        assert len(asked) == 1  # the status is older than the answer
        peer.poll(lambda: tick() or len(asked) == 2, "another call")


def test_a_number_may_be_whole_and_a_word_is_refused(square):
    with square("side_m:=5", "height_m:=2") as program:
        program.until("waiting for the simulator")
    with square("side_m:=wide") as program:
        assert program.end() == 2
        assert program.lines[-1].endswith("allowed a number") and "parameter side_m: found 'wide'" in program.lines[-1]
