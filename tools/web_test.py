# SPDX-License-Identifier: BSD-3-Clause
"""The tests of web/: types, the reader of logs, and the page in a headless browser on flights made for it."""

import os
import re
import subprocess
import tempfile
from pathlib import Path

import project
from cpp_tests import Outcome
from project import ROOT

PAGE = ROOT / "build/web"
PROGRAMS = ROOT / "build/release/apps"
FLIGHTS = {"MULTIROTOR": [], "FIXED_WING": ["--vehicle", "anaconda", "--mission", "circuit"]}


def run(files: str = "test/*.test.ts", **variables: str) -> Outcome:
    """Each test counts, and the check of the types as one. ROSFLIGHT_WEB_LONG=1: those that take minutes too."""
    made = subprocess.run(["bash", str(ROOT / "tools/ready.sh"), "web", "test"], stdout=subprocess.DEVNULL)
    venv = subprocess.run(["bash", str(ROOT / "tools/ready.sh"), "venv"], stdout=subprocess.DEVNULL)
    programs = ["rosflight", "rosflight_tools", "rosflight_view", "rosflight_mavlink_python"]
    if made.returncode or venv.returncode or not project.build("release", *programs):
        return Outcome(failed=1, complaints=["the page or the programs cannot be built"])
    types = _node("npx", "--no-install", "tsc", "-p", ".")
    checked = Outcome(int(types.returncode == 0), int(types.returncode != 0), types.stdout.splitlines() if types.returncode else [])
    with tempfile.TemporaryDirectory(prefix="rosflight_web_") as folder:
        flights = {f"ROSFLIGHT_WEB_{name}": str(_fly(Path(folder) / name, options)) for name, options in FLIGHTS.items()}
        tests = _node("node", "--test", "--test-reporter=tap", "--test-concurrency=2", files, **flights, **variables)
    print("".join(f"   {line[2:]}\n" for line in tests.stdout.splitlines() if line.startswith("# web.")), end="")
    print("".join(f"   skipped: {line}\n" for line in _skipped(tests.stdout)), end="")
    counts = {name: int(number) for name, number in re.findall(r"^# (pass|fail|cancelled) (\d+)$", tests.stdout, re.M)}
    failed = counts.get("fail", 0) + counts.get("cancelled", 0)
    complaints = [] if tests.returncode == 0 and failed == 0 and counts.get("pass") else _complaints(tests.stdout + tests.stderr)
    if complaints and failed == 0:
        failed = 1  # it broke off
    return Outcome(checked.passed + counts.get("pass", 0), checked.failed + failed, checked.complaints + complaints)


def _node(*command: str, **variables: str) -> subprocess.CompletedProcess:
    environment = {**os.environ, **variables, "PATH": f"{ROOT}/.venv-web/bin:{os.environ['PATH']}",
                   "ROSFLIGHT_WEB_PAGE": str(PAGE), "ROSFLIGHT_WEB_VIEW": str(PROGRAMS / "rosflight_view"),
                   "ROSFLIGHT_WEB_FLY": str(PROGRAMS / "rosflight"), "ROSFLIGHT_WEB_SIL": str(PROGRAMS / "rosflight_tools"),
                   "ROSFLIGHT_WEB_PYTHON": str(ROOT / ".venv/bin/python")}
    return subprocess.run(command, cwd=ROOT / "web", env=environment, capture_output=True, text=True)


def _fly(folder: Path, options: list[str]) -> Path:
    subprocess.run([PROGRAMS / "rosflight", "fly", "--out", folder, *options], capture_output=True)
    return folder


def _skipped(said: str) -> list[str]:
    """The names of tests that were left out, each with its reason."""
    return [f"{name} ({why.strip()})" for name, why in re.findall(r"^ *ok \d+ - (.*?) # SKIP(.*)$", said, re.M)]


def _complaints(said: str) -> list[str]:
    """The names of failed tests, each with what it said."""
    blocks = re.split(r"^(?=\s*(?:not )?ok \d+ - )", said, flags=re.M)
    failed = [block for block in blocks if re.match(r"\s*not ok", block) and "subtestsFailed" not in block]
    return [line for block in failed for line in block.splitlines()[:14]] or said.splitlines()[-20:]
