# SPDX-License-Identifier: BSD-3-Clause
"""Whole flights: the same as `./rosflight fly`, in this process."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from . import _arguments as arguments
from . import _core

if TYPE_CHECKING:
    import pandas

STEPS_PER_SECOND = 400
SEVERITIES = {2: "critical", 3: "error", 4: "warning", 6: "info"}
AXES = {3: ("x", "y", "z"), 4: ("w", "x", "y", "z")}


@dataclass(frozen=True)
class Note:
    """One line of the event log of a flight."""

    t_s: float  #: Simulated time.
    source: str  #: mission, autonomy, estimator, companion, fcu or pilot.
    severity: str  #: critical, error, warning or info.
    text: str

    def __str__(self) -> str:
        return f"{self.t_s:8.2f} s  {self.source}: {self.text}"


@dataclass(frozen=True)
class Flight:
    """How a flight went, judged by the true motion of the vehicle (docs/scoring.md)."""

    success: bool
    outcome: str  #: mission_done, landed_elsewhere, hard_landing, crash, timeout or interrupted.
    verdict: str  #: The same as one sentence.
    vehicle: str
    mission: str
    seed: int
    log_sha256: str | None  #: Hash of what was logged; None without a log.
    folder: Path | None  #: Flight folder; None if none was written.
    sim_time_s: float
    flight_time_s: float  #: Since arming.
    wall_time_s: float
    waypoints_reached: int
    waypoints_total: int
    tracking_rms_m: float  #: Distance of the true position from the setpoint; NaN if it was never on the path.
    tracking_max_m: float
    touchdown_speed_m_s: float  #: NaN without a touchdown, like the next two.
    touchdown_tilt_deg: float
    touchdown_distance_m: float
    warnings: int
    errors: int
    summary: dict[str, Any] = field(repr=False)  #: All of summary.json.
    notes: list[Note] = field(repr=False)
    #: True motion, estimate and setpoint over time. Local north-east-down, attitude as a quaternion w, x, y, z from body to
    #: north-east-down, rates in the body. One row for each instant of `t_s`.
    series: dict[str, np.ndarray[Any, np.dtype[np.float64]]] = field(repr=False)

    def to_pandas(self) -> pandas.DataFrame:
        """The series as a table, indexed by time; columns such as `position_m.x`. Needs pandas."""
        import pandas

        columns: dict[str, Any] = {}
        for name, values in self.series.items():
            if values.ndim == 1:
                columns[name] = values
            else:
                columns |= {f"{name}.{axis}": values[:, k] for k, axis in enumerate(AXES[values.shape[1]])}
        return pandas.DataFrame(columns).set_index("t_s")


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)


def fly(
    vehicle: str | os.PathLike[str] = "multirotor",
    mission: str | os.PathLike[str] = "default",
    seed: int = 1,
    wind: arguments.Wind | None = None,
    faults: Union[str, Iterable[str]] = (),
    set: arguments.Overrides = (),
    *,
    state: str = "estimate",
    pilot: str = "hover",
    link_protocol: str = "mavlink",
    log: str = "plot",
    out: str | os.PathLike[str] | None = None,
    series_hz: int = 100,
) -> Flight:
    """Flies a mission in simulation, from power-up to disarmed, with the real firmware and its link.

    The same code as `./rosflight fly`: equal arguments give logs that are equal to the bit. The flight computes without the
    interpreter's lock, so several threads fly at once. Ctrl-C ends it; its folder is then written as of any other.

    vehicle     a name of `rosflight.vehicles()`, or a YAML file
    mission     a name of `rosflight.missions()`, or a YAML file
    seed        of all noise and wind
    wind        (SPEED m/s, FROM degrees[, W20 m/s]), or as the command takes it: "8,270,5"
    faults      such as "baro@20:5" or ["motor0_dead@30"], seconds since power-up (docs/faults.md)
    set         other values of keys of the vehicle file: {"body.mass_kg": 3.2} or ["body.mass_kg=3.2"]
    state       what guidance flies on: estimate or truth
    pilot       throttle stick of the safety pilot: hover or idle
    log         plot, full or none
    out         flight folder, new or empty; None: the next one in flights/, or none at all with log="none"
    series_hz   rows of Flight.series per second: a divisor of 400, or 0 for none

    Raises ValueError or TypeError for bad input (nothing is written then), OSError where a file cannot be written.
    """
    series_hz = arguments.whole("series_hz", series_hz, 0, STEPS_PER_SECOND)
    if series_hz and STEPS_PER_SECOND % series_hz:
        raise ValueError(f"series_hz: found {series_hz}, allowed 0 or a divisor of {STEPS_PER_SECOND}")
    summary, series, notes, folder = _core.fly(
        _choice(vehicle, mission, seed, wind, faults, set, state, pilot, link_protocol),
        arguments.one_of("log", log, ("plot", "full", "none")),
        None if out is None else arguments.name_or_path("out", out),
        STEPS_PER_SECOND // series_hz if series_hz else 0,
    )
    said: dict[str, Any] = json.loads(summary)
    same = ("success", "outcome", "verdict", "vehicle", "mission", "seed", "log_sha256", "waypoints_reached",
            "waypoints_total", "warnings", "errors")
    numbers = ("sim_time_s", "flight_time_s", "wall_time_s", "tracking_rms_m", "tracking_max_m", "touchdown_speed_m_s",
               "touchdown_tilt_deg", "touchdown_distance_m")
    found: dict[str, Any] = {name: said[name] for name in same} | {name: _number(said[name]) for name in numbers}
    return Flight(
        **found,
        folder=Path(folder) if folder else None,
        summary=said,
        notes=[Note(t_s, source, SEVERITIES[severity], text) for t_s, source, severity, text in notes],
        series=series,
    )


_Choice = tuple[str, str, int, Union[str, None], list[str], list[str], str, str, str]


def _choice(vehicle: object, mission: object, seed: object, wind: arguments.Wind | None, faults: Union[str, Iterable[str]],
            overrides: arguments.Overrides, state: object, pilot: object, link_protocol: object) -> _Choice:
    return (
        arguments.name_or_path("vehicle", vehicle),
        arguments.name_or_path("mission", mission),
        arguments.whole("seed", seed, 0),
        arguments.wind_text(wind),
        arguments.texts("faults", faults),
        arguments.override_texts(overrides),
        arguments.one_of("state", state, ("estimate", "truth")),
        arguments.one_of("pilot", pilot, ("hover", "idle")),
        arguments.one_of("link_protocol", link_protocol, ("mavlink", "lean")),
    )


def check(vehicle: str = "multirotor", mission: str = "default", *, wind: arguments.Wind | None = None,
          faults: Union[str, Iterable[str]] = (), set: arguments.Overrides = ()) -> tuple[str, str]:
    """Reads and checks what `fly` would, and flies nothing: the same errors. Returns the vehicle, with all that it extends
    and with `set`, and the mission, as texts of YAML."""
    return _core.check(_choice(vehicle, mission, 1, wind, faults, set, "estimate", "hover", "mavlink"))


def vehicles() -> list[str]:
    """Names of the vehicles that come with the package."""
    files = (Path(_core.data_folder()) / "vehicles").glob("*.yaml")
    return sorted(file.stem for file in files if _flies(file))


def _flies(file: Path) -> bool:
    """A vehicle, not a frame for `./rosflight mixer`."""
    return any(line.startswith(("type:", "extends:")) for line in file.read_text(encoding="utf-8").splitlines())


def missions() -> list[str]:
    """Names of the missions that come with the package."""
    return sorted(file.stem for file in (Path(_core.data_folder()) / "missions").glob("*.yaml"))
