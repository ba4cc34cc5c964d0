# SPDX-License-Identifier: BSD-3-Clause
"""Runs the pytest files under ros/ inside the ROS environment and counts their cases."""

import fcntl
import functools
import os
import re
import tempfile
from pathlib import Path

import cpp_tests
import project
import pytest_files
import ros_build
import ros_environment
from cpp_tests import Outcome
from project import ROOT

REPORTS = ROOT / "build" / "test_results"
STAND_INS = "ros_standin"
LITE = "rclcpp"  # the package in ros_standin/rclcpp_lite
FOLDERS = ("ros/", f"{STAND_INS}/rclcpp_lite/")
# Packages whose tests start nothing of other packages and no program of the project.
ALONE = {LITE, "rosflight_msgs", "rosplane_msgs"}


def needs_ros(path: Path) -> bool:
    return str(path).startswith(FOLDERS)


def files() -> list[Path]:
    """All pytest files that need the ROS environment, from the root."""
    return [path for path in project.own_files()
            if needs_ros(path) and re.fullmatch(r"test_\w+\.py", path.name)]


def domain(lane: int = 0) -> str:
    """What runs at the same time on one machine must not receive each other's messages: each lane of each run has its own domain."""
    return os.environ.get("ROS_DOMAIN_ID") or str(_first_domain() + lane)


_held = []  # locked files, open as long as this process runs


@functools.cache
def _first_domain() -> int:
    """As many neighbouring domains as there are lanes, from 1 to 99, that no other run has: a locked file says so until this process
    ends, however it ends."""
    lanes = pytest_files.ROS_LANES
    groups = 99 // lanes
    for k in range(groups):
        first = 1 + (os.getpid() + k) % groups * lanes
        try:
            lock = open(Path(tempfile.gettempdir()) / f"rosflight_ros_domain_{first}.lock", "w")
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:  # taken, also by another user, whose file this is
            continue
        _held.append(lock)
        return first
    raise ros_build.BadRequest(f"all {groups} groups of ROS domains are taken by other test runs: end one, or set ROS_DOMAIN_ID")


def owner(path: Path) -> str | None:
    """Name of the package that a file under ros/ belongs to; None: it is about all of them."""
    manifests = (ROOT / parent / "package.xml" for parent in path.parents)
    manifest = next((found for found in manifests if found.exists()), None)
    return ros_build.name_in(manifest) if manifest else None


def packages_of(paths: list[Path]) -> list[str]:
    """The packages these files need built; empty means all."""
    owners = {owner(path) for path in paths}
    return sorted(owners) if owners <= ALONE else []


def run(names: list[str] = (), rclcpp: Path | None = None) -> Outcome:
    """Builds, then runs the files with one of `names` in their path; no names means all."""
    environment = ros_environment.find(rclcpp)
    chosen = [path for path in files() if not names or any(name in str(path) for name in names)]
    if not chosen:
        raise ros_build.BadRequest(f"no test file under ros/ matches {', '.join(names)}; files: "
                                   f"{', '.join(map(str, files()))}")
    if environment.installed or rclcpp:  # which is the real thing, and no stand-in is built
        chosen = [path for path in chosen if path.parts[0] != STAND_INS]
    packages = packages_of(chosen) if names else []
    if not packages and not project.build("release", *ros_build.PROGRAMS):
        return Outcome(failed=1, complaints=["the programs do not build, all output is in build/release/build.log"])
    if not ros_build.build(environment, packages):
        return Outcome(failed=1, complaints=[f"ros/ does not build, all output is in build/{environment.place.name}"])
    return _pytest(environment, chosen, environment.place)


def sanitizers() -> Outcome:
    """The tests of rclcpp_lite again, its code and that of its peers under address and
    undefined-behaviour sanitizers. rcl and the middleware below are the wheels', as they are."""
    environment = ros_environment.find()
    if environment.installed:
        return Outcome()
    chosen = [path for path in files() if owner(path) == LITE]
    place = ROOT / "build" / "ros_sanitizers"
    if not ros_build.build(environment, [LITE], place, sanitize=True):
        return Outcome(failed=1, complaints=[f"{LITE} does not build with sanitizers"])
    return _pytest(environment, chosen, place)


def _pytest(environment: ros_environment.Environment, chosen: list[Path], place: Path) -> Outcome:
    def variables(lane: int) -> dict[str, str]:
        return environment.for_process(
            place, **environment.loopback(), **cpp_tests.SANITIZER_OPTIONS, ROS_DOMAIN_ID=domain(lane),
            ROS_LOG_DIR=str(place / "node_logs"))
    lanes = 1 if "ROS_DOMAIN_ID" in os.environ else pytest_files.ROS_LANES
    return pytest_files.run(chosen, str(environment.python), REPORTS / place.name,
                            ["-o", "pythonpath=tools ros_standin test_support/ros"], lanes, variables)
