# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the package share."""

import json
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def command(tmp_path):
    """Flies by `./rosflight fly` and returns its summary."""
    def fly(*arguments: str) -> dict:
        done = subprocess.run([ROOT / "build/release/apps/rosflight", "fly", "--json", "--out", tmp_path / "by_command", *arguments],
                              capture_output=True, text=True)
        assert done.stdout, done.stderr
        return json.loads(done.stdout)

    return fly
