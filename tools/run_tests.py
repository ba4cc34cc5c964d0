# SPDX-License-Identifier: BSD-3-Clause
"""Usage: ./rosflight test [NAME...]

Builds and runs every test and ends with the line "N passed, M failed". Exit code 1 if any failed.

NAME chooses: a stage by its name, and test programs and pytest files by a part of theirs.
Stages: format, structure, build, unit, mutation, python, ros, cortex-m7, sanitizers, ros-sanitizers, fuzz, tidy. Sanitizers
and clang-tidy look at what flies and at whole flights; sanitizers-rest, tidy-rest and tidy-ros (simulation, programs,
tests, ROS nodes) run when named: they take as long as all others together.

./rosflight test mutations [NAME...] writes each defect of tools/mutations/ into a copy of the tree and shows that a test
sees it; NAME is a part of the names there. The stage mutation does one of them.
"""

import os
import sys
import time

import cpp_tests
import mutation_tests
import project
import ros_test
import stages
from cpp_tests import Outcome

# Quick ones first, so that a slip shows early. Each is (name, what to run).
STAGES = {
    "format": stages.check_format,
    "structure": stages.check_structure,
    "build": stages.build_release,
    "unit": stages.unit_tests,
    "mutation": mutation_tests.test_one,
    "python": stages.python_tests,
    "ros": stages.ros_tests,
    "cortex-m7": stages.cortex_m7,
    "sanitizers": stages.sanitizers,
    "ros-sanitizers": stages.ros_sanitizers,
    "fuzz": stages.fuzz,
    "tidy": stages.tidy_product,
    "sanitizers-rest": stages.sanitizers_rest,
    "tidy-rest": stages.tidy_rest,
    "tidy-ros": stages.tidy_ros,
}
ON_REQUEST = {"sanitizers-rest", "tidy-rest", "tidy-ros"}


def chosen_stages(names: list[str]):
    """The stages to run as (name, function of no argument)."""
    if not names:
        return [(name, run) for name, run in STAGES.items() if name not in ON_REQUEST]
    if names[0] == "mutations":
        mutation_tests.chosen(names[1:])
        return [("mutations", lambda: mutation_tests.test(names[1:]))]
    chosen = [(name, STAGES[name]) for name in names if name in STAGES]
    parts = [name for name in names if name not in STAGES]
    if parts:
        binaries, files = stages.matching(parts)
        ros_parts = [part for part in parts if any(part in str(file) for file in ros_test.files())]
        for part in parts:
            if not any(part in known for known in [*binaries, *map(str, files), *ros_parts]):
                raise ValueError(f"no stage, test program or pytest file matches '{part}'; test "
                                 f"programs: {', '.join(stages.test_names())}")
        if binaries:
            chosen.append(("unit", lambda: stages.unit_tests(binaries)))
        if files:
            chosen.append(("python", lambda: stages.python_tests(files)))
        if ros_parts:
            chosen.append(("ros", lambda: stages.ros_tests(ros_parts)))
    return chosen


def run_stage(function) -> Outcome:
    """A stage that breaks is a failure of that stage; the others still run."""
    try:
        return function()
    except Exception as error:
        return Outcome(failed=1, complaints=[f"{type(error).__name__}: {error}"])


def main(names: list[str]) -> int:
    if {"-h", "--help"} & set(names):
        print(__doc__)
        return 0
    try:
        chosen = chosen_stages(names)
    except ValueError as error:
        print(f"rosflight: {error}", file=sys.stderr)
        return 2
    rows = []
    for name, function in chosen:
        print(f"== {name}", flush=True)
        start = time.monotonic()
        outcome = run_stage(function)
        minutes = (time.monotonic() - start) / 60
        for line in outcome.complaints:
            print(f"   {line}")
        rows.append((name, minutes, outcome))
        print(f"   {outcome.passed} passed, {outcome.failed} failed, {minutes:.1f} min", flush=True)
    print_table(rows)
    failed = sum(outcome.failed for _, _, outcome in rows)
    print(f"{sum(outcome.passed for _, _, outcome in rows)} passed, {failed} failed")
    return 1 if failed else 0


def print_table(rows):
    print(f"\n{'stage':<15}{'minutes':>8}{'passed':>8}{'failed':>8}")
    for name, minutes, outcome in rows:
        print(f"{name:<15}{minutes:>8.1f}{outcome.passed:>8}{outcome.failed:>8}")
    print(f"{'all':<15}{sum(row[1] for row in rows):>8.1f}\n")


if __name__ == "__main__":
    os.chdir(project.ROOT)
    sys.exit(main(sys.argv[1:]))
