# SPDX-License-Identifier: BSD-3-Clause
"""Figures of the page: its size, how fast it opens logs, seeks and follows what runs, and what a viewer costs its server. Measured in
the headless browser of its tests.

Times are of the wall clock, with WebGL in software: compare them only with web.load, the load of the machine, beside them.
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
# Name, unit, target. web.frame_ms is the frame period, which web.latency_ms does not contain.
FIGURES = (("first_picture_s", "s", "<= 2"), ("open_100MB_s", "s", "<= 3"), ("seek_ms", "ms", "<= 50"), ("latency_ms", "ms", "<= 25"),
           ("frame_ms", "ms", "report"), ("server_core_share", "x", "<= 0.02"), ("load", "processes", "report"))
# Its full log has about 100 MB.
LONG_MISSION = """\
takeoff_height_m: 4
at_end: land
mission:
  - {type: hold, w: [0, 0, -10], speed: 3, heading_deg: 0, hold_seconds: 330}
"""


def bundle_kb() -> float:
    """Everything that a browser loads before a flight, compressed."""
    _make("run")
    return sum(len(gzip.compress((PAGE / name).read_bytes(), 9)) for name in ("index.html", "page.js", "page.css")) / 1000


@functools.cache
def measured() -> dict[str, float]:
    """All of FIGURES."""
    _make("test")
    project.build("release", "rosflight", "rosflight_tools", "rosflight_view")
    with tempfile.TemporaryDirectory(prefix="rosflight_bench_web_") as scratch:
        mission = Path(scratch) / "long.yaml"
        mission.write_text(LONG_MISSION)
        short = _fly(Path(scratch) / "short", "--mission", "hop")
        long = _fly(Path(scratch) / "long", "--log", "full", "--mission", str(mission))
        load = os.getloadavg()[0]
        return {**_node("figures.ts", PROGRAMS / "rosflight_view", short, long),
                **_node("live_figures.ts", PROGRAMS / "rosflight_view", PROGRAMS / "rosflight_tools"), "load": load}


def _node(script: str, *arguments: Path) -> dict[str, float]:
    environment = {**os.environ, "PATH": f"{ROOT}/.venv-web/bin:{os.environ['PATH']}"}
    run = subprocess.run(["node", f"bench/{script}", *arguments], cwd=ROOT / "web", env=environment, capture_output=True, text=True)
    if run.returncode:
        raise RuntimeError(run.stderr.strip() or "the page cannot be measured")
    return json.loads(run.stdout.splitlines()[-1])


def _make(what: str):
    made = subprocess.run(["bash", str(ROOT / "tools/ready.sh"), "web", what], capture_output=True, text=True)
    if made.returncode:
        raise RuntimeError(made.stderr.strip().splitlines()[-1])


def _fly(folder: Path, *options: str) -> Path:
    subprocess.run([PROGRAMS / "rosflight", "fly", "--out", folder, *options], check=True, capture_output=True)
    return folder
