# SPDX-License-Identifier: BSD-3-Clause
"""A launch file that sets the firmware up: `ready:` comes when the vehicle can be armed. `--fly` is flown in test_launch.py."""

import contextlib
import importlib.util
import threading

import pytest
import rclpy
import rclpy.task
from ros_rig import ROOT, free_udp_port
from rosflight_msgs.msg import Status
from rosflight_msgs.srv import ParamFile
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


@contextlib.contextmanager
def flight_controller(peer, answers_after_s):
    """A flight controller and its I/O node that calibrate as slowly as that, in its time: a second in 10 ms of the wall."""
    status, ended, now = peer.publisher(Status, "status"), threading.Event(), [0]

    def run():
        while not ended.wait(0.01):
            now[0] += 1
            message = Status()
            message.header.stamp.sec = now[0]
            status.publish(message)

    def good(_, answer):
        answer.success = True
        return answer

    def calibrate(_, answer):
        start = now[0]
        while now[0] < start + answers_after_s and not ended.wait(0.01):
            pass
        return good(_, answer)
    services = [peer.node.create_service(Trigger, name, good) for name in ("all_params_received", "param_write")]
    services += [peer.node.create_service(ParamFile, "param_load_from_file", good), peer.node.create_service(Trigger, "calibrate_imu", calibrate)]
    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield now
    finally:
        ended.set()
        thread.join()


@pytest.mark.parametrize("answers_after_s, code, text", [(50, 0, "all stored"), (10_000, 1, "calibrate_imu: no answer in 60 s")])
def test_times_to_wait_are_those_of_the_flight_controller(tmp_path, answers_after_s, code, text):
    with SimPeer("board") as peer, flight_controller(peer, answers_after_s) as now, \
            Process(executable("rosflight_sim", "init_firmware"), tmp_path / "any.yaml") as process:
        start = now[0]
        assert process.end() == code, process.text()
        assert text in process.text()
        assert now[0] - start < 60 * 100  # not a minute of the wall


class Silent:
    """A client of a service whose first answers are lost."""

    srv_type = Trigger

    def __init__(self, lost):
        self.lost, self.asked = lost, 0

    def wait_for_service(self, timeout_sec):
        return True

    def call_async(self, request):
        self.asked += 1
        answer = rclpy.task.Future()
        if self.asked > self.lost:
            answer.set_result(Trigger.Response(success=self.asked > self.lost + 1))
        return answer


def test_a_first_question_without_an_answer_is_asked_again(monkeypatch):
    spec = importlib.util.spec_from_file_location("init_firmware", ROOT / "ros/rosflight_sim/scripts/init_firmware.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    monkeypatch.setattr(module, "FIRST_ANSWER_S", 0.1)
    with SimPeer("board") as peer, flight_controller(peer, 0):
        node = rclpy.create_node("setter")
        vehicle = module.Vehicle(node)
        silent = vehicle.clients["all_params_received"] = Silent(lost=2)
        vehicle.initialise("any.yaml")
        assert silent.asked == 4
        node.destroy_node()


@pytest.mark.parametrize("words", [["--vehicle"], ["a.yaml", "--wait", "--fly"], ["a.yaml", "b.yaml"]])
def test_wrong_words_are_one_line(words):
    with Process(executable("rosflight_sim", "init_firmware"), *words) as process:
        assert process.end() == 2
        assert len(process.lines) == 1 and "allowed one, or --vehicle and one; then --wait or --fly" in process.lines[0]
