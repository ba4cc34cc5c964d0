# SPDX-License-Identifier: BSD-3-Clause
"""The generated types against interfaces.csv, a table of what ROSflight 2.x has."""

import csv
import re
from itertools import groupby
from pathlib import Path

import pytest
import rosflight_msgs.msg
import rosflight_msgs.srv

TABLE = Path(__file__).parent / "interfaces.csv"
# The generators' names for the basic types, where they differ from those of a .msg file.
GENERATED = {"float32": "float", "float64": "double", "bool": "boolean"}
# Fields every Jazzy service half has none of; anything else in a module is a type of ours.
INTERFACE = re.compile(r"^[A-Z]\w*$")


def rows():
    lines = [line for line in TABLE.read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


INTERFACES = {name: list(group) for name, group in groupby(rows(), lambda row: row["interface"])}


def generated(name: str):
    if "." in name:
        service, half = name.split(".")
        return getattr(getattr(rosflight_msgs.srv, service), half)
    return getattr(rosflight_msgs.msg, name)


def as_generated(written: str) -> str:
    element, array = re.fullmatch(r"([\w/]+)(\[\d*\])?", written).groups()
    element = GENERATED.get(element, element)
    if array == "[]":
        return f"sequence<{element}>"
    return element + (array or "")


@pytest.mark.parametrize("name", INTERFACES)
def test_fields_have_the_types_names_and_order_of_the_table(name):
    wanted = [(row["name"], as_generated(row["type"]))
              for row in INTERFACES[name] if row["kind"] == "field"]
    assert list(generated(name).get_fields_and_field_types().items()) == wanted


@pytest.mark.parametrize("name", INTERFACES)
def test_constants_have_the_values_of_the_table(name):
    wanted = {row["name"]: int(row["value"], 0)
              for row in INTERFACES[name] if row["kind"] == "constant"}
    present = {key: getattr(generated(name), key) for key in vars(type(generated(name)))
               if key.isupper() and not key.startswith("_") and "DEFAULT" not in key}
    assert present == wanted


def test_no_interface_is_missing_in_the_table():
    messages = {name for name in dir(rosflight_msgs.msg) if INTERFACE.match(name)}
    services = {name for name in dir(rosflight_msgs.srv) if INTERFACE.match(name)
                and not re.search(r"_(Request|Response|Event)$", name)}
    assert messages == {name for name in INTERFACES if "." not in name}
    assert services == {name.split(".")[0] for name in INTERFACES if "." in name}
    assert (len(messages), len(services)) == (15, 4)
