# SPDX-License-Identifier: BSD-3-Clause
"""Runs the stages of ./rosflight test, each in a process of its own, several lanes at once.

The stages of one lane run one after the other. A stage beside others prints nothing until it ends: then all of its output comes
in one piece. One that crashes, exits or leaves no count is a failure of that stage; the others still run.
"""

import json
import os
import resource
import sys
import tempfile
import time
import traceback
from collections import deque
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Callable

from cpp_tests import Outcome

ALONE, WAITS, COMPUTES = "alone", "waits", "computes"


@dataclass(frozen=True)
class Stage:
    """ALONE: before all others, with the machine for itself. WAITS: mostly for time to pass, with normal priority.
    COMPUTES: takes what the others leave of the processors, so that it disturbs no timing."""

    run: Callable[[], Outcome]
    lane: str = ALONE


@dataclass
class Row:
    name: str
    minutes: float
    processor_minutes: float
    outcome: Outcome


@dataclass
class _Running:
    name: str
    lane: str
    start: float
    folder: tempfile.TemporaryDirectory

    def file(self, name: str) -> Path:
        return Path(self.folder.name) / name


def run(stages: list[tuple[str, Stage]]) -> tuple[list[Row], float]:
    """What each stage found, in the order in which they ended, and the minutes it took."""
    start = time.monotonic()
    rows = []
    for name, stage in stages:
        if stage.lane == ALONE:
            rows += _run_lanes({ALONE: deque([(name, stage)])})
    lanes: dict[str, deque] = {}
    for name, stage in stages:
        if stage.lane != ALONE:
            lanes.setdefault(stage.lane, deque()).append((name, stage))
    rows += _run_lanes(lanes)
    return rows, (time.monotonic() - start) / 60


def _run_lanes(lanes: dict[str, deque]) -> list[Row]:
    beside_others = len(lanes) > 1
    running: dict[int, _Running] = {}
    rows = []
    while running or any(lanes.values()):
        busy = {one.lane for one in running.values()}
        for lane, waiting in lanes.items():
            if lane not in busy and waiting:
                pid, started = _start(*waiting.popleft(), beside_others)
                running[pid] = started
        pid, status, used = os.wait4(-1, 0)
        if pid in running:
            rows.append(_finish(running.pop(pid), status, used))
    return rows


def _start(name: str, stage: Stage, beside_others: bool) -> tuple[int, _Running]:
    started = _Running(name, stage.lane, time.monotonic(), tempfile.TemporaryDirectory(prefix="rosflight_stage_"))
    print(f"-- {name} starts" if beside_others else f"== {name}", flush=True)
    sys.stderr.flush()
    pid = os.fork()
    if pid == 0:
        _be_stage(started, stage, beside_others)
    return pid, started


def _be_stage(here: _Running, stage: Stage, beside_others: bool):
    """The process of one stage, from the fork to its end."""
    code = 1
    try:
        if beside_others:
            said = os.open(here.file("said"), os.O_WRONLY | os.O_CREAT | os.O_APPEND)
            os.dup2(said, 1)
            os.dup2(said, 2)
            if stage.lane == COMPUTES:
                os.nice(19)
        sys.stdout = os.fdopen(os.dup(1), "w", buffering=1)
        sys.stderr = os.fdopen(os.dup(2), "w", buffering=1)
        outcome = _outcome_of(stage.run)
        here.file("outcome").write_text(json.dumps(asdict(outcome)))
        sys.stdout.flush()
        code = 0
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(code)


def _outcome_of(function: Callable[[], Outcome]) -> Outcome:
    try:
        return function()
    except Exception as error:
        return Outcome(failed=1, complaints=[f"{type(error).__name__}: {error}"])


def _finish(ended: _Running, status: int, used: resource.struct_rusage) -> Row:
    minutes = (time.monotonic() - ended.start) / 60
    processor_minutes = (used.ru_utime + used.ru_stime) / 60
    try:
        outcome = Outcome(**json.loads(ended.file("outcome").read_text()))
    except (OSError, ValueError, TypeError):
        outcome = Outcome(failed=1, complaints=[f"broke off with {os.waitstatus_to_exitcode(status)}, nothing counted"])
    if ended.file("said").exists():
        print(f"== {ended.name}")
        print(ended.file("said").read_text(errors="replace"), end="")
    ended.folder.cleanup()
    for line in [*outcome.complaints, *(f"skipped: {name}" for name in outcome.skipped)]:
        print(f"   {line}")
    print(f"   {outcome.passed} passed, {outcome.failed} failed, {minutes:.1f} min", flush=True)
    return Row(ended.name, minutes, processor_minutes, outcome)
