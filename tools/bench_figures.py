# SPDX-License-Identifier: BSD-3-Clause
"""The figures of ./rosflight bench: how each is measured and what it should be.

Programs under bench/ do the work and print numbers; what they take and print stands in
bench/README.md. A new figure is one more row in all_figures().
"""

import functools
import json
import statistics
import subprocess
import tempfile
import time
from dataclasses import dataclass
from typing import Callable

import callgrind
import project
import stages

RELEASE = project.ROOT / "build" / "release"
FUZZ_RUNS = 1_000_000


@dataclass(frozen=True)
class Figure:
    name: str
    unit: str
    target: str  # "<= 2500", or "report" when there is nothing to meet
    measure: Callable[[], float]
    preset: str = "release"  # the build it needs


def all_figures() -> list[Figure]:
    return [
        Figure("firmware.instructions", "instructions", "<= 2500", firmware_pass),
        Figure("firmware.instructions_no_link", "instructions", "<= 2000",
               lambda: firmware_pass("--no-link")),
        Figure("loop.realtime_factor", "s/s", ">= 1000", lambda: loop_factor("realtime_factor")),
        Figure("loop.realtime_factor_log", "s/s", "report",
               lambda: loop_factor("realtime_factor_log")),
        Figure("loop.realtime_factor_ekf", "s/s", ">= 500",
               lambda: loop_factor("realtime_factor_ekf")),
        Figure("firmware.object_bytes", "B", "<= 14000", lambda: size("firmware.object_bytes")),
        Figure("firmware.heap_allocations", "allocations", "= 0",
               lambda: size("firmware.heap_allocations")),
        Figure("fly.wall_s", "s", "< 5", fly_wall_s),
        *(Figure(f"estimation.{noise}.{quantity}", unit, "report",
                 functools.partial(estimation_figure, noise, quantity))
          for noise in ("shipped", "modelled") for quantity, unit in ESTIMATION),
        *(Figure(f"missions.{name}.{quantity}", unit, target,
                 functools.partial(mission_figure, name, quantity))
          for name, quantity, unit, target in MISSIONS),
        *(Figure(f"fuzz.{name.removeprefix('fuzz_')}_runs", "inputs", f">= {FUZZ_RUNS}",
                 functools.partial(fuzz_runs, name), preset="fuzz") for name in stages.fuzzers()),
    ]


# Errors of the estimate in the default flight: rms and what 95 of 100 samples stay below.
ESTIMATION = [(f"{name}_{kind}", unit)
              for name, unit in (("horizontal_m", "m"), ("vertical_m", "m"), ("velocity_m_s", "m/s"),
                                 ("tilt_deg", "deg"), ("heading_deg", "deg")) for kind in ("rms", "p95")]
ESTIMATION += [("nees", "1")]


def mission_rows() -> list[tuple[str, str, str, str]]:
    """Name, quantity, unit, target: what the flights of bench/missions.cpp are held to."""
    rows = []
    for name, limit in (("default", 1.0), ("figure_eight", 1.0), ("survey", 1.0), ("hover", 0.7)):
        rows += [(name, "horizontal_rms_m", "m", f"<= {limit}"), (name, "total_rms_m", "m", "report"),
                 (name, "completed", "flights", "= 1")]
    for name in ("gnss_loss", "gnss_loss_fast", "gnss_loss_wind"):
        rows += [(name, "horizontal_max_m", "m", "<= 30"), (name, "max_tilt_deg", "deg", "<= 45"),
                 (name, "landed", "flights", "= 1")]
    for name in ("baro_step", "mag_turned", "accel_step_x", "accel_step_y", "accel_step_z",
                 "gyro_step_x", "gyro_step_y", "gyro_step_z"):
        rows += [(name, "horizontal_max_m", "m", "report"), (name, "max_tilt_deg", "deg", "<= 45"),
                 (name, "landed", "flights", "= 1")]
    rows += [("default_gusts", "completed", "flights", "= 100"),
             ("default_gusts", "worst_horizontal_rms_m", "m", "report")]
    return rows


MISSIONS = mission_rows()


def prepare(preset: str):
    """Builds what the figures run. What does not build fails where it is measured."""
    if preset == "release":
        project.build("release", "bench/all", keep_going=True)
        project.build("release", "rosflight", keep_going=True)
    else:
        project.build(preset, *stages.fuzzers(), keep_going=True)


def program(name: str, folder: str = "bench") -> str:
    path = RELEASE / folder / name
    target = f"{folder}/{name}"
    if not path.is_file() or not project.is_up_to_date("release", target):
        raise RuntimeError(f"{target} does not build, see build/release/build.log")
    return str(path)


def run_json(command: list[str], ending: tuple[int, ...] = (0,)) -> dict:
    """What a program prints on stdout, as JSON."""
    done = subprocess.run(command, cwd=project.ROOT, capture_output=True, text=True)
    if done.returncode not in ending:
        last = (done.stderr.strip().splitlines() or ["it said nothing"])[-1]
        raise RuntimeError(f"{command[0]} ended with {done.returncode}: {last}")
    try:
        return json.loads(done.stdout)
    except json.JSONDecodeError as error:
        raise RuntimeError(f"{command[0]} printed no JSON: {error}") from None


def number(printed: dict, key: str) -> float:
    value = printed.get(key)
    if not isinstance(value, (int, float)) or isinstance(value, bool):
        raise RuntimeError(f"no number '{key}' among {', '.join(printed) or 'nothing'}")
    return value


def firmware_pass(*options: str) -> float:
    return callgrind.instructions_per_call(
        [program("firmware_pass"), *options, "--passes"], few=4_000, many=20_000)


@functools.cache
def loop_runs() -> list[dict]:
    command = [program("loop")]
    return [run_json(command) for _ in range(5)]


def loop_factor(key: str) -> float:
    return statistics.median(number(printed, key) for printed in loop_runs())


@functools.cache
def estimation() -> dict:
    return run_json([program("estimation")])


def estimation_figure(noise: str, quantity: str) -> float:
    return number(estimation()[noise], quantity)


@functools.cache
def missions() -> dict:
    return run_json([program("missions")])


def mission_figure(name: str, quantity: str) -> float:
    return number(missions()[name], quantity)


@functools.cache
def sizes() -> dict:
    return run_json([program("sizes")])


def size(key: str) -> float:
    return number(sizes(), key)


def fly_wall_s() -> float:
    """Wall time of the default flight, median of three; it must succeed to count."""
    walls = []
    for _ in range(3):
        with tempfile.TemporaryDirectory() as scratch:
            start = time.monotonic()
            printed = run_json([program("rosflight", "apps"), "fly", "--json", "--out", f"{scratch}/flight"])
            walls.append(time.monotonic() - start)
        if printed.get("success") is not True:
            raise RuntimeError("the flight did not succeed")
    return statistics.median(walls)


def fuzz_runs(name: str) -> float:
    runs, complaints = stages.run_fuzzer(name, f"-runs={FUZZ_RUNS}")
    if complaints:
        raise RuntimeError(complaints[0])
    return runs
