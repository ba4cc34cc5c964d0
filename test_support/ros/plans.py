# SPDX-License-Identifier: BSD-3-Clause
"""What a launch file starts, whether each node has a process of its own or several share one."""

from dataclasses import dataclass

import yaml


@dataclass
class Planned:
    """One node: what reaches it."""

    parameters: dict[str, object]
    remappings: set[tuple[str, str]]


def values_of(source) -> dict[str, object]:
    """Values of `name:=value`; a file has none."""
    if isinstance(source, str):
        name, value = source.split(":=", 1)
        return {name: yaml.safe_load(value)}
    return source if isinstance(source, dict) else {}


def nodes_of(plan) -> dict[str, Planned]:
    """Nodes by name; those of a `compose` one by one. Its names may come as one argument, which `compose` splits."""
    found: dict[str, Planned] = {}
    for process in plan.nodes:
        parameters = {name: value for source in process.parameters for name, value in values_of(source).items()}
        if process.what != "rosflight_common/compose":
            found[process.name] = Planned(parameters, set(process.remappings))
            continue
        for component in " ".join(process.command[1:]).split():
            name = component.partition(":")[2]
            assert name and name not in found, component
            found[name] = Planned(parameters, {(topic.removeprefix(f"{name}:"), to) for topic, to in process.remappings
                                               if topic.startswith(f"{name}:") or ":" not in topic})
    return found
