# SPDX-License-Identifier: BSD-3-Clause
"""A healthy start says little: all lines of a launch and its nodes, from the first to five seconds after `ready:`, also with a blank
memory of the firmware.

Not counted: lines of rcl about the environment, and those with which a machine that has too much to do says so; where it does,
sensors that came late are not counted either."""

import pytest
from ros_rig import free_udp_port
from rosflight_msgs.msg import SimState
from sim_rig import SimPeer, last_s, launch

MOST = 10
SLOW = ("this machine cannot hold", "time goes on without it", "board time stood still", "The autopilot's clock jumped")
LATE = (" is silent", " is back")


def said(world):
    lines = list(world.lines)
    slow = any(part in line for line in lines for part in SLOW)
    return [line for line in lines if not any(part in line for part in ("[rcl]: ", *SLOW, *(LATE if slow else ())))]


def start(package, file, memory, watch, **arguments):
    ports = {"simulation_port": free_udp_port(), "ROS_port": free_udp_port()}
    with launch(package, file, viz="false", memory_folder=memory, **ports, **arguments) as world:
        world.until("ready: ")
        world.until("parameters received")
        truth = watch.listen(SimState, "sim/truth_state")
        watch.wait(lambda: truth, "the truth")
        begin = last_s(truth)
        watch.wait_simulated(lambda: last_s(truth) > begin + 5.0, "five seconds", lambda: last_s(truth))
        return said(world)


@pytest.mark.parametrize("package, file, arguments", [
    ("rosflight_sim", "multirotor_standalone.launch.xml", {}),
    ("rosflight_sim", "fixedwing_standalone.launch.xml", {}),
    ("rosflight_sim", "multirotor_standalone.launch.xml", {"composed": "false"}),
    ("roscopter", "fly.launch.xml", {"use_sim_time": "true"}),
    ("rosplane", "fly.launch.xml", {"use_sim_time": "true"})])
def test_the_first_start_and_the_next_are_ten_lines_without_an_error(tmp_path, package, file, arguments):
    with SimPeer("watcher") as watcher:
        for _ in ("blank memory", "the memory of the first"):
            lines = start(package, file, tmp_path, watcher, **arguments)
            assert len(lines) <= MOST, "\n".join(lines)
            assert not any("[ERROR]" in line or "[FATAL]" in line for line in lines), "\n".join(lines)


def test_a_vehicle_that_cannot_be_armed_says_why_in_one_line(tmp_path):
    with SimPeer("watcher") as watcher:
        lines = start("rosflight_sim", "multirotor_standalone.launch.xml", tmp_path, watcher)
        assert len([line for line in lines if "[WARN]" in line and "[rosflight_io]" in line]) == 1, "\n".join(lines)
        told, = [line for line in lines if "Not ready to be armed: " in line]
        assert "invalid mixer" in told and "IMU uncalibrated" in told
