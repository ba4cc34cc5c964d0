# SPDX-License-Identifier: BSD-3-Clause
"""What a launch file starts, whether each node has a process of its own or several share one."""

from dataclasses import dataclass


@dataclass
class Planned:
    """One node: what reaches it."""

    parameters: dict[str, object]
    remappings: set[tuple[str, str]]


def nodes_of(plan) -> dict[str, Planned]:
    """Nodes by name; those of a `compose` one by one. Its names may come as one argument, which `compose` splits."""
    found: dict[str, Planned] = {}
    for process in plan.nodes:
        parameters = {name: value for source in process.parameters if isinstance(source, dict) for name, value in source.items()}
        if process.what != "rosflight_common/compose":
            found[process.name] = Planned(parameters, set(process.remappings))
            continue
        for component in " ".join(process.command[1:]).split():
            name = component.partition(":")[2]
            assert name and name not in found, component
            found[name] = Planned(parameters, {(topic.removeprefix(f"{name}:"), to) for topic, to in process.remappings
                                               if topic.startswith(f"{name}:") or ":" not in topic})
    return found
