# SPDX-License-Identifier: BSD-3-Clause
"""The firmware against a trace measured on ROSflight 2.x (release 2.0.1 and later commits): quadrotor X, arming by
sticks with gyro calibration, angle mode, saturation, disarming. Waivers name the weak points that are different on
purpose (docs/compatibility.md)."""
import gzip
import os
import subprocess
from pathlib import Path

DATA = Path(__file__).parent / "data"
PROGRAM = Path(os.environ.get("ROSFLIGHT_BUILD", Path(__file__).parents[3] / "build" / "release")) / "apps" / "rosflight"


# Override bits begin and end otherwise; disarming reaches the motors in its pass, not in the one after it.
WAIVED = ["rc_override", "out0", "out1", "out2", "out3"]


def replay(trace, *extra):
    return subprocess.run([PROGRAM, "replay", trace, "--params", DATA / "sticks_params.csv", "--compare", *extra],
                          capture_output=True, text=True, timeout=120)


def test_measured_trace_is_reproduced(tmp_path):
    trace = tmp_path / "sticks.csv"
    trace.write_bytes(gzip.decompress((DATA / "sticks.csv.gz").read_bytes()))
    run = replay(trace, "--except", DATA / "sticks_waivers.csv")
    assert run.returncode == 0, run.stdout + run.stderr
    assert "5800 rows, 57 columns: same" in run.stdout
    waived = [line for line in run.stdout.splitlines() if "waived" in line]
    assert [line.split()[0] for line in waived] == WAIVED


def test_without_waivers_the_deliberate_difference_shows(tmp_path):
    trace = tmp_path / "sticks.csv"
    trace.write_bytes(gzip.decompress((DATA / "sticks.csv.gz").read_bytes()))
    run = replay(trace)
    assert run.returncode == 1
    failed = [line.split()[0] for line in run.stdout.splitlines() if "FAILED" in line]
    assert failed == WAIVED
