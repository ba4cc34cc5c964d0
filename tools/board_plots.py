# SPDX-License-Identifier: BSD-3-Clause
"""Draws what tools/board_demo.py has left in a folder: histograms of the round trips and the triangle wave of roll, as PNG.

    .venv-plot/bin/python3 tools/board_plots.py DIR
"""

import json
import sys
from pathlib import Path

import matplotlib
import numpy
import PIL.Image

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

KEPT_COLOURS = 64  # of a picture: it is then a third of the size
COLOURS = ["#0072b2", "#e69f00", "#009e73"]
SHOWN_S = 12.0  # of the wave


def save(figure, file: Path):
    figure.savefig(file, dpi=100)
    pyplot.close(figure)
    with PIL.Image.open(file) as picture:
        small = picture.convert("RGB").quantize(KEPT_COLOURS, dither=PIL.Image.Dither.NONE)
    small.save(file, optimize=True)


def draw_round_trips(folder: Path, board: str, rows: list[dict]):
    figure, axes = pyplot.subplots(figsize=(9, 5.0), layout="constrained")
    trips = [numpy.loadtxt(folder / row["csv"], ndmin=1) / 1000.0 for row in rows]
    last = max(float(each.max()) for each in trips)
    bins = numpy.arange(0.0, last + 0.04, 0.02)
    for each, row, colour in zip(trips, rows, COLOURS):
        axes.hist(each, bins=bins, histtype="stepfilled", alpha=0.35, color=colour)
        label = f"{row['name']}: mean {row['mean_ms']:.3f} ms, max {row['max_ms']:.3f} ms, up to {row['fastest_hz']:.0f} Hz"
        axes.hist(each, bins=bins, histtype="step", color=colour, label=label)
    axes.set(title=f"{board}, emulated: {rows[0]['commands']} offboard commands at 400 Hz and back", xlabel="round trip [ms]",
             ylabel="commands in 0.02 ms", yscale="log", xlim=(0.0, last * 1.03))
    figure.legend(loc="outside lower center")
    axes.grid(alpha=0.3)
    save(figure, folder / f"rtt_{board}.png")


def draw_roll(folder: Path, board: str, rows: list[dict]):
    figure, axes = pyplot.subplots(len(rows), 1, figsize=(9, 3.2 * len(rows)), layout="constrained", sharex=True, squeeze=False)
    for axis, row in zip(axes[:, 0], rows):
        time_s, wanted, true, estimated = numpy.loadtxt(folder / row["csv"], delimiter=",", skiprows=1, unpack=True)
        shown = time_s <= SHOWN_S
        axis.plot(time_s[shown], wanted[shown], color="black", linewidth=1.0, label="setpoint")
        axis.plot(time_s[shown], estimated[shown], color=COLOURS[1], linewidth=1.0, label="the firmware's estimate")
        axis.plot(time_s[shown], true[shown], color=COLOURS[0], label="true")
        corrected = "corrected by the companion" if row["attitude"] == "companion" else "of the firmware's filter alone"
        axis.set(title=f"Attitude {corrected}: error of the true roll {row['roll_rms_deg']:.2f}° rms, of the estimate "
                       f"{row['roll_estimated_rms_deg']:.2f}° rms", ylabel="roll [°]")
        axis.grid(alpha=0.3)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    axes[-1, 0].set_xlabel("time [s]")
    figure.suptitle(f"{board}, emulated: roll in pass-through, {rows[0]['commands_hz']:.0f} commands per second over the UART")
    save(figure, folder / f"passthrough_{board}.png")


def main(folder: Path):
    measured = json.loads((folder / "boards.json").read_text())
    for kind, draw in (("round_trips", draw_round_trips), ("roll", draw_roll)):
        boards = dict.fromkeys(row["board"] for row in measured[kind])
        for board in boards:
            draw(folder, board, [row for row in measured[kind] if row["board"] == board])


if __name__ == "__main__":
    main(Path(sys.argv[1]))
