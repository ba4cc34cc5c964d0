# SPDX-License-Identifier: BSD-3-Clause
"""Line coverage of the part drivers (firmware/boards/parts) by their own tests: h7.driver_coverage of ./rosflight bench.

Builds those tests with the preset `coverage`, runs each once and reads the counts of gcov. A line counts as executable if gcc
made code of it in any of the programs, and as covered if any of them ran it. By hand, with the table of the drivers:

    .venv/bin/python3 tools/driver_coverage.py
"""

import functools
import json
import subprocess
import sys
from pathlib import Path

import cpp_tests
import project

PRESET = "coverage"
BUILD = project.ROOT / "build" / PRESET
DRIVERS = project.ROOT / "firmware" / "boards" / "parts"

Lines = dict[int, int]  # line number -> how often it ran


def merged(reports: list[dict], folder: Path = DRIVERS) -> dict[str, Lines]:
    """Counts of the files that lie directly in a folder, from the JSON reports of gcov: a header is in several of them."""
    files: dict[str, Lines] = {}
    for report in reports:
        for file in report["files"]:
            path = Path(report["current_working_directory"], file["file"]).resolve()
            if path.parent != folder or not file["lines"]:
                continue
            lines = files.setdefault(path.name, {})
            for line in file["lines"]:
                lines[line["line_number"]] = lines.get(line["line_number"], 0) + line["count"]
    return files


def percent(lines: list[int]) -> float:
    return 100.0 * sum(count > 0 for count in lines) / len(lines)


def run_tests() -> list[str]:
    """Builds and runs the test programs of the drivers. @returns their names."""
    if not project.build(PRESET, "build.ninja"):
        raise RuntimeError(f"not configured, see {BUILD}/configure.log")
    names = [binary.name for binary in cpp_tests.find(PRESET) if binary.name.startswith("parts_")]
    if not names or not project.build(PRESET, *names):
        raise RuntimeError(f"the tests of the drivers do not build, see {BUILD}/build.log")
    for old in BUILD.rglob("*.gcda"):
        old.unlink()
    ran = cpp_tests.run_all([binary for binary in cpp_tests.find(PRESET) if binary.name in names], BUILD / "results")
    complaints = [line for outcome in ran.values() for line in outcome.complaints]
    if complaints:
        raise RuntimeError("; ".join(complaints[:3]))
    return names


@functools.cache
def files() -> dict[str, Lines]:
    run_tests()
    counts = sorted(BUILD.rglob("*.gcda"))
    if not counts:
        raise RuntimeError("the tests left no counts")
    command = ["gcov", "--json-format", "--stdout", *map(str, counts)]
    said = subprocess.run(command, cwd=BUILD, capture_output=True, text=True, check=True)
    found = merged([json.loads(line) for line in said.stdout.splitlines() if line.strip()])
    missing = {path.name for path in DRIVERS.glob("*.cpp")} - found.keys()
    if missing:
        raise RuntimeError(f"no counts of {', '.join(sorted(missing))}")
    return found


def total() -> float:
    """Covered lines of all drivers [%]."""
    return percent([count for lines in files().values() for count in lines.values()])


def by_driver(counts: dict[str, Lines]) -> dict[str, list[int]]:
    """Header and source of one name together."""
    drivers: dict[str, list[int]] = {}
    for name, lines in counts.items():
        drivers.setdefault(Path(name).stem, []).extend(lines.values())
    return drivers


def lowest() -> float:
    """That of the driver that is covered least [%]."""
    return min(map(percent, by_driver(files()).values()))


def main() -> int:
    for driver, lines in sorted(by_driver(files()).items(), key=lambda each: percent(each[1])):
        uncovered = [f"{name}:{number}" for name, counts in sorted(files().items()) if Path(name).stem == driver
                     for number, count in sorted(counts.items()) if count == 0]
        print(f"{driver:<20}{len(lines):>6} lines {percent(lines):>7.1f} %  {' '.join(uncovered)}".rstrip())
    print(f"{'all':<20}{sum(map(len, files().values())):>6} lines {total():>7.1f} %")
    return 0


if __name__ == "__main__":
    sys.exit(main())
