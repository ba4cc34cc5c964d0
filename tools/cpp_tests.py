# SPDX-License-Identifier: BSD-3-Clause
"""Finds and runs the C++ tests of one build and counts their cases."""

import concurrent.futures
import json
import os
import subprocess
import xml.etree.ElementTree as xml
from dataclasses import dataclass, field
from pathlib import Path

import project

SANITIZER_OPTIONS = {"UBSAN_OPTIONS": "print_stacktrace=1"}


@dataclass
class Binary:
    name: str
    command: list[str]  # empty while it is not built: CTest does not tell it then
    folder: str = str(project.ROOT)
    timeout_s: float = 300
    counts_cases: bool = False
    needs_emulator: bool = False
    part: str = ""  # the folder at the root that it tests, of programs that we build


@dataclass
class Outcome:
    passed: int = 0
    failed: int = 0
    complaints: list[str] = field(default_factory=list)
    skipped: list[str] = field(default_factory=list)  # names of cases that did not run


def find(preset: str) -> list[Binary]:
    """The tests CTest knows of in build/PRESET, which must be configured but need not be built."""
    build = project.ROOT / "build" / preset
    shown = subprocess.run(["ctest", "--test-dir", str(build), "--show-only=json-v1"],
                           capture_output=True, text=True)
    if shown.returncode != 0:
        raise RuntimeError(f"ctest cannot list the tests of {build}: {shown.stderr.strip()}")
    return [_binary(test) for test in json.loads(shown.stdout)["tests"]]


def _binary(test: dict) -> Binary:
    properties = {entry["name"]: entry["value"] for entry in test.get("properties", [])}
    labels = properties.get("LABELS", [])
    return Binary(
        name=test["name"],
        command=test.get("command", []),
        folder=properties.get("WORKING_DIRECTORY", str(project.ROOT)),
        timeout_s=float(properties.get("TIMEOUT", 300)),
        counts_cases="gtest" in labels,
        needs_emulator="emulator" in labels,
        part=next((label.removeprefix("of ") for label in labels if label.startswith("of ")), ""),
    )


def run(binary: Binary, results: Path) -> Outcome:
    """Runs one binary; its output goes to results/NAME.log."""
    results.mkdir(parents=True, exist_ok=True)
    report, log = results / f"{binary.name}.xml", results / f"{binary.name}.log"
    report.unlink(missing_ok=True)
    command = list(binary.command)
    if binary.counts_cases:
        command.append(f"--gtest_output=xml:{report}")
    try:
        with log.open("wb") as output:
            code = subprocess.run(
                command, cwd=binary.folder, stdout=output, stderr=subprocess.STDOUT,
                stdin=subprocess.DEVNULL, env={**SANITIZER_OPTIONS, **os.environ},
                timeout=binary.timeout_s).returncode
        ending = f"ended with {code}"
    except subprocess.TimeoutExpired:
        code, ending = 1, f"did not end within {binary.timeout_s:g} s"
    except OSError as error:
        code, ending = 1, f"cannot be started: {error}"
    outcome = _count(report) if binary.counts_cases else Outcome(passed=int(code == 0))
    if outcome.failed == 0 and code != 0:  # crashed, hung, or failed outside a case
        outcome.failed = 1
        outcome.complaints = [ending]
    if outcome.passed + outcome.failed == 0:
        outcome.failed = 1
        outcome.complaints = ["holds no test case"]
    if outcome.failed:
        outcome.complaints = [f"{binary.name}: {line}" for line in outcome.complaints]
        outcome.complaints += ["    " + line for line in tail(log)]
    return outcome


def _count(report: Path) -> Outcome:
    """Cases of a GoogleTest report; skipped ones are named, they and disabled ones count as neither."""
    try:
        cases = xml.parse(report).getroot().iter("testcase")
    except (OSError, xml.ParseError):
        return Outcome(complaints=["left no report"])
    outcome = Outcome()
    for case in cases:
        if case.find("failure") is not None:
            outcome.failed += 1
            outcome.complaints.append(f"{case.get('classname')}.{case.get('name')} failed")
        elif case.get("status") == "run" and case.find("skipped") is None:
            outcome.passed += 1
        elif case.find("skipped") is not None:
            outcome.skipped.append(f"{case.get('classname')}.{case.get('name')}")
    return outcome


def tail(log: Path, lines: int = 25) -> list[str]:
    return log.read_text(errors="replace").splitlines()[-lines:]


def run_all(binaries: list[Binary], results: Path) -> dict[str, Outcome]:
    """Runs all, as many at once as there are processors; the answer is in the order given."""
    with concurrent.futures.ThreadPoolExecutor(project.jobs()) as pool:
        outcomes = pool.map(lambda binary: run(binary, results), binaries)
        return {binary.name: outcome for binary, outcome in zip(binaries, outcomes)}
