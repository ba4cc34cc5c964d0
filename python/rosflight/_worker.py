# SPDX-License-Identifier: BSD-3-Clause
"""One flight of a campaign, and the process that flies them: `python -m rosflight._worker` reads flights from its standard input,
one JSON object a line, and writes their results. It needs NumPy alone."""

from __future__ import annotations

import hashlib
import json
import math
import os
import shutil
import sys
import time
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from . import _core, _flight

#: What else of summary.json a row has.
SAME = ("outcome", "verdict", "waypoints_reached", "waypoints_total", "tracking_rms_m", "tracking_max_m", "own_tracking_rms_m",
        "own_tracking_max_m", "touchdown_speed_m_s", "touchdown_tilt_deg", "touchdown_distance_m", "flight_time_s", "sim_time_s", "warnings",
        "errors")


SERIES, SHOWN = "series.npz", 10  #: Beside a log: every tenth row of Flight.series.


class OtherProgram(RuntimeError):
    """A worker with another program than the campaign."""


@cache
def program() -> str:
    """What computes: the commit, and where files differed from it what was built of them."""
    if not _core.BUILD.endswith("changed since"):
        return str(_core.BUILD)
    package = Path(_flight.__file__).parent
    content = hashlib.sha256()
    for file in sorted([Path(_core.__file__), *package.rglob("*.py")]):
        content.update(file.read_bytes())
    return f"{_core.BUILD}, content {content.hexdigest()[:12]}"


def fly(arguments: dict[str, Any], folder: str | None = None) -> dict[str, Any]:
    """@param folder: leaves log and report there, whole or not at all."""
    if folder is None:
        return _result(_flight.fly(**arguments, log="none"))
    aside = Path(folder).with_name(f".{Path(folder).name}.{os.getpid()}")
    try:
        flight = _flight.fly(**arguments, out=aside)
        np.savez_compressed(aside / SERIES, **{name: values[::SHOWN] for name, values in flight.series.items()})  # type: ignore[arg-type]
        shutil.rmtree(folder, ignore_errors=True)
        aside.rename(folder)
    finally:
        shutil.rmtree(aside, ignore_errors=True)
    return _result(flight) | {"log_sha256": flight.log_sha256}


def fly_as(wanted: str, flights: list[dict[str, Any]]) -> tuple[float, list[dict[str, Any]]]:
    """For workers elsewhere: the seconds that it took, and an answer for each flight. @param wanted: the program of the campaign."""
    if program() != wanted:
        raise OtherProgram(f"it has {program()}, the campaign {wanted}")
    begun = time.monotonic()
    answers = [_answer({"arguments": arguments}) for arguments in flights]
    return time.monotonic() - begun, answers


def _result(flight: _flight.Flight) -> dict[str, Any]:
    distances = [waypoint["truth_distance_m"] for waypoint in flight.summary["waypoints"]]
    worst = math.nan if None in distances else max(distances, default=0.0)
    return ({name: math.nan if flight.summary[name] is None else flight.summary[name] for name in SAME}
            | {"worst_waypoint_m": worst, "motion_sha256": _motion_sha256(flight)})


def _motion_sha256(flight: _flight.Flight) -> str:
    """True motion, estimate and setpoint at 100 Hz: flights with equal sums are equal to the bit."""
    content = hashlib.sha256()
    for name in sorted(flight.series):
        content.update(flight.series[name].tobytes())
    return content.hexdigest()


def _answer(task: dict[str, Any]) -> dict[str, Any]:
    try:
        return {"result": fly(**task)}
    except ValueError as error:
        return {"refused": str(error)}
    except OSError as error:
        return {"failed": str(error)}


def main() -> None:
    out = sys.stdout
    sys.stdout = sys.stderr
    for line in sys.stdin:
        out.write(json.dumps(_answer(json.loads(line))) + "\n")
        out.flush()


if __name__ == "__main__":
    try:
        main()
    except BrokenPipeError:  # who asked has ended
        pass
