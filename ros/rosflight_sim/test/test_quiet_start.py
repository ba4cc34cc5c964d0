# SPDX-License-Identifier: BSD-3-Clause
"""A healthy start says little: all lines of a launch and its nodes, from the first to five seconds after `ready:`, also with a blank
memory of the firmware.

Not counted: lines of rcl about the environment, and those with which a machine that has too much to do says so; where it does,
sensors that came late are not counted either."""

import os
import time

from ros_rig import free_udp_port
from rosflight_msgs.msg import SimState
from sim_rig import SimPeer, last_s, launch

MAX_LINES = 10
AFTER_S = 5.0
SLOW = ("this machine cannot hold", "time goes on without it", "board time stood still", "The autopilot's clock jumped", "steps skipped in")
LATE = (" is silent", " is back")


def said(world):
    lines = list(world.lines)
    slow = any(part in line for line in lines for part in SLOW)
    return [line for line in lines if not any(part in line for part in ("[rcl]: ", *SLOW, *(LATE if slow else ())))]


class Start:
    """A launch, in a domain of its own where another one runs beside it."""

    def __init__(self, package, file, memory, apart=False, **arguments):
        ports = {"simulation_port": free_udp_port(), "ROS_port": free_udp_port()}
        environment = {"ROS_DOMAIN_ID": str(int(os.environ["ROS_DOMAIN_ID"]) + 101)} if apart else {}
        self.world = launch(package, file, environment=environment, viz="false", memory_folder=memory, **ports, **arguments)

    def is_up(self):
        self.world.until("ready: ")
        self.world.until("parameters received")

    def judge(self, blank):
        lines = said(self.world)
        assert len(lines) <= MAX_LINES, "\n".join(lines)
        assert not any("[ERROR]" in line or "[FATAL]" in line for line in lines), "\n".join(lines)
        if blank:
            assert len([line for line in lines if "[WARN]" in line and "[rosflight_io]" in line]) == 1, "\n".join(lines)
            told, = [line for line in lines if "Not ready to be armed: " in line]
            assert "invalid mixer" in told and "IMU uncalibrated" in told

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.world.stop()


def test_the_simulators_start_in_ten_lines_and_one_says_why_the_vehicle_cannot_be_armed(tmp_path):
    for memory in ("blank", "of the first start"):
        with Start("rosflight_sim", "multirotor_standalone.launch.xml", tmp_path) as one, \
                Start("rosflight_sim", "fixedwing_standalone.launch.xml", tmp_path, apart=True) as two:
            for start in (one, two):
                start.is_up()
            time.sleep(AFTER_S)
            for start in (one, two):
                start.judge(memory == "blank")


def test_processes_and_a_flight_in_simulated_time_start_in_ten_lines(tmp_path):
    with Start("rosflight_sim", "multirotor_standalone.launch.xml", tmp_path / "one", apart=True, composed="false") as processes:
        flies(tmp_path / "two", "roscopter")
        processes.is_up()
        time.sleep(AFTER_S)
        processes.judge(True)


def test_the_fixed_wing_flies_off_in_ten_lines(tmp_path):
    flies(tmp_path, "rosplane")


def flies(memory, package):
    with SimPeer("watcher") as watcher, Start(package, "fly.launch.xml", memory, use_sim_time="true", real_time_multiplier="2.0") as start:
        start.is_up()
        truth = watcher.listen(SimState, "sim/truth_state")
        watcher.wait(lambda: truth, "the truth")
        begin = last_s(truth)
        watcher.wait_simulated(lambda: last_s(truth) > begin + AFTER_S, "five seconds", lambda: last_s(truth))
        start.judge(False)
