# SPDX-License-Identifier: BSD-3-Clause
"""./rosflight ros call, against a node of the simulator."""

import subprocess
import sys

import pytest
from ros_rig import ROOT
from sim_rig import node


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


@pytest.mark.parametrize("words, part", [
    (["take_stp"], "found no service /take_stp, allowed: /time_manager/take_step, /time_manager/toggle_pause"),
    (["time_manager/take_step", "x:=1"], "found 'x:=1', allowed FIELD:=VALUE with no field"),
    (["time_manager/get_parameters", "names:=3"], "names: found '3', allowed sequence<string>"),
    (["time_manager/get_parameters", "names"], "found 'names', allowed FIELD:=VALUE with names (sequence<string>)"),
])
def test_nonsense_is_one_line_and_exit_code_2(clock, words, part):
    said = call(*words)
    ours = [line for line in said.stderr.splitlines() if "[rcl]" not in line]  # it warns of the environment
    assert said.returncode == 2 and said.stdout == "" and ours == [f"rosflight: {part}"]
