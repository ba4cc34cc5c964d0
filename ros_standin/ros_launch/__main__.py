# SPDX-License-Identifier: BSD-3-Clause
"""Usage: ./rosflight ros launch FILE [NAME:=VALUE...]
       ./rosflight ros launch PACKAGE FILE [NAME:=VALUE...]

Starts the nodes of a launch file (XML front end of ROS 2, the subset of ros_standin/ros_launch/README.md),
says `ready: N nodes in T s` when all are up, and ends them all on Ctrl-C or when one dies.

  --show-args    list the arguments of the file and start nothing
  --check        read and check everything, start nothing
"""

import os
import sys
import tempfile
from pathlib import Path

if not __package__:
    sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from ros_launch.errors import LaunchError, one_of  # noqa: E402
from ros_launch.packages import Packages  # noqa: E402
from ros_launch.plan import Plan  # noqa: E402
from ros_launch.reader import Reader, find  # noqa: E402
from ros_launch.runner import Runner  # noqa: E402

OPTIONS = {"--show-args", "-s", "--check", "--help", "-h"}


def environment(packages: Packages) -> dict[str, str]:
    """ROSFLIGHT_GUI says whether our launch files start windows: not without RViz or a display."""
    values = dict(os.environ)
    display = values.get("DISPLAY") or values.get("WAYLAND_DISPLAY")
    values.setdefault("ROSFLIGHT_GUI", "true" if display and packages.has("rviz2") else "false")
    return values


def show(plan: Plan) -> None:
    if not plan.arguments:
        print("no arguments")
    for argument in plan.arguments.values():
        value = "(no default)" if argument.default is None else f"(default {argument.default!r})"
        print(f"{argument.name} {value}")
        if argument.description:
            print(f"    {argument.description}")
        if argument.choices:
            print(f"    {one_of(argument.choices)}")


def launch(words: list[str]) -> int:
    options = {word for word in words if word.startswith("-") and ":=" not in word}
    if unknown := options - OPTIONS:
        raise LaunchError(f"option: found {min(unknown)!r}, allowed {one_of(OPTIONS)}")
    if options & {"--help", "-h"}:
        print(__doc__.strip())
        return 0
    packages = Packages.of_environment()
    file, given = find([word for word in words if word not in options], packages)
    only_show = bool(options & {"--show-args", "-s"})
    plan = Reader(packages, given, environment(packages), lenient=only_show).read(file)
    if only_show:
        show(plan)
        return 0
    for message in plan.messages:
        print(message)
    if not plan.nodes:
        raise LaunchError(f"{file}: found nothing to start, allowed at least one node")
    if "--check" in options:
        print(f"{len(plan.nodes)} nodes: {', '.join(node.name for node in plan.nodes)}")
        return 0
    with tempfile.TemporaryDirectory(prefix="rosflight_launch_") as scratch:
        return Runner(plan, Path(scratch)).run()


def main(words: list[str]) -> int:
    try:
        return launch(words)
    except LaunchError as why:
        print(f"launch: {why}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
