# SPDX-License-Identifier: BSD-3-Clause
"""A table of messages and services (CSV: interface, kind, type, name, value) against the generated types of a package."""

import csv
import importlib
import re
from itertools import groupby
from pathlib import Path

# The generators' names for the basic types, where they differ from those of a .msg file.
GENERATED = {"float32": "float", "float64": "double", "bool": "boolean"}
# Fields every Jazzy service half has none of; anything else in a module is a type of ours.
INTERFACE = re.compile(r"^[A-Z]\w*$")


def as_generated(written: str) -> str:
    element, array = re.fullmatch(r"([\w/]+)(\[\d*\])?", written).groups()
    element = GENERATED.get(element, element)
    if array == "[]":
        return f"sequence<{element}>"
    return element + (array or "")


class Table:
    """What a package is meant to have, in order."""

    def __init__(self, package: str, file: Path):
        self.messages = importlib.import_module(f"{package}.msg")
        self.services = importlib.import_module(f"{package}.srv")
        lines = [line for line in file.read_text().splitlines() if not line.startswith("#")]
        self.rows = {name: list(group) for name, group in groupby(csv.DictReader(lines), lambda row: row["interface"])}

    def generated(self, name: str):
        if "." in name:
            service, half = name.split(".")
            return getattr(getattr(self.services, service), half)
        return getattr(self.messages, name)

    def check_fields(self, name: str):
        """Types, names and order."""
        wanted = [(row["name"], as_generated(row["type"])) for row in self.rows[name] if row["kind"] == "field"]
        assert list(self.generated(name).get_fields_and_field_types().items()) == wanted

    def check_constants(self, name: str):
        wanted = {row["name"]: int(row["value"], 0) for row in self.rows[name] if row["kind"] == "constant"}
        kind = self.generated(name)
        present = {key: getattr(kind, key) for key in vars(type(kind))
                   if key.isupper() and not key.startswith("_") and "DEFAULT" not in key}
        assert present == wanted

    def check_complete(self, messages: int, services: int):
        """Nothing is missing in the table, and it has as many as were counted by hand."""
        there = {name for name in dir(self.messages) if INTERFACE.match(name)}
        offered = {name for name in dir(self.services) if INTERFACE.match(name)
                   and not re.search(r"_(Request|Response|Event)$", name)}
        assert there == {name for name in self.rows if "." not in name}
        assert offered == {name.split(".")[0] for name in self.rows if "." in name}
        assert (len(there), len(offered)) == (messages, services)
