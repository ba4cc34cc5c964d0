# SPDX-License-Identifier: BSD-3-Clause
"""Usage: ./rosflight bench [NAME...] [--all] [--json FILE]
       ./rosflight bench rtt --board BOARD [--count N]
       ./rosflight bench --boards DIR [--board BOARD] [--count N] [--seconds S]

Measures the project's figures, prints each with its target as soon as it is there, and writes them to FILE as one JSON
object after each: name -> {"value", "unit", "target", "met"}. NAME chooses by a part of the name.
Without a name those are measured that take five minutes together. By name or with --all also: faults in every phase and
in pairs (faults, a quarter of an hour; prints the matrix and writes docs/fault-matrix.md), random flights (property, half an
hour), the build (build, some minutes), round trips, speed and load over ROS (rtt, ros, load,
a quarter of an hour), 100 000 flights of a cluster whose workers are killed (scale.rows, an hour or more; scale alone leaves them out)
and the fuzzers with a million inputs each, those of the receivers' decoders and of the GNSS receiver's parser with ten million
(fuzz, hours).
rtt --board: round trips of N offboard commands (18000, which are 45 s at 400 Hz) to an emulated board, BOARD one of pixracer_pro and
varmint, and then as fast as they are answered, over USB and over the UART at 921600 and 3000000 baud, with all streams on.
--boards: the paper's measurements on the emulated Pixracer Pro and Varmint, as a table and as pictures in DIR: round trips of
N offboard commands (18000) over USB and over the UART at 921600 and 3000000 baud, and S seconds (20) of a triangle wave of roll
in pass-through at 400 Hz. A quarter of an hour.
A figure that cannot be measured has value null and says why under "reason".
Exit code 0 when every chosen figure was measured, met or not; 1 otherwise.
"""

import json
import os
import re
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Callable

import bench_figures
import bench_programs
import board_demo
import project
from bench_figures import Figure


@dataclass
class Result:
    figure: Figure
    value: float | None = None
    reason: str = ""

    def met(self) -> bool | None:
        """None for a figure that is only reported."""
        if self.figure.target == "report":
            return None
        return self.value is not None and meets(self.value, self.figure.target)

    def as_json(self) -> dict:
        entry = {"value": self.value, "unit": self.figure.unit, "target": self.figure.target,
                 "met": self.met()}
        return {**entry, "reason": self.reason} if self.reason else entry


def meets(value: float, target: str) -> bool:
    """Whether a value meets a target such as "<= 2500", "< 5", ">= 1000", "= 0" or "0.7..1.3"."""
    both = re.fullmatch(r"([\d.e+]+?)\.\.([\d.e+]+)", target)
    if both is not None:
        return float(both[1]) <= value <= float(both[2])
    match = re.fullmatch(r"(<=|>=|<|>|=)\s*([\d.e+]+)", target)
    if match is None:
        raise ValueError(f"target '{target}' is none of <=, >=, <, >, = and a number, and not LOW..HIGH")
    limit = float(match[2])
    return {"<=": value <= limit, ">=": value >= limit, "<": value < limit, ">": value > limit,
            "=": value == limit}[match[1]]


def measure(figure: Figure) -> Result:
    """A figure that cannot be measured gives the reason and does not stop the others."""
    try:
        return Result(figure, value=figure.measure())
    except Exception as error:
        return Result(figure, reason=str(error) or type(error).__name__)


def shown(value: float | None) -> str:
    if value is None:
        return "-"
    return f"{value:.0f}" if value == int(value) or abs(value) >= 1000 else f"{value:.4g}"


def row(*cells: str) -> str:
    return f"{cells[0]:<34}{cells[1]:>12} {cells[2]:<14}{cells[3]:<14}{cells[4]}"


def result_row(result: Result) -> str:
    met = {True: "yes", False: "no", None: "-"}[result.met()]
    line = row(result.figure.name, shown(result.value), result.figure.unit, result.figure.target, met)
    return line + (f"  not measured: {result.reason}" if result.reason else "")


def parse(arguments: list[str]) -> tuple[list[str], bool, Path | None]:
    """Names, whether all, and the JSON file."""
    names, everything, file = [], False, None
    rest = iter(arguments)
    for argument in rest:
        if argument == "--json":
            file = next(rest, None)
            if file is None:
                raise ValueError("--json needs a file name")
        elif argument.startswith("--json="):
            file = argument.removeprefix("--json=")
        elif argument == "--all":
            everything = True
        elif argument.startswith("-"):
            raise ValueError(f"unknown option '{argument}'; allowed: --all, --json FILE, --boards DIR, --help")
        else:
            names.append(argument)
    return names, everything, Path(file).absolute() if file else None


def chosen_by(name: str, figure: Figure) -> bool:
    return name in figure.name and figure.by in name


def choose(names: list[str], everything: bool, figures: list[Figure]) -> list[Figure]:
    for name in names:
        if not any(chosen_by(name, figure) for figure in figures):
            groups = ", ".join(dict.fromkeys(figure.name.split(".")[0] for figure in figures))
            raise ValueError(f"NAME: found '{name}', allowed a part of a figure's name; they begin with {groups}")
    if everything:
        return figures
    return [f for f in figures if (any(chosen_by(name, f) for name in names) if names else not f.on_request)]


def write(results: list[Result], file: Path):
    written = file.with_name(file.name + ".new")
    written.write_text(json.dumps({r.figure.name: r.as_json() for r in results}, indent=2) + "\n")
    written.replace(file)


def main(arguments: list[str], figures: Callable[[], list[Figure]] = bench_figures.all_figures) -> int:
    if {"-h", "--help"} & set(arguments):
        print(__doc__)
        return 0
    if arguments[:1] == ["--boards"]:
        return board_demo.main(arguments[1:])
    if arguments[:1] == ["rtt"] and any(word.split("=")[0] in ("--board", "--count") for word in arguments):
        return board_demo.round_trips_main(arguments[1:])
    try:
        names, everything, file = parse(arguments)
        chosen = choose(names, everything, figures())
        if file and not os.access(file.parent, os.W_OK):
            raise ValueError(f"cannot write {file}: no such folder, or not writable")
    except ValueError as error:
        print(f"rosflight: {error}", file=sys.stderr)
        return 2
    for preset in sorted({figure.preset for figure in chosen}):
        bench_programs.prepare(preset)
    print(row("figure", "value", "unit", "target", "met"), flush=True)
    results = []
    for figure in chosen:
        results.append(measure(figure))
        print(result_row(results[-1]), flush=True)
        if file:
            write(results, file)
    return 1 if any(result.value is None for result in results) else 0


if __name__ == "__main__":
    project.end_children_with_us()
    sys.exit(main(sys.argv[1:]))
