# SPDX-License-Identifier: BSD-3-Clause
"""Figures of the page: its size, and how fast it opens logs and seeks, in the headless browser of its tests.

Times are of the wall clock, with WebGL in software: compare them only with the load of the machine beside them.
"""

import functools
import gzip
import json
import os
import subprocess
import tempfile
from pathlib import Path

import project
from project import ROOT

PAGE = ROOT / "build/web"
PROGRAMS = ROOT / "build/release/apps"
# Its full log has about 100 MB.
LONG_MISSION = """\
takeoff_height_m: 4
at_end: land
mission:
  - {type: hold, w: [0, 0, -10], speed: 3, heading_deg: 0, hold_seconds: 380}
"""


def bundle_kb() -> float:
    """Everything that a browser loads before a flight, compressed."""
    _make("run")
    return sum(len(gzip.compress((PAGE / name).read_bytes(), 9)) for name in ("index.html", "page.js", "page.css")) / 1000


@functools.cache
def measured() -> dict[str, float]:
    _make("test")
    project.build("release", "rosflight", "rosflight_view")
    with tempfile.TemporaryDirectory(prefix="rosflight_bench_web_") as scratch:
        mission = Path(scratch) / "long.yaml"
        mission.write_text(LONG_MISSION)
        short = _fly(Path(scratch) / "short", "--mission", "hop")
        long = _fly(Path(scratch) / "long", "--log", "full", "--mission", str(mission))
        load = os.getloadavg()[0]
        environment = {**os.environ, "PATH": f"{ROOT}/.venv-web/bin:{os.environ['PATH']}"}
        run = subprocess.run(["node", "bench/figures.ts", PROGRAMS / "rosflight_view", short, long], cwd=ROOT / "web",
                             env=environment, capture_output=True, text=True)
    if run.returncode:
        raise RuntimeError(run.stderr.strip().splitlines()[-1] if run.stderr.strip() else "the page cannot be measured")
    return {**json.loads(run.stdout), "load": load}


def _make(what: str):
    made = subprocess.run(["bash", str(ROOT / "tools/ready.sh"), "web", what], capture_output=True, text=True)
    if made.returncode:
        raise RuntimeError(made.stderr.strip().splitlines()[-1])


def _fly(folder: Path, *options: str) -> Path:
    subprocess.run([PROGRAMS / "rosflight", "fly", "--out", folder, *options], check=True, capture_output=True)
    return folder
