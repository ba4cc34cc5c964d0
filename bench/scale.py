# SPDX-License-Identifier: BSD-3-Clause
"""How fast many vehicles fly from Python; prints JSON. Runs in the environment of the Python package: ./rosflight bench scale.

Vehicles that differ (python/examples/variation.yaml), all sensors with their shipped noise, the firmware at 400 Hz, random actions at
100 Hz, episodes that end and begin again, observations and rewards as NumPy arrays. Each rate is measured by the clock, with two threads,
and by the processor's time, which other work on the machine changes less.
"""

import json
import statistics
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import rosflight
from rosflight.gym import FlightVectorEnv

VARIATION = Path(__file__).resolve().parents[1] / "python/examples/variation.yaml"
VEHICLES, STEPS, RUNS, FLIGHTS = 256, 100, 5, 60


class Stopwatch:
    """Seconds of the clock and of the processor since it was made."""

    def __init__(self):
        self._clock, self._processor = time.monotonic(), time.process_time()

    def read(self) -> tuple[float, float]:
        return time.monotonic() - self._clock, time.process_time() - self._processor


def made(vehicles: int, **options) -> FlightVectorEnv:
    envs = FlightVectorEnv(vehicles, **options)
    envs.reset(seed=1)
    return envs


def stepped(envs: FlightVectorEnv, steps: int = STEPS) -> tuple[float, float]:
    """Medians: vector steps per second of the clock, and of the processor."""
    random = np.random.default_rng(1)
    actions = random.uniform(-1, 1, (steps, *envs.action_space.shape)).astype(np.float32)
    rates = []
    for _ in range(RUNS):
        watch = Stopwatch()
        for action in actions:
            envs.step(action)
        rates.append([steps / seconds for seconds in watch.read()])
    return tuple(statistics.median(column) for column in zip(*rates))


def steps() -> dict[str, float]:
    found = {}
    for name, options in (("steps", {}), ("steps_link", {"link": True})):
        clock, processor = stepped(made(VEHICLES, threads=2, randomise=VARIATION, **options))
        found |= {f"{name}_per_s": VEHICLES * clock, f"{name}_per_core_s": VEHICLES * processor}
    alone, _ = stepped(made(VEHICLES, threads=1, randomise=VARIATION))
    return found | {"thread_efficiency": found["steps_per_s"] / (2 * VEHICLES * alone)}


def overhead_us() -> float:
    """What a vector step of one vehicle takes beyond the same vehicle's share of a step of many."""
    _, one = stepped(made(1), 2000)
    _, many = stepped(made(VEHICLES))
    return 1e6 * (1 / one - 1 / (many * VEHICLES))


def memory_kb() -> float:
    def resident() -> int:
        return 4 * int(Path("/proc/self/statm").read_text().split()[1])

    first = made(4)
    before = resident()
    second = made(VEHICLES)
    found = (resident() - before) / VEHICLES
    del first, second
    return 1.024 * found


def flights() -> dict[str, float]:
    """The default mission on the estimate, from power-up to disarmed, without a log."""
    watch = Stopwatch()
    with ThreadPoolExecutor(2) as pool:
        flown = list(pool.map(lambda seed: rosflight.fly(seed=seed, log="none", series_hz=0), range(1, FLIGHTS + 1)))
    clock, processor = watch.read()
    return {"flights_per_minute": 60 * FLIGHTS / clock, "flights_per_core_minute": 60 * FLIGHTS / processor,
            "flights_failed": sum(not flight.success for flight in flown)}


if __name__ == "__main__":
    print(json.dumps({"memory_kB": memory_kb(), "overhead_us": overhead_us(), **steps(), **flights()}))
