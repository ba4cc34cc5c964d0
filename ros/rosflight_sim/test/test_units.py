# SPDX-License-Identifier: BSD-3-Clause
"""The C++ tests of this package, one case a test."""

import subprocess

import pytest
from ros_rig import PREFIXES

PROGRAM = PREFIXES[0].parent / "build/rosflight_sim/units"


def names():
    if not PROGRAM.exists():
        return ["(not built)"]
    listed = subprocess.run([PROGRAM, "--gtest_list_tests"], capture_output=True, text=True, check=True)
    suite, found = "", []
    for line in listed.stdout.splitlines():
        if line.endswith("."):
            suite = line
        elif line.startswith("  "):
            found.append(suite + line.split()[0])
    return found


@pytest.mark.parametrize("name", names())
def test_unit(name):
    done = subprocess.run([PROGRAM, f"--gtest_filter={name}"], capture_output=True, text=True)
    assert done.returncode == 0 and "1 test from" in done.stdout, done.stdout + done.stderr
