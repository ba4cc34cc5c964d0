# SPDX-License-Identifier: BSD-3-Clause
"""Runs the pytest files under ros/ inside the ROS environment and counts their cases."""

import os
import re
import subprocess
from pathlib import Path

import cpp_tests
import project
import ros_build
import ros_environment
from cpp_tests import Outcome
from project import ROOT

REPORT = ROOT / "build" / "test_results" / "ros.xml"
FOLDER = "ros"


def files() -> list[Path]:
    """All pytest files that need the ROS environment, from the root."""
    return [path for path in project.own_files()
            if path.parts[0] == FOLDER and re.fullmatch(r"test_\w+\.py", path.name)]


def domain() -> str:
    """Runs at the same time on one machine must not hear each other: one domain per process id."""
    return os.environ.get("ROS_DOMAIN_ID") or str(1 + os.getpid() % 100)


def run(names: list[str] = ()) -> Outcome:
    """Builds, then runs the files with one of `names` in their path; no names means all."""
    environment = ros_environment.find()
    chosen = [path for path in files() if not names or any(name in str(path) for name in names)]
    if not chosen:
        raise ros_build.BadRequest(f"no test file under ros/ matches {', '.join(names)}; files: "
                                   f"{', '.join(map(str, files()))}")
    if not project.build("release", *ros_build.PROGRAMS):
        return Outcome(failed=1, complaints=["the programs do not build, all output is in build/release/build.log"])
    if not ros_build.build(environment):
        return Outcome(failed=1, complaints=["ros/ does not build, all output is in build/ros"])
    REPORT.parent.mkdir(parents=True, exist_ok=True)
    REPORT.unlink(missing_ok=True)
    variables = environment.for_process(**environment.loopback(), ROS_DOMAIN_ID=domain(),
                                        ROS_LOG_DIR=str(ROOT / "build/ros/node_logs"))
    done = subprocess.run(
        [str(environment.python), "-m", "pytest", "-q", "--tb=short", "--no-header",
         "-o", "pythonpath=tools ros/test_support", f"--junitxml={REPORT}", *map(str, chosen)],
        cwd=ROOT, env=variables, capture_output=True, text=True, stdin=subprocess.DEVNULL)
    return cpp_tests.count_pytest(REPORT, done)
