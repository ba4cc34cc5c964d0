# SPDX-License-Identifier: BSD-3-Clause
"""The GoogleTest programs of rclcpp_lite, each case by itself: ROS starts and ends once a process."""

import re

import pytest
from ros_peer import lite_program, run

PROGRAMS = ["api_test", "executor_test", "intra_process_test", "timer_test", "values_test"]


def cases():
    for program in PROGRAMS:
        suite = ""
        for line in run(lite_program(program, "--gtest_list_tests")).stdout.splitlines():
            if re.match(r"\w+\.$", line):
                suite = line
            elif line.startswith("  "):
                yield program, suite + line.strip()


@pytest.mark.parametrize("program, case", cases())
def test_case(program, case):
    done = run(lite_program(program, f"--gtest_filter={case}"))
    assert done.returncode == 0 and "1 test from 1 test suite ran" in done.stdout, done.stdout
