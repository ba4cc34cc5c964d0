# SPDX-License-Identifier: BSD-3-Clause
"""Usage: ./rosflight test [NAME...]

Builds and runs every test and ends with the line "N passed, M failed", before it the number of skipped cases, if any, which
the stages name. Exit code 1 if any failed.

NAME chooses: a stage by its name, and test programs and pytest files by a part of theirs. quick stands for format,
structure, build, unit and python: less than five minutes after a build.
Stages: format, structure, build, unit, mutation, faults, python, python-package, web, ros, cortex-m7, sanitizers, ros-sanitizers,
fuzz, tidy, arm64 (on Debian 12: tests of core, link, simulation and autonomy and a flight, cross-built for the companion's computer
and run on an emulated processor). Sanitizers and clang-tidy look at what flies and at whole flights; sanitizers-rest, tidy-rest and
tidy-ros (simulation, programs, tests, ROS nodes) run when named: they take as long as all others together. So do arm64-rest (long
tests, both default flights and the Debian package for that computer) and web-rest: calibrations in the browser that take over a
minute of real time, and a flight looked at by touch and changed without a mouse. The stage faults flies a quarter of the fault campaign and 300 seeds in gusts.

Stages that run in real time (python, ros, ros-sanitizers) run beside those that compute, which have the lowest priority.
The output of a stage is printed when it ends. The table gives wall time and processor time of each stage.

./rosflight test mutations [NAME...] writes each defect of tools/mutations/ into a copy of the tree and shows that a test
sees it; NAME is a part of the names there. The stage mutation does two of them, one of the firmware and one of autonomy.
"""

import difflib
import os
import sys

import arm64_tests
import lanes
import mutation_tests
import project
import python_package
import ros_test
import stages
from lanes import COMPUTES, WAITS, Stage

# In each lane quick ones first, so that a slip shows early.
STAGES = {
    "format": Stage(stages.check_format),
    "structure": Stage(stages.check_structure),
    "build": Stage(stages.build_release),
    "python": Stage(stages.python_tests, WAITS),
    "python-package": Stage(stages.python_package_tests, WAITS),
    "web": Stage(stages.web_tests, WAITS),
    "cortex-m7": Stage(stages.cortex_m7, WAITS),  # one of its flights is in real time
    "ros": Stage(stages.ros_tests, WAITS),
    "ros-sanitizers": Stage(stages.ros_sanitizers, WAITS),
    "unit": Stage(stages.unit_tests, COMPUTES),
    "mutation": Stage(mutation_tests.test_cheapest, COMPUTES),
    "faults": Stage(stages.faults, COMPUTES),
    "fuzz": Stage(stages.fuzz, COMPUTES),
    "sanitizers": Stage(stages.sanitizers, COMPUTES),
    "tidy": Stage(stages.tidy_product, COMPUTES),
    "arm64": Stage(arm64_tests.quick, COMPUTES),
    "arm64-rest": Stage(arm64_tests.rest, COMPUTES),
    "web-rest": Stage(stages.web_rest, WAITS),
    "sanitizers-rest": Stage(stages.sanitizers_rest, COMPUTES),
    "tidy-rest": Stage(stages.tidy_rest, COMPUTES),
    "tidy-ros": Stage(stages.tidy_ros, COMPUTES),
}
ON_REQUEST = {"arm64-rest", "web-rest", "sanitizers-rest", "tidy-rest", "tidy-ros"}
QUICK = ("format", "structure", "build", "unit", "python")


def chosen_stages(names: list[str]) -> list[tuple[str, Stage]]:
    """The stages to run, in order, each with its name."""
    if not names:
        return [(name, stage) for name, stage in STAGES.items() if name not in ON_REQUEST]
    if names[0] == "mutations":
        mutation_tests.chosen(names[1:])
        return [("mutations", Stage(lambda: mutation_tests.test(names[1:])))]
    named = [stage for name in names for stage in (QUICK if name == "quick" else [name])]
    chosen = [(name, STAGES[name]) for name in dict.fromkeys(named) if name in STAGES]
    parts = [name for name in named if name not in STAGES]
    if parts:
        binaries, files = stages.matching(parts)
        ros_parts = [part for part in parts if any(part in str(file) for file in ros_test.files())]
        package_parts = [part for part in parts if any(part in str(file) for file in python_package.files())]
        for part in parts:
            if not any(part in known for known in [*binaries, *map(str, files), *ros_parts, *package_parts]):
                near = difflib.get_close_matches(part, stages.test_names(), n=4, cutoff=0.3)
                raise ValueError(f"found {part}, allowed a stage ({', '.join(STAGES)}), or a part of the name of a test "
                                 f"program or pytest file, as {', '.join(near or stages.test_names()[:4])}")
        if binaries:
            chosen.append(("unit", Stage(lambda: stages.unit_tests(binaries))))
        if files:
            chosen.append(("python", Stage(lambda: stages.python_tests(files))))
        if package_parts:
            chosen.append(("python-package", Stage(lambda: stages.python_package_tests(package_parts))))
        if ros_parts:
            chosen.append(("ros", Stage(lambda: stages.ros_tests(ros_parts))))
    return chosen


def main(names: list[str]) -> int:
    if {"-h", "--help"} & set(names):
        print(__doc__)
        return 0
    try:
        chosen = chosen_stages(names)
    except ValueError as error:
        print(f"rosflight: {error}", file=sys.stderr)
        return 2
    rows, minutes = lanes.run(chosen)
    print_table(rows, minutes)
    failed = sum(row.outcome.failed for row in rows)
    if len(rows) != len(chosen):  # a stage that was never run must not look like one that passed
        failed += len(chosen) - len(rows)
        print(f"{len(chosen) - len(rows)} stages did not run")
    if skipped := sum(len(row.outcome.skipped) for row in rows):
        print(f"{skipped} skipped")
    print(f"{sum(row.outcome.passed for row in rows)} passed, {failed} failed")
    return 1 if failed else 0


def print_table(rows: list[lanes.Row], minutes: float):
    print(f"\n{'stage':<15}{'minutes':>8}{'processor':>10}{'passed':>8}{'failed':>8}")
    for row in rows:
        print(f"{row.name:<15}{row.minutes:>8.1f}{row.processor_minutes:>10.1f}{row.outcome.passed:>8}{row.outcome.failed:>8}")
    print(f"{'sum':<15}{sum(r.minutes for r in rows):>8.1f}{sum(r.processor_minutes for r in rows):>10.1f}")
    print(f"{'wall time':<15}{minutes:>8.1f}\n")


if __name__ == "__main__":
    project.end_children_with_us()
    os.chdir(project.ROOT)
    sys.exit(main(sys.argv[1:]))
