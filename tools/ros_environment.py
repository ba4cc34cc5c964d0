# SPDX-License-Identifier: BSD-3-Clause
"""The ROS 2 environment the packages under ros/ are built and run in.

A sourced Humble or Jazzy installation is used as it is. Without one the wheels of
ros_standin/requirements.txt in .venv-ros take its place, after the fix-ups of ros_standin/wheels.py; what
they lack comes from ros_standin, or from a folder of sources (--rclcpp).
"""

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from project import ROOT

sys.path.insert(0, str(ROOT / "ros_standin"))
import wheels  # noqa: E402
from wheels import VENV  # noqa: E402

REQUIREMENTS = "ros_standin/requirements.txt"
PLACE = ROOT / "build" / "ros"
DISTRIBUTIONS = ("humble", "jazzy")


@dataclass
class Environment:
    """Where ROS is and what a process needs to find it and our packages."""

    installed: str | None  # name of the sourced distribution; None: the wheels in .venv-ros
    python: Path
    colcon: list[str]
    rclcpp: Path | None = None  # sources of rclcpp and what it needs beside the wheels; None: ros_standin/rclcpp_lite

    @property
    def place(self) -> Path:
        """Where the packages are built."""
        return ROOT / "build" / "ros_rclcpp" if self.rclcpp else PLACE

    @property
    def underlay(self) -> Path:
        """Where the sources of --rclcpp are built."""
        return self.place / "underlay"

    def variables(self, place: Path | None = None) -> dict[str, str]:
        """The variables to set, with the packages built into `place` in front."""
        install = (place or self.place) / "install"
        prefixes = [install, self.underlay / "install"] if self.rclcpp else [install]
        python_paths = [path for prefix in prefixes
                        for path in sorted(str(path) for kind in ("site-packages", "dist-packages") for path in prefix.glob(f"**/lib/python3*/{kind}"))]
        found = {
            "AMENT_PREFIX_PATH": [str(install)],
            "CMAKE_PREFIX_PATH": [str(install)],
            "LD_LIBRARY_PATH": [str(install / "lib")],
            "PYTHONPATH": python_paths,
            "PATH": [str(install / "bin")],
        }
        if self.rclcpp:
            for name in ("AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH"):
                found[name].append(str(self.underlay / "install"))
            found["LD_LIBRARY_PATH"].append(str(self.underlay / "install/lib"))
        if self.installed is None:
            for name in ("AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH"):
                found[name].append(str(VENV))
            found["LD_LIBRARY_PATH"] += [str(VENV / "lib"), *wheels.bundled_libraries()]
            found["PATH"].append(str(VENV / "bin"))
        joined = {name: _in_front(paths, os.environ.get(name, "")) for name, paths in found.items()}
        joined |= {"ROS_VERSION": "2", "ROS_PYTHON_VERSION": "3"}
        if self.installed is None:
            joined |= {"VIRTUAL_ENV": str(VENV), "_ROS_WHEELS_BOOTSTRAP_COMPLETE": "1",
                       "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp"}
        return joined

    def loopback(self) -> dict[str, str]:
        """Keeps ROS traffic on the machine; for tests."""
        if self.installed == "humble":
            return {"ROS_LOCALHOST_ONLY": "1"}
        return {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}

    def for_process(self, place: Path | None = None, **more: str) -> dict[str, str]:
        return {**os.environ, **self.variables(place), **more}


def _in_front(paths: list[str], present: str) -> str:
    """`present` with `paths` before it, none of them twice."""
    return ":".join(dict.fromkeys([*paths, *(path for path in present.split(":") if path)]))


def sourced() -> str | None:
    """Name of the sourced distribution that has rclcpp, if there is one."""
    name = os.environ.get("ROS_DISTRO", "")
    prefixes = os.environ.get("AMENT_PREFIX_PATH", "").split(":")
    ours = PLACE / "install"
    has_rclcpp = any((Path(prefix) / "share/rclcpp/cmake/rclcppConfig.cmake").exists()
                     for prefix in prefixes if prefix and Path(prefix) != ours)
    return name if name in DISTRIBUTIONS and has_rclcpp else None


def find(rclcpp: Path | None = None) -> Environment:
    """The environment of this process, made ready if it is the one of wheels."""
    name = sourced()
    if name and rclcpp is None:
        return Environment(name, Path("/usr/bin/python3"), ["colcon"])
    _ready("packages", "run", "test", "ros")
    _ready("environment", VENV.name, REQUIREMENTS)
    wheels.fix()
    python = VENV / "bin" / "python3"
    return Environment(None, python, [str(python), "-m", "colcon"], rclcpp)


def _ready(*step: str):
    done = subprocess.run(["bash", str(ROOT / "tools/ready.sh"), *step])
    if done.returncode:
        raise SystemExit(done.returncode)  # it has said what is wrong
