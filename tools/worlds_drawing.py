# SPDX-License-Identifier: BSD-3-Clause
"""Draws the facts of one world, which tools/worlds_pictures.py has collected, to scale.

    .venv-plot/bin/python3 tools/worlds_drawing.py FACTS.json FILE.png
"""

import json
import sys
from pathlib import Path

import numpy
from board_plots import COLOURS, pyplot
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke

GROUND, SILHOUETTE = "#eef2e6", "#b9b3a8"
HEIGHTS = "YlOrBr"  # of surfaces above z = 0
NOTHING = "#d7e3f4"  # a pixel without anything in reach
MARGIN_M = 8.0
WIDE_M = 20.0  # a shape of this width has its name inside
LEVEL_M = 0.2  # what is lower is level ground: the noise of a beam
MET, MET_GROUND, MOMENT = "#6a3d9a", "#8fa37a", "#d62728"
EAST, NORTH, UP = 0, 1, 2


def solids(facts: dict) -> list[tuple[str, numpy.ndarray]]:
    """Name and triangles, n x 3 x 3, of each shape that has an end."""
    return [(shape["name"], numpy.array(shape["vertices_m"])[numpy.array(shape["triangles"])])
            for shape in facts["shapes"] if shape["triangles"]]


def extent(facts: dict) -> tuple[numpy.ndarray, numpy.ndarray]:
    """Of all that is drawn, with a margin."""
    points = [numpy.array(path["points_m"]) for path in facts["paths"]] + [corners.reshape(-1, 3) for _, corners in solids(facts)]
    every = numpy.concatenate(points)
    return every.min(axis=0) - MARGIN_M, every.max(axis=0) + MARGIN_M


def highest_m(facts: dict) -> float:
    return max([float(corners[:, :, UP].max()) for _, corners in solids(facts)], default=0.0)


def draw_above(axis, facts: dict):
    """The world from above: ground, and surfaces by their height."""
    axis.set_facecolor(GROUND)
    shades = None
    for name, corners in sorted(solids(facts), key=lambda solid: solid[1][:, :, UP].max()):
        flat = corners[numpy.abs(area_from_above(corners)) > 1e-9]
        flat = flat[flat[:, :, UP].mean(axis=1).argsort()]
        points = flat.reshape(-1, 3)
        shades = axis.tripcolor(points[:, EAST], points[:, NORTH], numpy.arange(len(points)).reshape(-1, 3), points[:, UP],
                                shading="gouraud", cmap=HEIGHTS, vmin=0.0, vmax=highest_m(facts), zorder=1)
        low, high = points.min(axis=0), points.max(axis=0)
        wide = high[NORTH] - low[NORTH] > WIDE_M
        label(axis, name, corners, 0.5 * (low[EAST] + high[EAST]), 0.5 * (low[NORTH] + high[NORTH]) if wide else high[NORTH])
    set_axes(axis, facts, EAST, NORTH, "east [m]", "north [m]")
    return shades


def area_from_above(corners: numpy.ndarray) -> numpy.ndarray:
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return one[:, EAST] * two[:, NORTH] - one[:, NORTH] * two[:, EAST]


def draw_from_east(axis, facts: dict):
    """Silhouettes and ground, looking west: north is to the right."""
    for name, corners in solids(facts):
        axis.add_collection(PolyCollection(corners[:, :, [NORTH, UP]], facecolor=SILHOUETTE, edgecolor=SILHOUETTE, linewidth=0.3, zorder=1))
        label(axis, name, corners, corners[:, :, NORTH].mean(), corners[:, :, UP].max())
    axis.axhspan(-MARGIN_M, 0.0, color=GROUND, zorder=0)
    axis.axhline(0.0, color="grey", linewidth=0.8, zorder=1)
    set_axes(axis, facts, NORTH, UP, "north [m]", "up [m]")
    axis.set_ylim(bottom=-2.0)


def label(axis, name: str, corners: numpy.ndarray, x: float, y: float):
    axis.annotate(f"{name}, {corners[:, :, UP].max():g} m", (x, y), (0, 3), textcoords="offset points", ha="center", va="bottom",
                  fontsize=9, zorder=7, path_effects=[withStroke(linewidth=3, foreground="white")])


def set_axes(axis, facts: dict, across: int, along: int, x: str, y: str):
    low, high = extent(facts)
    axis.set(xlabel=x, ylabel=y, xlim=(low[across], high[across]), ylim=(low[along], high[along]), aspect="equal")
    axis.grid(alpha=0.25)


def draw_paths(axis, facts: dict, across: int, along: int):
    """Paths that were flown, their start, and where the world was touched."""
    for path, colour in zip(facts["paths"], COLOURS):
        points = numpy.array(path["points_m"])
        axis.plot(points[:, across], points[:, along], color=colour, linewidth=1.5, zorder=4)
        axis.plot(*points[0, [across, along]], "o", color=colour, markersize=5, zorder=5)
        for mark in path["marks"]:
            axis.plot(mark["point_m"][across], mark["point_m"][along], linestyle="none", zorder=6, **marker(mark))


def marker(mark: dict) -> dict:
    if mark["crash"]:
        return {"marker": "X", "markerfacecolor": MOMENT, "markeredgecolor": "white", "markersize": 11}
    return {"marker": "v", "markerfacecolor": "none", "markeredgecolor": "black", "markeredgewidth": 1.3, "markersize": 11}


def path_legend(facts: dict) -> list:
    handles = [Line2D([], [], color=colour, linewidth=1.5, marker="o", markersize=5, label=f"{path['label']}, from its start")
               for path, colour in zip(facts["paths"], COLOURS)]
    for path in facts["paths"]:
        for mark in path["marks"]:
            handles.append(Line2D([], [], linestyle="none", label=f"{path['label']}: {mark['text']}", **marker(mark)))
    return handles


def draw_world(facts: dict):
    """From above and from the east."""
    low, high = extent(facts)
    size = high - low
    figure, (above, east) = pyplot.subplots(2, 1, figsize=(9, 11), layout="constrained",
                                            height_ratios=[size[NORTH], max(size[UP], 0.25 * size[NORTH])])
    shades = draw_above(above, facts)
    draw_paths(above, facts, EAST, NORTH)
    above.set_title("from above")
    if shades is not None:
        figure.colorbar(shades, ax=above, label="height of the surface above z = 0 [m]", shrink=0.8)
    draw_from_east(east, facts)
    draw_paths(east, facts, NORTH, UP)
    east.set_title("from the east")
    figure.suptitle(facts["title"])
    figure.legend(handles=[*path_legend(facts), Patch(facecolor=GROUND, edgecolor="grey", label="level ground, z = 0")],
                  loc="outside lower center", ncols=1)
    return figure


def draw_sensors(facts: dict):
    """What the lidar has met, over the world from above, and the depth picture of one moment."""
    low, high = extent(facts)
    tall = high[NORTH] - low[NORTH] > high[EAST] - low[EAST]
    figure, (above, picture) = pyplot.subplots(1, 2, figsize=(13, 7.6 if tall else 6.0), layout="constrained", width_ratios=[1.0, 1.15])
    draw_above(above, facts)
    draw_paths(above, facts, EAST, NORTH)
    every, scan, sensor = numpy.array(facts["scans_m"]), numpy.array(facts["scan_m"]), facts["sensor_m"]
    level = every[:, UP] < LEVEL_M
    for points, colour in ((every[level], MET_GROUND), (every[~level], MET)):
        above.plot(points[:, EAST], points[:, NORTH], ".", color=colour, markersize=1.5, zorder=2)
    above.plot(scan[:, EAST], scan[:, NORTH], ".", color=MOMENT, markersize=5, zorder=5)
    above.plot(sensor[EAST], sensor[NORTH], "^", color=MOMENT, markeredgecolor="white", markersize=10, zorder=6)
    above.set_title("lidar, from above")
    depths = numpy.array(facts["depths_m"], dtype=float)
    colours = pyplot.get_cmap("viridis").with_extremes(bad=NOTHING)
    shades = picture.imshow(depths, cmap=colours, vmin=0.0, vmax=numpy.nanmax(depths), interpolation="nearest")
    picture.set(title=f"depth camera at {facts['at_s']:.1f} s", xlabel="column [px]", ylabel="row [px]")
    figure.colorbar(shades, ax=picture, label="depth along the axis of the camera [m]", shrink=0.7)
    figure.suptitle(facts["title"])
    dot = {"linestyle": "none", "marker": ".", "markersize": 9}
    handles = [
        *path_legend(facts), Line2D([], [], linestyle="none", marker="^", color=MOMENT, markersize=8, label=f"the vehicle at {facts['at_s']:.1f} s"),
        Line2D([], [], color=MOMENT, label=f"lidar at {facts['at_s']:.1f} s: where beams ended", **dot),
        Line2D([], [], color=MET, label=f"lidar, whole time in the air: where beams ended above {LEVEL_M} m", **dot),
        Line2D([], [], color=MET_GROUND, label="lidar, whole time in the air: where beams ended at level ground", **dot)]
    if numpy.isnan(depths).any():
        handles.append(Patch(facecolor=NOTHING, edgecolor="grey", label=f"depth camera: nothing within {facts['reach_m']} m"))
    figure.legend(handles=handles, loc="outside lower center", ncols=2)
    return figure


def draw_stand_in(facts: dict):
    """The flight as the stand-in engine had it, and its test patterns."""
    figure, axes = pyplot.subplot_mosaic([["path", "path"], ["rgb", "depth"]], figsize=(10, 8.6), layout="constrained", height_ratios=[1.0, 0.85])
    true, places, ground = numpy.array(facts["paths"][0]["points_m"]), numpy.array(facts["places_m"]), numpy.array(facts["ground_m"])
    axes["path"].plot(true[:, NORTH], true[:, UP], color=COLOURS[0], linewidth=1.5, label=facts["paths"][0]["label"])
    axes["path"].plot(places[::10, NORTH], places[::10, UP], "o", color=COLOURS[1], markersize=4, label="LocationSensor, each tenth tick")
    axes["path"].plot(ground[::10, 0], ground[::10, 1], "x", color="black", markersize=5, label="end of the RangeFinderSensor's beam, each tenth tick")
    axes["path"].set(title="the flight in the stand-in's world, from the east", xlabel="north [m]", ylabel="up [m]", aspect="equal", ylim=(-1.0, 7.0))
    axes["path"].grid(alpha=0.3)
    axes["rgb"].imshow(numpy.array(facts["rgb"], dtype=numpy.uint8), interpolation="nearest")
    shades = axes["depth"].imshow(numpy.array(facts["depths_m"]), cmap="viridis", vmin=0.0, interpolation="nearest")
    figure.colorbar(shades, ax=axes["depth"], label="depth [m]", shrink=0.8)
    for name, sensor in (("rgb", "RGBCamera"), ("depth", "DepthCamera")):
        axes[name].set(title=f"{sensor}, test pattern at tick {facts['tick']}", xlabel="column [px]", ylabel="row [px]")
    figure.suptitle("Stand-in for HoloOcean's engine: a flat world; its pictures are test patterns")
    figure.legend(*axes["path"].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def main(words: list[str]) -> int:
    if len(words) != 2:
        print("usage: worlds_drawing.py FACTS.json FILE.png", file=sys.stderr)
        return 2
    try:
        facts = json.loads(Path(words[0]).read_text())
        draw = draw_stand_in if "rgb" in facts else draw_sensors if "scan_m" in facts else draw_world
        draw(facts).savefig(words[1], dpi=100, pil_kwargs={"optimize": True})  # with all its colours: shades are what is shown
    except (OSError, json.JSONDecodeError) as error:
        print(f"worlds_drawing: {words[0]}: {error}", file=sys.stderr)
        return 2
    except KeyError as error:
        print(f"worlds_drawing: {words[0]}: found no {error}, which the picture is made of", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
