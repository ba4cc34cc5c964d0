# SPDX-License-Identifier: BSD-3-Clause
"""What a launch will start: the result of reading its files."""

from dataclasses import dataclass, field
from pathlib import Path

ParameterSource = Path | dict[str, object] | str  # a YAML file, values by name, or NAME:=VALUE for -p


@dataclass
class Node:
    """One process."""

    name: str  # as its output lines are marked; unique in the plan
    command: list[str]  # executable and its own arguments
    where: str  # FILE:LINE
    what: str  # package/executable
    full_name: str | None = None  # in the ROS graph; None: not a ROS node, or one that names itself
    node_name: str | None = None
    namespace: str = ""
    ros_arguments: list[str] = field(default_factory=list)
    parameters: list[ParameterSource] = field(default_factory=list)
    remappings: list[tuple[str, str]] = field(default_factory=list)
    environment: dict[str, str] = field(default_factory=dict)
    is_ros: bool = True


@dataclass
class Argument:
    """One `arg` of a file."""

    name: str
    default: str | None
    description: str
    choices: list[str]
    where: str


@dataclass
class Plan:
    nodes: list[Node] = field(default_factory=list)
    arguments: dict[str, Argument] = field(default_factory=dict)
    messages: list[str] = field(default_factory=list)  # of `log` elements
