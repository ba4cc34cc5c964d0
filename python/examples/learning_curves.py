# SPDX-License-Identifier: BSD-3-Clause
"""Draws the learning curves that ppo.py --csv has left: the share of episodes that succeed, over the steps of all vehicles.

    learning_curves.py FOLDER [FILE.png]

FOLDER has files TASK_SEED.csv; each task is a picture, each seed a curve. Episodes are those that ended while the policy made five
percent of its steps, with the noise of exploration. Without FILE.png the picture is learning_curves.png.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7")
WINDOW = 5  #: Lines, of one percent each.


def draw(files: list[Path], out: Path) -> None:
    tasks = sorted({file.stem.rsplit("_", 1)[0] for file in files}, reverse=True)
    figure, axes = pyplot.subplots(1, len(tasks), figsize=(4.6 * len(tasks), 3.4), layout="constrained", squeeze=False, sharey=True)
    for axis, task in zip(axes[0], tasks):
        for file, colour in zip(sorted(file for file in files if file.stem.rsplit("_", 1)[0] == task), COLOURS):
            rows = np.genfromtxt(file, delimiter=",", names=True)
            window = np.ones(WINDOW)
            episodes = np.convolve(rows["episodes"], window)[: len(rows)]
            successes = np.convolve(rows["successes"], window)[: len(rows)]
            seconds = rows["processor_s"][-1]
            axis.plot(rows["steps"] / 1e6, 100 * successes / np.maximum(episodes, 1), color=colour,
                      label=f"seed {file.stem.rsplit('_', 1)[1]}: {seconds:.0f} s of one processor")
        axis.set(title=task.capitalize(), xlabel="million steps", ylim=(0, 102))
        axis.grid(alpha=0.3)
        axis.legend(loc="lower right")
    axes[0, 0].set_ylabel("episodes that succeed [%]")
    figure.savefig(out, dpi=100)


def main(arguments: list[str]) -> int:
    files = sorted(Path(arguments[0]).glob("*_*.csv")) if arguments else []
    if not files or len(arguments) > 2:
        print(f"FOLDER: found {' '.join(arguments) or 'nothing'}, allowed a folder with files TASK_SEED.csv of ppo.py --csv", file=sys.stderr)
        return 2
    out = Path(arguments[1] if len(arguments) == 2 else "learning_curves.png")
    draw(files, out)
    print(f"{len(files)} curves in {out}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
