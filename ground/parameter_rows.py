# SPDX-License-Identifier: BSD-3-Clause
"""Makes the rows of ground/parameter_info.cpp from the firmware's table.

usage: parameter_rows.py parameters.csv ROWS.inc
"""
import csv
import math
import sys


def number(text):
    value = float(text)
    return ("-" if value < 0 else "") + "kInfinity" if math.isinf(value) else repr(value)


def quoted(text):
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def main():
    source, target = sys.argv[1:]
    with open(source, newline="") as file:
        rows = list(csv.DictReader(file))
    with open(target, "w") as file:
        for row in rows:
            sentinel = number(row["sentinel"] or row["default"])
            kind = "kInt32" if row["type"] == "int32" else "kFloat"
            file.write(f'{{"{row["name"]}", link::ParamType::{kind}, {number(row["default"])}, {number(row["min"])}, '
                       f'{number(row["max"])}, {sentinel}, "{row["units"]}", {quoted(row["description"])}}},\n')


main()
