# SPDX-License-Identifier: BSD-3-Clause
"""The stage python-package: the wheel as pip builds it, installed and tested. Its pytest files run in .venv-python."""

import re
import subprocess
from pathlib import Path

import project
import pytest_files
from cpp_tests import Outcome
from project import ROOT

PYTHON = ROOT / ".venv-python/bin/python3"
FOLDER = Path("python/test")
# The package as it is installed, with the stubs of its extension module, as the oldest and the newest Python that it declares see it, and
# the examples that use it.
TYPED = (["--python-version", "3.10", "-p", "rosflight"], ["--python-version", "3.13", "-p", "rosflight"], ["python/examples"])


def needs_package(path: Path) -> bool:
    return path.is_relative_to(FOLDER)


def files() -> list[Path]:
    """All pytest files of the package, from the root."""
    return [path for path in project.own_files() if needs_package(path) and re.fullmatch(r"test_\w+\.py", path.name)]


def run(names: list[str] = ()) -> Outcome:
    """@param names  parts of the names of files; none: all, and the types."""
    if subprocess.run(["bash", str(ROOT / "tools/ready.sh"), "python"]).returncode:
        return Outcome(failed=1, complaints=["the package cannot be built, all output is in build/.ready/python.log"])
    if not project.build("release", "apps/rosflight"):
        return Outcome(failed=1, complaints=["the program that it is compared with does not build"])
    chosen = [path for path in files() if not names or any(name in str(path) for name in names)]
    outcome = pytest_files.run(chosen, str(PYTHON), ROOT / "build/test_results/python-package", lanes=1)
    for what in TYPED if not names else ():
        _count(outcome, [str(PYTHON), "-m", "mypy", "--no-error-summary", *what])
    return outcome


def _count(outcome: Outcome, command: list[str]):
    """Adds a check that is a command."""
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    outcome.passed += done.returncode == 0
    outcome.failed += done.returncode != 0
    if done.returncode:
        outcome.complaints += (done.stdout + done.stderr).splitlines()
