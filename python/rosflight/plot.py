# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of a flight, for a paper: each function returns a matplotlib figure. They need matplotlib (pip install '.[plot]').

The flight is a log of `rosflight.read`, a flight folder or MCAP file, or a `Flight` that left a folder.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from ._flight import Flight
from ._log import Log, Topic, read

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

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
    from matplotlib.figure import Figure

    log = _log(source)
    truth = _topic(log, TRUTH)
    p = _position(truth)
    figure = Figure(figsize=(6.4, 6.4), layout="constrained")
    above, side = figure.subplots(2, 1, height_ratios=(3, 1))
    above.plot(p[:, 1], p[:, 0], label="true path")
    side.plot(truth.t_s, -p[:, 2], label="true")
    if SETPOINT in log:
        setpoint = log[SETPOINT]
        above.plot(setpoint["position"][:, 1], setpoint["position"][:, 0], "--", linewidth=1, label="setpoint")
        side.plot(setpoint.t_s, -setpoint["position"][:, 2], "--", linewidth=1, label="setpoint")
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
