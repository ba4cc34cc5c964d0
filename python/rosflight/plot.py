# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of flights, for a paper: each function returns a matplotlib figure. They need matplotlib (pip install '.[plot]').

A flight is a log of `rosflight.read`, a flight folder or MCAP file, or a `Flight` that left a folder. `success`, `distribution` and
`paired` show campaigns (`rosflight.campaign`).
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from ._flight import Flight
from ._log import Log, Topic, read

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .campaign import Campaign

Source = Union[Log, Flight, str, "os.PathLike[str]"]
Array = np.ndarray[Any, Any]

TRUTH, SETPOINT, ESTIMATE, COMMAND = "/sim/truth_state", "/trajectory_command", "/autonomy/estimate", "/command"
#: In the order of Estimate.msg.
AIDS = ("GNSS horizontal", "GNSS altitude", "GNSS velocity", "barometer", "heading", "range", "pitot", "sideslip", "rest")
ANGLES_MODE = 2  #: Command.mode: roll, pitch, yaw rate, throttle.


def _log(source: Source) -> Log:
    if isinstance(source, Log):
        return source
    if isinstance(source, Flight):
        if source.folder is None or source.log_sha256 is None:
            raise ValueError("plot: found a flight without a log, allowed one of fly(log='plot') or fly(log='full')")
        source = source.folder
    return read(source)


def _topic(log: Log, name: str) -> Topic:
    if name not in log:
        raise ValueError(f"plot: found no {name} in {log.path}, which this picture is made of")
    return log[name]


def _figure(rows: int, height: float) -> tuple[Figure, list[Axes]]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, height), layout="constrained")
    axes = figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0]
    axes[-1].set_xlabel("time [s]")
    return figure, list(axes)


def _position(truth: Topic) -> Array:
    return np.stack([truth[f"pose.position.{axis}"] for axis in "xyz"], axis=1)


def _at(t_s: Array, topic: Topic, values: Array) -> Array:
    """Values of another topic at these times, linear between its messages; NaN outside."""
    return np.stack([np.interp(t_s, topic.t_s, column, left=np.nan, right=np.nan) for column in values.T], axis=1)


def path(source: Source) -> Figure:
    """Where it flew: seen from above, and its altitude over time."""
    log = _log(source)
    truth = _topic(log, TRUTH)
    lines = {"true path": (truth.t_s, _position(truth))}
    if SETPOINT in log:
        lines["setpoint"] = log[SETPOINT].t_s, log[SETPOINT]["position"]
    return path_of(lines)


def path_of(lines: Mapping[str, tuple[Array, Array]]) -> Figure:
    """The same of positions north, east, down: name -> times and a row for each. The first is drawn solid."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 6.4), layout="constrained")
    above, side = figure.subplots(2, 1, height_ratios=(3, 1))
    for k, (name, (t_s, p)) in enumerate(lines.items()):
        style: dict[str, Any] = {"linestyle": "--", "linewidth": 1} if k else {}
        above.plot(p[:, 1], p[:, 0], label=name, **style)
        side.plot(t_s, -p[:, 2], label=name, **style)
    above.set(xlabel="east [m]", ylabel="north [m]", aspect="equal")
    side.set(xlabel="time [s]", ylabel="altitude [m]")
    above.legend()
    return figure


def tracking(source: Source) -> Figure:
    """True position less setpoint, by axis, and the distance between them."""
    log = _log(source)
    setpoint, truth = _topic(log, SETPOINT), _topic(log, TRUTH)
    errors = _at(setpoint.t_s, truth, _position(truth)) - setpoint["position"]
    figure, (axes, distance) = _figure(2, 4.8)
    for values, name in zip(errors.T, ("north", "east", "down")):
        axes.plot(setpoint.t_s, values, label=name)
    axes.set_ylabel("error [m]")
    axes.legend(ncols=3)
    distance.plot(setpoint.t_s, np.linalg.norm(errors, axis=1))
    distance.set_ylabel("distance [m]")
    return figure


def _euler_deg(truth: Topic) -> Array:
    x, y, z, w = (truth[f"pose.orientation.{axis}"] for axis in "xyzw")
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2 * (w * y - z * x), -1, 1))
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return np.stack([np.degrees(roll), np.degrees(pitch), np.degrees(yaw)], axis=1)


def attitude(source: Source) -> Figure:
    """True roll, pitch and heading, with roll and pitch as they were commanded."""
    log = _log(source)
    truth, command = _topic(log, TRUTH), _topic(log, COMMAND)
    angles = _euler_deg(truth)
    figure, axes = _figure(3, 6.4)
    commanded = command["mode"] == ANGLES_MODE
    for k, name in enumerate(("roll", "pitch", "heading")):
        axes[k].plot(truth.t_s, angles[:, k], label="true")
        axes[k].set_ylabel(f"{name} [°]")
        if k < 2 and commanded.any():
            axes[k].plot(command.t_s[commanded], np.degrees(command["u"][commanded, 3 + k]), "--", linewidth=1, label="commanded")
    axes[0].legend()
    return figure


def innovations(source: Source) -> Figure:
    """Squared innovations of the estimator's aids over their covariance: 1 on average where the filter is consistent."""
    estimate = _topic(_log(source), ESTIMATE)
    ratio = estimate["innovation"]
    used = [k for k in range(ratio.shape[1]) if np.nanmax(ratio[:, k], initial=0) > 0]
    figure, axes = _figure(max(len(used), 1), 1.2 * max(len(used), 1) + 0.6)
    for axis, k in zip(axes, used):
        axis.semilogy(estimate.t_s, np.where(ratio[:, k] > 0, ratio[:, k], np.nan), ".", markersize=2)
        axis.axhline(1.0, color="black", linewidth=0.8)
        axis.set_ylabel(AIDS[k], rotation=0, horizontalalignment="right")
    return figure


BINS = 8


def distribution(campaign: Campaign, column: str) -> Figure:
    """How often a number of the flights has which value, those that failed apart, with the quantiles 5, 50 and 95 %."""
    from matplotlib.figure import Figure

    values, passed = campaign[column].astype(float), campaign["passed"].astype(bool)
    known = np.isfinite(values)
    figure = Figure(figsize=(6.4, 3.2), layout="constrained")
    axes = figure.subplots()
    if known.any():
        axes.hist([values[known & passed], values[known & ~passed]], bins=40, stacked=True, color=["tab:blue", "tab:red"],
                  label=["passed", "failed"])
        for share, value in zip((5, 50, 95), np.quantile(values[known], (0.05, 0.5, 0.95))):
            axes.axvline(value, color="black", linewidth=0.8, linestyle="-" if share == 50 else "--")
    axes.set(xlabel=column, ylabel="flights")
    axes.legend()
    return figure


def success(campaign: Campaign, by: str) -> Figure:
    """The success rate with its confidence interval by one condition: by its values, or in bins of as many flights each."""
    from matplotlib.figure import Figure

    from .campaign import clopper_pearson

    values = campaign[by]
    if by == "faults":  # by their names alone
        values = np.array([re.sub(r"[=@]\S+", "", str(value)) for value in values], object)
    names, members = _groups(values)
    passed = campaign["passed"].astype(bool)
    confidence = campaign.configuration.required.confidence
    figure = Figure(figsize=(6.4, 3.2), layout="constrained")
    axes = figure.subplots()
    for k, mine in enumerate(members):
        rate = passed[mine].mean()
        low, high = clopper_pearson(int(passed[mine].sum()), int(mine.sum()), confidence)
        axes.errorbar(k, 100 * rate, [[100 * (rate - low)], [100 * (high - rate)]], fmt="o", color="tab:blue", capsize=4)
    axes.set_xticks(range(len(names)), names, rotation=30 if len(names) > 4 else 0, ha="right" if len(names) > 4 else "center")
    axes.set(xlabel=by, ylabel="success [%]", ylim=(-3, 103))
    return figure


def _groups(values: Array) -> tuple[list[str], list[Array]]:
    """Names and members, as masks."""
    distinct = np.unique(values)
    if len(distinct) <= BINS:
        return [f"{value:.3g}" if isinstance(value, float) else str(value) or "none" for value in distinct], [values == value for value in distinct]
    if values.dtype.kind != "f":
        counts = [int((values == value).sum()) for value in distinct]
        often = distinct[np.argsort(counts)[::-1][:BINS - 1]]
        return [*(str(value) or "none" for value in often), "others"], [*(values == value for value in often), ~np.isin(values, often)]
    edges = np.quantile(values, np.linspace(0, 1, BINS + 1))
    member = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, BINS - 1)
    return [f"{low:.3g} to {high:.3g}" for low, high in zip(edges, edges[1:])], [member == k for k in range(BINS)]


def paired(before: Campaign, after: Campaign, column: str) -> Figure:
    """A number of the same flights before and after a change; above the line it has grown."""
    from matplotlib.figure import Figure

    _, mine, theirs = np.intersect1d(before["seed"], after["seed"], return_indices=True)
    was, now = before[column][mine].astype(float), after[column][theirs].astype(float)
    figure = Figure(figsize=(4.8, 4.8), layout="constrained")
    axes = figure.subplots()
    axes.plot(was, now, ".", markersize=4)
    both = np.concatenate([was, now])
    ends = [np.nanmin(both), np.nanmax(both)] if np.isfinite(both).any() else [0.0, 1.0]
    axes.plot(ends, ends, color="black", linewidth=0.8)
    axes.set(xlabel=f"{column} before", ylabel=f"{column} after")
    return figure
