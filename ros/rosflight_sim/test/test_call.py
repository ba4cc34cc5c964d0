# SPDX-License-Identifier: BSD-3-Clause
"""./rosflight ros call, against a node of the simulator and a service of rclpy."""

import subprocess
import sys

import pytest
from ros_rig import ROOT
from rosflight_msgs.srv import ParamSet
from sim_rig import SimPeer, node


def call(*words):
    return subprocess.run([sys.executable, ROOT / "ros_standin/ros_call.py", *words], capture_output=True, text=True)


@pytest.fixture(scope="module")
def clock():
    with node("standalone_time_manager", start_paused="true", single_step_us=2500.0) as process:
        yield process


def test_the_answer_is_printed_and_decides_the_exit_code(clock):
    assert call("time_manager/take_step").stdout.splitlines() == ["success: True", "message: time is 2500000 ns"]
    assert call("/time_manager/toggle_pause").returncode == 0
    refused = call("time_manager/take_step")
    assert refused.returncode == 1 and "success: False" in refused.stdout
    names = call("time_manager/get_parameters", "names:=[single_step_us]")
    assert "double_value=2500.0" in names.stdout and names.returncode == 0


def test_fields_arrive_whatever_ros_makes_of_such_words_and_a_refusal_is_exit_code_1():
    """`name:=X` is a remapping in the older syntax of ROS arguments."""
    given = []

    def answer(request, response):
        given.append((request.name, request.value))
        response.exists = request.value <= 1.0
        return response
    with SimPeer() as peer:
        peer.node.create_service(ParamSet, "param_set", answer)
        taken = call("param_set", "name:=PID_ROLL_RATE_P", "value:=0.08")
        assert (taken.returncode, taken.stdout) == (0, "exists: True\n")
        refused = call("param_set", "name:=PID_ROLL_RATE_P", "value:=2")
        assert (refused.returncode, refused.stdout) == (1, "exists: False\n")
        peer.node.create_service(ParamSet, "copter/param_set", answer)
        assert call("param_set", "name:=A", "value:=1", "--ros-args", "-r", "__ns:=/copter").returncode == 0
    assert given == [("PID_ROLL_RATE_P", 0.08), ("PID_ROLL_RATE_P", 2.0), ("A", 1.0)]


@pytest.mark.parametrize("words, part", [
    (["take_stp"], "found no service /take_stp, allowed: /time_manager/take_step, /time_manager/toggle_pause"),
    (["time_manager/take_step", "x:=1"], "found 'x:=1', allowed FIELD:=VALUE with no field"),
    (["time_manager/get_parameters", "names:=3"], "names: found '3', allowed sequence<string>"),
    (["time_manager/get_parameters", "names"], "found 'names', allowed FIELD:=VALUE with names (sequence<string>)"),
])
def test_nonsense_is_one_line_and_exit_code_2(clock, words, part):
    said = call(*words)
    ours = [line for line in said.stderr.splitlines() if line.startswith("rosflight: ")]  # libraries warn there
    assert said.returncode == 2 and said.stdout == "" and ours == [f"rosflight: {part}"]
