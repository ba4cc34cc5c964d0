# SPDX-License-Identifier: BSD-3-Clause
"""A launch file that sets the firmware up: `ready:` comes when the vehicle can be armed. `--fly` is flown in test_launch.py."""

import pytest
from ros_rig import ROOT, free_udp_port
from rosflight_msgs.msg import Status
from sim_rig import Process, SimPeer, executable, launch
from std_srvs.srv import Trigger


def world(tmp_path):
    file = tmp_path / "it.launch.xml"
    file.write_text(f"""<launch>
      <include file="$(find-pkg-share rosflight_sim)/launch/multirotor_standalone.launch.xml">
        <arg name="use_sim_time" value="true"/><arg name="viz" value="false"/></include>
      <node pkg="rosflight_sim" exec="init_firmware" name="init_firmware" args="--vehicle {ROOT}/vehicles/multirotor.yaml --wait"/>
    </launch>""")
    return launch(file, memory_folder=tmp_path / "memory", simulation_port=free_udp_port(), ROS_port=free_udp_port(),
                  real_time_multiplier="10.0")


def test_ready_means_that_the_vehicle_can_be_armed(tmp_path):
    with SimPeer("watcher") as watcher, world(tmp_path) as start:
        status = watcher.listen(Status, "status")
        start.until("ready: 9 nodes in ")  # of the launch, 8 of them in one process
        said = start.text()
        assert said.index("[init_firmware] not ready: ") < said.index("all stored") < said.index("\nready: 9 nodes in "), said
        assert watcher.call(Trigger, "toggle_arm").success
        watcher.wait(lambda: status and status[-1].armed, "being armed at the first try")


@pytest.mark.parametrize("words", [["--vehicle"], ["a.yaml", "--wait", "--fly"], ["a.yaml", "b.yaml"]])
def test_wrong_words_are_one_line(words):
    with Process(executable("rosflight_sim", "init_firmware"), *words) as process:
        assert process.end() == 2
        assert len(process.lines) == 1 and "allowed one, or --vehicle and one; then --wait or --fly" in process.lines[0]
