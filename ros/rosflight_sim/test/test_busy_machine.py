# SPDX-License-Identifier: BSD-3-Clause
"""An armed vehicle in wall time on a machine that has too much to do: the board's time waits for the world, says so, and reports no fault that is none."""

import contextlib
import os
import re
import signal
import time

import pytest
from busy import busy
from ros_rig import free_udp_port
from rosflight_msgs.msg import Status
from sim_rig import SimPeer, launch, pid_of
from std_srvs.srv import Trigger

SECONDS = 10.0
STOPS_S, BETWEEN_S = (*[0.2] * 8, 1.5), 0.1
LEAD_S = 0.06  # time that the board has beyond the last sample or frame
STALLS = re.compile(r"board time stood still \d+ times, for (\d+) ms together")
FALSE_ALARMS = ("not responding", "RC lost", "failsafe", "Failsafe", "time going backwards", "unhealthy", "Autopilot error")


def stand_still(pid, seconds):
    os.kill(pid, signal.SIGSTOP)
    time.sleep(seconds)
    os.kill(pid, signal.SIGCONT)


def judge(lines, status):
    alarms = [line for line in lines if any(part in line for part in FALSE_ALARMS)]
    assert not alarms, "\n".join(lines)
    assert all(message.armed and not message.failsafe and message.error_code == 0 for message in status)


@contextlib.contextmanager
def armed_vehicle(folder, composed):
    """The simulator in wall time with an armed vehicle on its ground, an observer, and the states that it receives."""
    ports = {"simulation_port": free_udp_port(), "ROS_port": free_udp_port()}
    with SimPeer("judge") as peer, launch("rosflight_sim", "multirotor_standalone.launch.xml", use_sim_time="false",
                                          composed=composed, memory_folder=folder, **ports) as world:
        world.until("ready: ")
        with launch("rosflight_sim", "multirotor_init_firmware.launch.py") as init:
            assert init.end() == 0, init.text()
        status = peer.listen(Status, "status")
        peer.wait(lambda: status and status[-1].error_code == 0, "no error")
        assert peer.call(Trigger, "toggle_arm").success
        peer.wait(lambda: status[-1].armed, "being armed")
        status.clear()
        yield world, peer, status


@pytest.mark.parametrize("composed", ["true", "false"])
def test_a_busy_machine_makes_no_false_alarm(tmp_path, composed):
    with armed_vehicle(tmp_path, composed) as (world, _, status):
        told = len(world.lines)
        with busy():
            time.sleep(SECONDS)
        judge(world.lines[told:], status)


def test_a_world_that_is_stopped_makes_no_false_alarm_and_says_how_long_it_stood(tmp_path):
    """In one process: a board that is stopped alone has missed what went on without it."""
    with armed_vehicle(tmp_path, "true") as (world, peer, status):
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
