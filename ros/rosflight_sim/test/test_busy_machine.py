# SPDX-License-Identifier: BSD-3-Clause
"""An armed vehicle in wall time on a machine that has too much to do: the board's time waits for the world, says so, and reports no fault that is none."""

import contextlib
import os
import re
import signal
import subprocess
import sys
import time

from ros_rig import free_udp_port
from rosflight_msgs.msg import Status
from sim_rig import SimPeer, launch, pid_of
from std_srvs.srv import Trigger

SECONDS = 10.0
LOOPS_PER_PROCESSOR = 4
STOPS_S, BETWEEN_S = (*[0.2] * 8, 1.5), 0.1
LEAD_S = 0.06  # time that the board has beyond the last sample or frame
STALLS = re.compile(r"board time stood still \d+ times, for (\d+) ms together")
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


def stand_still(pid, seconds):
    os.kill(pid, signal.SIGSTOP)
    time.sleep(seconds)
    os.kill(pid, signal.SIGCONT)


def judge(lines, status):
    alarms = [line for line in lines if any(part in line for part in FALSE_ALARMS)]
    assert not alarms, "\n".join(lines)
    assert all(message.armed and not message.failsafe for message in status)


def test_a_busy_machine_and_a_board_that_is_stopped_make_no_false_alarm(tmp_path):
    ports = {"simulation_port": free_udp_port(), "ROS_port": free_udp_port()}
    with SimPeer("judge") as peer, launch("rosflight_sim", "multirotor_standalone.launch.xml", use_sim_time="false",
                                          memory_folder=tmp_path, **ports) as world:
        world.until("ready: ")
        with launch("rosflight_sim", "multirotor_init_firmware.launch.py") as init:
            assert init.end() == 0, init.text()
        status = peer.listen(Status, "status")
        peer.wait(lambda: status and status[-1].error_code == 0, "no error")
        assert peer.call(Trigger, "toggle_arm").success
        peer.wait(lambda: status[-1].armed, "being armed")
        told = len(world.lines)
        status.clear()
        with busy():
            time.sleep(SECONDS)
        judge(world.lines[told:], status)

        told, begin = len(world.lines), time.monotonic()
        for seconds in STOPS_S:
            stand_still(pid_of(world, "rosflight_common/compose"), seconds)
            time.sleep(BETWEEN_S)

        def stalls():
            return [int(found[1]) for line in world.lines[told:] if (found := STALLS.search(line))]
        peer.poll(lambda: sum(stalls()) > 1e3 * sum(seconds - LEAD_S for seconds in STOPS_S), "all stalls to be reported")
        assert len(stalls()) < time.monotonic() - begin + 2.0, "one line a second, and one of what was before"
        count = len(status)
        peer.wait(lambda: len(status) > count + 10, "status afterwards")
        judge(world.lines[told:], status)
