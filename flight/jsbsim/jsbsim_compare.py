# SPDX-License-Identifier: BSD-3-Clause
"""Compares our simulator with JSBSim on a recorded flight of 20 s, both in open loop.

Usage: jsbsim_compare.py [--svg FILE] [VEHICLE...]      (default: anaconda multirotor)

Needs the program open_loop (tools/ready.sh build release open_loop). Prints the largest differences up to 5, 10 and 20 s
beside their bounds; ends with 1 if one is passed. The bound is the grid convergence index: from the change that halving
the steps makes in each program, with order 1 and a factor of safety of 1.25 (P. Roache, J. Fluids Eng. 116, 1994).
"""

import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import jsbsim_model
import jsbsim_plot
from jsbsim_body import FLAT_RADIUS_M, FT
from jsbsim_run import HOLD_S, Track, jsbsim_track, our_track

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = ROOT / os.environ.get("ROSFLIGHT_BUILD", "build/release") / "flight" / "open_loop"
SECONDS = 20
SAFETY = 1.25
TIMES_S = (5, 10, 20)
# What both sides can be: no ground effect, the same air everywhere.
COMMON = ("environment.atmosphere.model=constant", "environment.atmosphere.density_kg_m3=1.07")
OVERRIDES = {"multirotor": (*COMMON, "aero.ground_effect=none"), "fixedwing": COMMON}
# JSBSim's frames in 2.5 ms, coarse and fine. A multirotor in open loop magnifies an error e-fold in little more than a
# second, so it needs more of them.
FRAMES = {"multirotor": (32, 64), "fixedwing": (8, 16)}
OUR_STEPS = (2, 4)


@dataclass
class Comparison:
    name: str
    ours: Track
    theirs: Track
    difference: dict  # quantity: array over time
    bound: dict

    def rows(self):
        """quantity, time [s], largest difference until then, its bound."""
        for quantity, difference in self.difference.items():
            for t in TIMES_S:
                end = round(t / HOLD_S) + 1
                yield quantity, t, float(difference[:end].max()), float(self.bound[quantity][:end].max())

    def passes(self) -> bool:
        return all(difference <= bound for _, _, difference, bound in self.rows())


def vehicle_of(path: Path, overrides) -> dict:
    vehicle = jsbsim_model.load(path)
    for assignment in overrides:
        jsbsim_model.override(vehicle, assignment)
    return vehicle


def compare(name: str, folder: Path, change=lambda vehicle: None) -> Comparison:
    """`change` may spoil the vehicle that JSBSim gets."""
    path = ROOT / "vehicles" / f"{name}.yaml"
    kind = jsbsim_model.load(path)["type"]
    overrides = OVERRIDES[kind]
    subprocess.run([PROGRAM, "record", path, folder, str(SECONDS), *overrides], check=True, cwd=ROOT)
    vehicle = vehicle_of(path, overrides)
    change(vehicle)
    model = jsbsim_model.build(vehicle)
    ours = [our_track(PROGRAM, path, folder, parts, overrides) for parts in OUR_STEPS]
    theirs = [jsbsim_track(model, folder, parts) for parts in FRAMES[kind]]
    own, foreign = ours[0].away_from(ours[1]), theirs[0].away_from(theirs[1])
    # The largest so far: an error does not go away because two curves cross.
    bound = {q: SAFETY * np.maximum.accumulate(own[q] + foreign[q]) for q in own}
    bound["position_m"] = bound["position_m"] + rounding_m(len(bound["position_m"]), FRAMES[kind][-1])
    return Comparison(name, ours[1], theirs[1], ours[1].away_from(theirs[1]), bound)


def rounding_m(samples: int, frames: int) -> np.ndarray:
    """What rounding adds to a position of JSBSim, which keeps it in feet from the planet's centre, three standard
    deviations: uniform errors within half a unit of the last place. Within one sample the increments change by less
    than a unit from frame to frame, so their errors add up; those of different samples are a random walk. Seen: at the
    end of 10 s a multirotor moves by 1.5e-4 m from 32 to 64 frames, and by 3.8e-4 m from 64 to 128."""
    unit_m = np.spacing(FLAT_RADIUS_M / FT) * FT
    return 3.0 * unit_m / np.sqrt(12.0) * frames * np.sqrt(np.arange(samples))


def table(comparison: Comparison) -> str:
    lines = [f"{comparison.name}: largest difference from JSBSim, and its bound from halved steps"]
    for quantity, t, difference, bound in comparison.rows():
        lines.append(f"  {quantity:<14}{t:>4} s  {difference:>10.2e}  {bound:>10.2e}"
                     + ("" if difference <= bound else "  beyond"))
    return "\n".join(lines)


def main(words) -> int:
    svg = None
    if words[:1] == ["--svg"]:
        svg, words = words[1], words[2:]
    if any(word.startswith("-") for word in words):
        print(__doc__, file=sys.stderr)
        return 2
    comparisons = []
    for name in words or ["anaconda", "multirotor"]:
        with tempfile.TemporaryDirectory() as folder:
            comparisons.append(compare(name, Path(folder)))
        print(table(comparisons[-1]))
    if svg:
        Path(svg).write_text(jsbsim_plot.svg(comparisons))
    return 0 if all(c.passes() for c in comparisons) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
