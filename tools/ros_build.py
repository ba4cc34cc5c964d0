# SPDX-License-Identifier: BSD-3-Clause
"""Builds the packages under ros/ with colcon into build/ros, or reports that nothing changed. With --rclcpp first that, from source."""

import contextlib
import fcntl
import hashlib
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import project
from project import ROOT
from ros_environment import Environment

SOURCES, STAND_INS = "ros", "ros_standin"
# The stand-ins hold a file COLCON_IGNORE, so that a plain colcon build on a ROS installation never
# sees them. Without an installation colcon has to look for them.
SEE_STAND_INS = {"COLCON_EXTENSION_BLOCKLIST": "colcon_core.package_identification.ignore"}
SETTINGS = ("CMakeLists.txt", "CMakePresets.json", "tools/ros_build.py", "tools/ros_environment.py")
WHEEL_LINKING = "-Wl,--as-needed -Wl,--allow-shlib-undefined"
SANITIZE = "-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer"


QUICK = ROOT / "cmake" / "quick_ros.cmake"
LIBRARIES = ROOT / "build" / "release"  # where find_package(rosflight) finds the project
# What tests and demonstrations start beside the nodes, in build/release/apps.
PROGRAMS = ("rosflight", "rosflight_tools", "sil_echo", "sil_link_rtt", "sil_cable")


class BadRequest(ValueError):
    """The request names something that does not exist."""


def _packages() -> dict[str, str]:
    """Names of all packages, stand-ins included, and the names of their folders."""
    return {name_in(ROOT / path): path.parent.name for path in _manifests()}


def _manifests() -> list[Path]:
    """Manifests of the packages that colcon finds: it looks for none below another."""
    found = [path for path in project.own_files() if path.name == "package.xml"
             and path.parts[0] in (SOURCES, STAND_INS)]
    folders = {path.parent for path in found}
    return sorted(path for path in found if not folders & set(path.parent.parents))


def package_names() -> list[str]:
    return sorted(_packages())


def name_in(manifest: Path) -> str:
    """The package's name as its package.xml has it; the folder may have another."""
    return re.search(r"<name>\s*([\w-]+)\s*</name>", manifest.read_text())[1]


def build(environment: Environment, packages: list[str] = (), place: Path | None = None,
          sanitize: bool = False) -> bool:
    """Builds all packages, or those named and what they need; one build in a place at a time. False: failed, and why was said."""
    place = place or environment.place
    packages = sorted({_known(name) for name in packages})
    with _alone_in(place):
        return _build(environment, packages, place, sanitize)


@contextlib.contextmanager
def _alone_in(place: Path):
    """Waits for the build of another process in the same place. Its lock ends with it, however it ends."""
    place.mkdir(parents=True, exist_ok=True)
    with (place / ".lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            print(f"rosflight: waiting for another build in {place.name}", file=sys.stderr)
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def _build(environment: Environment, packages: list[str], place: Path, sanitize: bool) -> bool:
    every, stamp = place / "stamp_", place / ("stamp_" + "_".join(packages))
    state = _state(environment, sanitize)
    if any(made.exists() and made.read_text() == state for made in (every, stamp)):
        return True
    (place / "COLCON_IGNORE").touch()
    stamp.unlink(missing_ok=True)
    if _need_libraries(packages) and not project.build("release", "rosflight_libraries"):
        return False
    _remove_moved(place / "build")
    if environment.rclcpp and not _build_underlay(environment):
        return False
    folders = [SOURCES]
    if environment.rclcpp:
        folders += [f"{STAND_INS}/tf2_msgs"]
    elif environment.installed is None:
        folders += [STAND_INS]
    print(f"rosflight: building ros/ against {environment.rclcpp or environment.installed or 'the wheels in .venv-ros'}",
          file=sys.stderr)
    if not _colcon(environment, [str(ROOT / folder) for folder in folders], packages, place, _flags(sanitize)):
        return False
    stamp.write_text(state)  # of before: a change while it was built counts as new
    return True


def _remove_moved(builds: Path):
    """Build folders of packages that stood elsewhere when they were configured: CMake refuses those."""
    for cache in builds.glob("*/CMakeCache.txt"):
        source = re.search(r"^CMAKE_HOME_DIRECTORY:INTERNAL=(.*)$", cache.read_text(errors="replace"), re.M)
        if source is None or not (Path(source[1]) / "CMakeLists.txt").exists():
            shutil.rmtree(cache.parent)


def _known(name: str) -> str:
    """The package of this name, or in the folder of this name."""
    folders = _packages()
    if name in folders:
        return name
    for package, folder in folders.items():
        if name == folder:
            return package
    raise BadRequest(f"no package '{name}' under ros/; allowed: {', '.join(sorted(folders))}")


def _need_libraries(packages: list[str]) -> bool:
    """True if one of the packages (none: all) is built with find_package(rosflight), itself or by what it needs."""
    texts = {name_in(ROOT / path): (ROOT / path).read_text() for path in _manifests()}
    left, seen = list(packages or texts), set()
    while left:
        name = left.pop()
        if name == "rosflight":
            return True
        if name in texts and name not in seen:
            seen.add(name)
            left += re.findall(r"depend>([\w-]+)</", texts[name])
    return False


def _state(environment: Environment, sanitize: bool) -> str:
    """Changes when anything does that the packages are built from."""
    digest = hashlib.sha256(f"{environment} {sanitize}".encode())
    fixed = ROOT / ".venv-ros" / ".fixed"
    if environment.installed is None and fixed.exists():
        digest.update(fixed.read_bytes())
    folders_of_libraries = _library_folders()
    for path in project.own_files():
        name = str(path)
        if name.startswith(("ros/", "ros_standin/", "cmake/", *folders_of_libraries)) or name in SETTINGS:
            found = (ROOT / path).stat()
            digest.update(f"{name} {found.st_mtime_ns} {found.st_size}\n".encode())
    return digest.hexdigest()


def _library_folders() -> list[str]:
    """Folders of the project's libraries: whatever the root builds that ros/ may use."""
    return [f"{folder}/" for folder in ("link", "firmware", "sim", "companion", "config", "ground",
                                        "autonomy", "messages", "log", "flight/vehicle")]


def _build_underlay(environment: Environment) -> bool:
    """The packages in the folder of --rclcpp, without their tests; again when a file of them changes."""
    place = environment.underlay
    stamp = place / "stamp"
    state = "".join(sorted(f"{path} {path.stat().st_mtime_ns}\n"
                           for path in environment.rclcpp.rglob("*") if path.is_file()))
    if stamp.exists() and stamp.read_text() == state:
        return True
    place.mkdir(parents=True, exist_ok=True)
    flags = {"CMAKE_BUILD_TYPE": "Release", "BUILD_TESTING": "OFF",
             "CMAKE_C_COMPILER_LAUNCHER": "ccache", "CMAKE_CXX_COMPILER_LAUNCHER": "ccache"}
    print(f"rosflight: building {environment.rclcpp}", file=sys.stderr)
    if not _colcon(environment, [str(environment.rclcpp)], [], place, flags):
        return False
    stamp.write_text(state)
    return True


def _flags(sanitize: bool) -> dict[str, str]:
    """What CMake is given for our packages."""
    flags = {
        "rosflight_DIR": str(LIBRARIES),
        "CMAKE_BUILD_TYPE": "Debug" if sanitize else "Release",
        "CMAKE_C_COMPILER_LAUNCHER": "ccache",
        "CMAKE_CXX_COMPILER_LAUNCHER": "ccache",
        "CMAKE_EXPORT_COMPILE_COMMANDS": "ON",
        "BUILD_TESTING": "ON",
        "CMAKE_PROJECT_INCLUDE": str(QUICK),
    }
    if sanitize:
        flags |= {"CMAKE_C_FLAGS": SANITIZE, "CMAKE_CXX_FLAGS": SANITIZE,
                  "CMAKE_C_FLAGS_DEBUG": "-O1 -g1", "CMAKE_CXX_FLAGS_DEBUG": "-O1 -g1"}
    return flags


def _colcon(environment: Environment, folders: list[str], packages: list[str], place: Path, flags: dict[str, str]) -> bool:
    """Builds what is in `folders` into `place`: all, or `packages` and what they need."""
    if environment.installed is None:
        flags = flags | {f"CMAKE_{kind}_LINKER_FLAGS": WHEEL_LINKING for kind in ("EXE", "SHARED", "MODULE")}
        flags["Python3_EXECUTABLE"] = str(environment.python)
    command = [
        *environment.colcon, "--log-base", str(place / "log"), "build",
        "--base-paths", *folders, "--build-base", str(place / "build"),
        "--install-base", str(place / "install"), "--merge-install",
        "--executor", "sequential", "--event-handlers", "console_direct+", "console_cohesion-",
        "desktop_notification-", "--cmake-args", "-G", "Ninja", "-Wno-dev", "--no-warn-unused-cli",
        *(f"-D{name}={value}" for name, value in flags.items()),
    ]
    if packages:
        command[command.index("--cmake-args"):command.index("--cmake-args")] = [
            "--packages-up-to", *packages]
    variables = environment.for_process(place)
    variables["CMAKE_BUILD_PARALLEL_LEVEL"] = str(project.jobs())
    variables["MAKEFLAGS"] = f"-j{project.jobs()}"
    if environment.installed is None:
        variables |= SEE_STAND_INS
    start = time.monotonic()
    log = place / "build.log"
    with log.open("w") as output:
        code = _tell_progress(command, variables, output)
    if code == 0:
        print(f"rosflight: built in {time.monotonic() - start:.0f} s", file=sys.stderr)
        return True
    _show_failure(log)
    print(f"rosflight: the build failed; all of it is in {log.relative_to(ROOT)} and "
          f"{(place / 'log').relative_to(ROOT)}/latest_build", file=sys.stderr)
    return False


def _tell_progress(command: list[str], variables: dict[str, str], output) -> int:
    """Runs colcon; what it finished goes to stderr with quarters of each package on the way, all it says to the log."""
    package, shown = "", 0
    with subprocess.Popen(command, cwd=ROOT, env=variables, stdin=subprocess.DEVNULL, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as colcon:
        for line in colcon.stdout:
            output.write(line)
            if started := re.match(r"Starting >>> (\S+)", line):
                package, shown = started[1], 0
            elif step := re.match(r"\[(\d+)/(\d+)\]", line):
                percent = 100 * int(step[1]) // int(step[2])
                if percent < 100 and percent // 25 > shown // 25:
                    print(f"rosflight: building {package} {percent} %", file=sys.stderr)
                    shown = percent
            if line.startswith(("Finished", "Failed")):
                print(f"rosflight: {line.strip()}", file=sys.stderr)
    return colcon.returncode


def _show_failure(log: Path):
    lines = log.read_text(errors="replace").splitlines()
    wanted = [number for number, line in enumerate(lines)
              if re.search(r"error:|CMake Error|undefined reference|FAILED:|No such file", line)]
    shown: list[str] = []
    for number in wanted:
        shown += [line for line in lines[number:number + 4] if line[:200] not in shown
                  and "ccache" not in line]
    for line in (shown or lines[-20:])[:40]:
        print(line[:200], file=sys.stderr)
