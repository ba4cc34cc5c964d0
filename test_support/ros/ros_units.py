# SPDX-License-Identifier: BSD-3-Clause
"""The program `units` of a package: its C++ tests, which are not installed."""

import subprocess

from ros_rig import PREFIXES


def _program(package):
    return PREFIXES[0].parent / "build" / package / "units"


def names(package):
    """Names of all cases; one that fails if there is no program."""
    if not _program(package).exists():
        return ["(not built)"]
    listed = subprocess.run([_program(package), "--gtest_list_tests"], capture_output=True, text=True, check=True)
    suite, found = "", []
    for line in listed.stdout.splitlines():
        if line.endswith("."):
            suite = line
        elif line.startswith("  "):
            found.append(suite + line.split()[0])
    return found


def run(package, name):
    done = subprocess.run([_program(package), f"--gtest_filter={name}"], capture_output=True, text=True)
    assert done.returncode == 0 and "1 test from" in done.stdout, done.stdout + done.stderr
