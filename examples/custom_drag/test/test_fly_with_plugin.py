# SPDX-License-Identifier: BSD-3-Clause
"""The example as a user flies it: library, vehicle file and visualiser by name through ./rosflight's program."""
import json
import os
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[3]
BUILD = Path(os.environ.get("ROSFLIGHT_BUILD", ROOT / "build" / "release"))
PLUGIN = BUILD / "examples" / "custom_drag" / "libcustom_drag.so"


def fly(folder, *arguments):
    return subprocess.run([BUILD / "apps" / "rosflight", "fly", "--json", "--out", folder, *arguments], cwd=ROOT,
                          capture_output=True, text=True, timeout=300)


def test_flies_the_default_mission_under_its_own_law(tmp_path):
    done = fly(tmp_path / "f", "--plugin", PLUGIN, "--vehicle", "examples/custom_drag/linear_drag.yaml",
               "--visualiser", "peak_speed")
    assert done.returncode == 0, done.stderr
    summary = json.loads(done.stdout)
    assert summary["success"] and summary["waypoints_reached"] == summary["waypoints_total"]
    last = done.stderr.strip().splitlines()[-1].split()
    assert last[:2] == ["peak", "speed"] and 1.0 < float(last[2]) < 10.0


def test_without_the_library_one_line_names_the_unknown_type(tmp_path):
    done = fly(tmp_path / "f", "--vehicle", "examples/custom_drag/linear_drag.yaml")
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr.count("\n") == 1 and "found linear_drag, allowed fixedwing, multirotor, quadplane" in done.stderr
