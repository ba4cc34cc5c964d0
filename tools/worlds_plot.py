# SPDX-License-Identifier: BSD-3-Clause
"""Draws how far flights with different physics engines are from that with our integrator, from what ./rosflight bench worlds left.

    .venv-plot/bin/python3 tools/worlds_plot.py FILE.png
"""

import sys
from pathlib import Path

import bench_worlds
from board_plots import COLOURS, pyplot, save

SHOWN = [("multirotor", "default", ""), ("anaconda", "default", ""), ("quadplane", "default", "")]


def main(file: Path):
    figure, axes = pyplot.subplots(len(SHOWN), 1, figsize=(9, 2.8 * len(SHOWN)), layout="constrained")
    for axis, flight in zip(axes, SHOWN):
        for engine, colour in zip(bench_worlds.ENGINES, COLOURS):
            time_s, distance_m = zip(*bench_worlds.distances(engine, *flight))
            axis.plot(time_s, [1000.0 * each for each in distance_m], color=colour, linewidth=1.0, label=engine)
        axis.set(title=f"{flight[0]}, mission {flight[1]}", ylabel="distance [mm]", xlim=(0.0, time_s[-1]))
        axis.set_ylim(bottom=0.0)
        axis.grid(alpha=0.3)
    axes[-1].set_xlabel("time [s]")
    figure.suptitle("Distance of the true positions from those of our integrator")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=len(bench_worlds.ENGINES))
    save(figure, file)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
