# SPDX-License-Identifier: BSD-3-Clause
"""Wall time on a machine that has too much to do: the board's time waits for the world, and reports no fault that is none."""

import contextlib
import os
import subprocess
import sys
import time

from ros_rig import free_udp_port
from rosflight_msgs.msg import Status
from sim_rig import SimPeer, launch

SECONDS = 25.0
LOOPS_PER_PROCESSOR = 4
FALSE_ALARMS = ("not responding", "RC lost", "failsafe", "Failsafe")


@contextlib.contextmanager
def busy():
    """Programs that want all processors."""
    loops = [subprocess.Popen([sys.executable, "-c", "while True: pass"])
             for _ in range(LOOPS_PER_PROCESSOR * len(os.sched_getaffinity(0)))]
    try:
        yield
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()


def test_a_busy_machine_makes_no_false_alarm(tmp_path):
    ports = {"simulation_port": free_udp_port(), "ROS_port": free_udp_port()}
    with SimPeer("judge") as peer, launch("rosflight_sim", "multirotor_standalone.launch.xml", use_sim_time="false",
                                          memory_folder=tmp_path, **ports) as world:
        world.until("ready: ")
        status = peer.listen(Status, "status")
        peer.wait(lambda: status, "a status")
        told = len(world.lines)
        with busy():
            time.sleep(SECONDS)
        alarms = [line for line in world.lines[told:] if any(part in line for part in FALSE_ALARMS)]
        assert not alarms, "\n".join(world.lines[told:])
        assert not any(message.failsafe for message in status)
        count = len(status)
        peer.wait(lambda: len(status) > count, "a status afterwards")
