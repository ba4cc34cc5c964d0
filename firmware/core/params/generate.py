#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the parameter table of the firmware, and its reference page, from parameters.csv.

usage: generate.py parameters.csv HEADER.hpp REFERENCE.md
Checks the table itself: names, types, and that every default and sentinel is in range.

Column `armed`, what one message may do to the value while armed: empty = anything in range; `locked` = nothing;
`FACTOR [step STEP] [up]` = at most FACTOR times as much or as little, with the same sign, or a change of at most STEP;
with `up` never less than it is. Floats only."""
import csv
import itertools
import math
import os
import re
import sys

COLUMNS = ["name", "type", "default", "min", "max", "sentinel", "armed", "units", "description"]
NAMES_PER_BLOCK = 16


def identifier(name):
    """PRI_MIXER_OUT_3 -> kPriMixerOut3, PRI_MIXER_1_2 -> kPriMixer1_2."""
    parts = [p.capitalize() for p in name.split("_")]
    text = parts[0]
    for before, part in zip(parts, parts[1:]):
        text += ("_" if before[-1].isdigit() and part[0].isdigit() else "") + part
    return "k" + text


def literal(kind, text):
    return f"{int(text)}" if kind == "int32" else f"{float(text)!r}f"


ARMED = re.compile(r"([0-9.]+)(?: step ([0-9.]+))?( up)?")


def armed_rule(where, row):
    """Factor, step and direction of the column `armed`, as in ArmedRule."""
    text = row["armed"]
    if text in ("", "locked"):
        return (0.0 if text else math.inf), 0.0, False
    found = ARMED.fullmatch(text)
    try:
        factor, step = (float(part or 0) for part in found.groups()[:2])
    except (AttributeError, ValueError):
        factor = 0.0
    if factor < 1.0 or row["type"] != "float":
        fail(where, f"armed: found '{text}', allowed empty, locked, and for a float: FACTOR [step STEP] [up] "
                    "with a factor of 1 or more")
    return factor, step, found[3] is not None


def fail(where, text):
    print(f"{where}: {text}", file=sys.stderr)
    sys.exit(2)


def number(where, row, key, kind):
    """The value of a cell. Integers must be whole and exact in a float, where their limits are kept."""
    text = row[key]
    try:
        value = float(text)
    except ValueError:
        fail(where, f"{key}: found '{text}', allowed a number")
    if math.isnan(value):
        fail(where, f"{key}: found '{text}', allowed a number")
    if kind == "int32" and (not re.fullmatch(r"-?[0-9]+", text) or abs(value) > 2**24):
        fail(where, f"{key}: found '{text}', allowed an integer within +-{2**24}")
    if kind == "float" and not math.isinf(value) and abs(value) > 3.4e38:
        fail(where, f"{key}: found '{text}', allowed what a 32-bit float holds")
    return value


def check(where, row):
    name, kind = row["name"], row["type"]
    if not re.fullmatch(r"[A-Z][A-Z0-9_]{0,15}", name):
        fail(where, f"name: found '{name}', allowed 1..16 of A-Z 0-9 _")
    if kind not in ("int32", "float"):
        fail(where, f"type: found '{kind}', allowed int32, float")
    low, high, default = (number(where, row, key, kind) for key in ("min", "max", "default"))
    sentinel = number(where, row, "sentinel", kind) if row["sentinel"] else None
    if low > high:
        fail(where, f"min: found {row['min']}, allowed up to max {row['max']}")
    if math.isinf(default) or (sentinel is not None and math.isinf(sentinel)):
        fail(where, "default, sentinel: found an infinity, allowed finite numbers")
    if not (low <= default <= high or default == sentinel):
        fail(where, f"default: found {row['default']}, allowed {row['min']}..{row['max']} or the sentinel")
    armed_rule(where, row)


def read(path):
    rows = []
    lines = {}
    try:
        with open(path, newline="") as file:
            reader = csv.DictReader(file, strict=True)
            if reader.fieldnames != COLUMNS:
                fail(f"{path}:1", f"columns: found {reader.fieldnames}, allowed {COLUMNS}")
            for row in reader:
                where = f"{path}:{reader.line_num}"
                if None in row or None in row.values():
                    fail(where, f"found another number of columns, allowed {len(COLUMNS)}")
                check(where, row)
                if row["name"] in lines:
                    fail(where, f"name: '{row['name']}' is already in line {lines[row['name']]}")
                lines[row["name"]] = reader.line_num
                rows.append(row)
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        fail(path, str(error))
    if not rows:
        fail(path, "found no parameter")
    return rows


def limit(text):
    value = float(text)
    return ("-" if value < 0 else "") + "kInfinity" if math.isinf(value) else f"{value!r}f"


def kind_of(row, rules):
    """All of a row but its name, as the call that makes it."""
    default = literal(row["type"], row["default"])
    sentinel = limit(row["sentinel"] or row["default"])
    make = "int_kind" if row["type"] == "int32" else "float_kind"
    return f"{make}({default}, {limit(row['min'])}, {limit(row['max'])}, {sentinel}, {rules.index(armed_rule('', row))})"


def lines_of(numbers):
    numbers = list(numbers)
    for start in range(0, len(numbers), 16):
        yield "    " + "".join(f"{number}, " for number in numbers[start:start + 16]).rstrip()


def packed(names):
    """Each name as the characters that it does not share with the one before: parameter_row.hpp, next_name()."""
    before = ""
    for index, name in enumerate(names):
        shared = len(os.path.commonprefix([before, name[:-1]])) if index % NAMES_PER_BLOCK else 0
        yield bytes([shared << 4 | len(name) - shared - 1]) + name[shared:].encode()
        before = name


def header(rows):
    rules = list(dict.fromkeys(armed_rule("", row) for row in rows))
    yield "// Generated from firmware/core/parameters.csv. Do not edit."
    yield "#pragma once"
    yield "#include <limits>"
    yield '#include "firmware/core/parameter_row.hpp"'
    yield "namespace rosflight::core {"
    yield "enum class Param : std::uint16_t {"
    for row in rows:
        yield f"  {identifier(row['name'])},"
    yield "};"
    yield f"inline constexpr std::size_t kParamCount = {len(rows)};"
    yield "namespace detail {"
    yield "inline constexpr float kInfinity = std::numeric_limits<float>::infinity();"
    yield f"inline constexpr std::array<ArmedRule, {len(rules)}> kArmedRules{{{{"
    for factor, step, only_up in rules:
        yield f"    {{{limit(str(factor))}, {limit(str(step))}, {str(only_up).lower()}}},"
    yield "}};"
    kinds = [kind_of(row, rules) for row in rows]
    distinct = list(dict.fromkeys(kinds))
    yield f"inline constexpr std::array<ParamKind, {len(distinct)}> kParamKinds{{{{"
    yield from (f"    {kind}," for kind in distinct)
    yield "}};"
    yield "/// Which of them a parameter is."
    yield "inline constexpr std::array<std::uint8_t, kParamCount> kParamKindOf{{"
    yield from lines_of(distinct.index(kind) for kind in kinds)
    yield "}};"
    names = list(packed(row["name"] for row in rows))
    begins = list(itertools.accumulate(map(len, names), initial=0))
    yield "/// All names, packed (next_name()), and where those begin that share nothing with the name before."
    yield f"inline constexpr std::array<std::uint8_t, {begins[-1]}> kParamNames{{{{"
    yield from lines_of(b"".join(names))
    yield "}};"
    yield f"inline constexpr std::size_t kNamesPerBlock = {NAMES_PER_BLOCK};"
    blocks = begins[:-1:NAMES_PER_BLOCK]
    yield f"inline constexpr std::array<std::uint16_t, {len(blocks)}> kNameBlocks{{{{"
    yield from lines_of(blocks)
    yield "}};"
    yield "}  // namespace detail"
    yield "}  // namespace rosflight::core"


def page(rows):
    yield "# Firmware parameters"
    yield ""
    yield f"{len(rows)} parameters, in the order of their index on the link."
    yield ""
    yield "While armed: *locked* parameters keep their value. A number f is the largest factor by which one message may"
    yield "change the value v, up or down, with the same sign: |v|/f .. f |v|. With *step s* a change of at most s is"
    yield "allowed too, through 0 and from it; without one a value never becomes 0. With *up* the value never falls. A message"
    yield "that asks for more is answered with the value in force and the text `Not that far while armed, kept: NAME`."
    yield ""
    yield "| index | name | type | default | allowed | unit | while armed | meaning |"
    yield "|---|---|---|---|---|---|---|---|"
    for index, row in enumerate(rows):
        allowed = f"{row['min']} .. {row['max']}" + (f" or {row['sentinel']}" if row["sentinel"] else "")
        description = row["description"].replace("|", "\\|")  # a bar would end the cell
        yield (f"| {index} | {row['name']} | {row['type']} | {row['default']} | {allowed} | {row['units']} "
               f"| {row['armed']} | {description} |")


def main():
    if len(sys.argv) != 4:
        fail("generate.py", "usage: generate.py parameters.csv HEADER.hpp REFERENCE.md")
    source, hpp, md = sys.argv[1:]
    rows = read(source)
    for path, lines in ((hpp, header(rows)), (md, page(rows))):
        with open(path, "w") as file:
            file.write("\n".join(lines) + "\n")


main()
