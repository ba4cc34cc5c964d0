# SPDX-License-Identifier: BSD-3-Clause
"""Computes what a million flights take from the figures of ./rosflight bench scale, into docs/beyond-one-machine.md.

Usage: beyond_one_machine.py FIGURES.json    what ./rosflight bench scale --json FIGURES.json has written
       beyond_one_machine.py --check         writes nothing and ends with 1 if the page's sizes do not follow from its figures
"""

import json
import re
import sys
from pathlib import Path

import project

DOCUMENT = project.ROOT / "docs/beyond-one-machine.md"
BEGIN = "<!-- Computed by tools/beyond_one_machine.py: do not edit. -->\n"
END = "<!-- End of what is computed. -->\n"

FLIGHTS = 10**6
STEPS = 10**10
CORES = (2, 16, 128, 1024)
FAILED = 0.01  # share of flights that are flown again with a log
EFFICIENCY = 0.9  # of cores that work together; what ./rosflight bench scale asks of two workers

#: Figures that the sizes follow from: name, meaning, decimal places.
USED = [("scale.flights_per_core_minute", "flights of the default mission, per core and minute", 0),
        ("scale.steps_per_core_s", "steps of an environment at 100 Hz, per core and second", 0),
        ("scale.memory_kB", "memory of a vehicle that differs [kB]", 0),
        ("scale.row_bytes", "a row of `rows.parquet` [B]", 0),
        ("scale.log_bytes", "the folder of a flight with its log [B]", 0)]


def measured(file: Path) -> dict[str, float]:
    """@throws ValueError  a figure is missing, or was not measured."""
    figures = json.loads(file.read_text())
    missing = [name for name, *_ in USED if not isinstance(figures.get(name, {}).get("value"), (int, float))]
    if missing:
        raise ValueError(f"{file}: found no value of {', '.join(missing)}, allowed a file of ./rosflight bench scale --json")
    return {name: round(figures[name]["value"], places) for name, _, places in USED}


def said(page: str) -> dict[str, float]:
    """The figures that the page names."""
    return {name: float(value) for name, value in re.findall(r"^\| `(scale\.\w+)` \|[^|]*\| (\d+) \|$", page, re.MULTILINE)}


def duration(hours: float) -> str:
    if hours >= 48:
        return f"{hours / 24:.1f} days"
    return f"{hours:.1f} h" if hours >= 1 else f"{60 * hours:.0f} min"


def size(count: float) -> str:
    for unit, factor in (("TB", 1e12), ("GB", 1e9), ("MB", 1e6)):
        if count >= factor:
            return f"{count / factor:.2g} {unit}" if count < 10 * factor else f"{count / factor:.0f} {unit}"
    return f"{count / 1e3:.0f} kB"


def tables(figures: dict[str, float]) -> str:
    flight_hours = FLIGHTS / figures["scale.flights_per_core_minute"] / 60
    step_hours = STEPS / figures["scale.steps_per_core_s"] / 3600
    rows = ["| figure | of | value |", "|---|---|---|",
            *(f"| `{name}` | {meaning} | {figures[name]:.0f} |" for name, meaning, _ in USED), "",
            f"A million flights take {flight_hours:.1f} core-hours, {STEPS:.0e} steps of environments {step_hours:.1f}.".replace("1e+10", "10^10"), "",
            "| cores | a million flights | 10^10 steps |", "|---|---|---|"]
    rows += [f"| {cores} | {duration(flight_hours / cores / EFFICIENCY)} | {duration(step_hours / cores / EFFICIENCY)} |" for cores in CORES]
    rows += ["", "| what a million flights leave | bytes |", "|---|---|",
             f"| rows | {size(FLIGHTS * figures['scale.row_bytes'])} |",
             f"| logs of 1 % that failed, flown again | {size(FAILED * FLIGHTS * figures['scale.log_bytes'])} |",
             f"| logs of all, which a campaign does not keep | {size(FLIGHTS * figures['scale.log_bytes'])} |", "",
             f"10 000 vehicles of environments need {size(1e4 * 1e3 * figures['scale.memory_kB'])} of memory."]
    return "\n".join(rows) + "\n"


def with_tables(page: str, computed: str) -> str:
    before, rest = page.split(BEGIN)
    return before + BEGIN + computed + END + rest.split(END)[1]


def main(arguments: list[str]) -> int:
    page = DOCUMENT.read_text()
    if arguments == ["--check"]:
        return 0 if with_tables(page, tables(said(page))) == page else 1
    if len(arguments) != 1 or arguments[0].startswith("-"):
        print(__doc__.split("\n\n")[1], file=sys.stderr)
        return 2
    try:
        figures = measured(Path(arguments[0]))
    except (OSError, ValueError) as error:
        print(f"beyond_one_machine.py: {error}", file=sys.stderr)
        return 2
    DOCUMENT.write_text(with_tables(page, tables(figures)))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
