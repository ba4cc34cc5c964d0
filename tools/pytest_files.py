# SPDX-License-Identifier: BSD-3-Clause
"""Runs pytest files, each in a process of its own, and counts their cases."""

import subprocess
import threading
import xml.etree.ElementTree as xml
from collections import deque
from pathlib import Path

from cpp_tests import Outcome
from project import ROOT

# Most of these tests wait for real time to pass: two files at once leave the processors room. Not so whole flights, which
# run as fast as the machine does: one at a time, or they disturb each other's timing.
LANES = 2
ROS_LANES = 3  # their nodes wait for each other too


def run(files: list[Path], python: str, reports: Path, options: list[str] = (), lanes: int = LANES,
        environment=lambda lane: None) -> Outcome:
    """Runs `files`, `lanes` at once; `environment` gives the variables of a lane, None for those of this process."""
    flights = deque(file for file in files if _is_flight(file))
    others = deque(file for file in files if not _is_flight(file))
    outcomes: dict[Path, Outcome] = {}

    def work(lane: int):
        queues = (flights, others) if lane == 0 else (others,)
        while waiting := next(filter(None, queues), None):
            try:
                file = waiting.popleft()
            except IndexError:  # the other lane was faster
                continue
            try:
                outcomes[file] = _run_file(file, python, reports, options, environment(lane))
            except Exception as error:  # must not pass for a file that was never there
                outcomes[file] = Outcome(failed=1, complaints=[f"{file}: {type(error).__name__}: {error}"])

    threads = [threading.Thread(target=work, args=(lane,)) for lane in range(min(lanes, len(files)))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    total = Outcome()
    for file in files:
        total.passed += outcomes[file].passed
        total.failed += outcomes[file].failed
        total.complaints += outcomes[file].complaints
    return total


def _is_flight(file: Path) -> bool:
    """True for whole flights and real-time runs. They come first, so that none of them is left over at the end."""
    return any(word in file.name for word in ("flight", "fixedwing", "square", "follower", "policy", "documented_start", "own_modules", "sil"))


def _run_file(file: Path, python: str, reports: Path, options, environment) -> Outcome:
    report = reports / f"{str(file.with_suffix('')).replace('/', '.')}.xml"
    report.parent.mkdir(parents=True, exist_ok=True)
    report.unlink(missing_ok=True)
    done = subprocess.run(
        [python, "-m", "pytest", "-q", "--tb=short", "--no-header", *options, f"--junitxml={report}", str(file)],
        cwd=ROOT, env=environment, capture_output=True, text=True, errors="replace", stdin=subprocess.DEVNULL)
    return count(report, done)


def count(report: Path, done: subprocess.CompletedProcess) -> Outcome:
    """Cases of a JUnit report that pytest left; skipped ones are named and count as neither."""
    outcome = Outcome()
    try:
        for case in xml.parse(report).getroot().iter("testcase"):
            bad = case.find("failure") is not None or case.find("error") is not None
            outcome.failed += bad
            skipped = case.find("skipped") is not None
            outcome.passed += not bad and not skipped
            outcome.skipped += [f"{case.get('classname')}.{case.get('name')}"] if skipped else []
    except (OSError, xml.ParseError):
        outcome.failed += 1  # without a report nothing is known
    if done.returncode not in (0, 5) and outcome.failed == 0:
        outcome.failed = 1
    if outcome.failed:
        outcome.complaints = (done.stdout + done.stderr).splitlines()[-80:]
    return outcome
