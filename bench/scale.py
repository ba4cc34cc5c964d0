# SPDX-License-Identifier: BSD-3-Clause
"""How fast many vehicles fly from Python; prints JSON. Runs in the environment of the Python package: ./rosflight bench scale.

    scale.py [PYTHON]

Vehicles that differ (python/examples/variation.yaml), all sensors with their shipped noise, the firmware at 400 Hz, random actions at
100 Hz, episodes that end and begin again, observations and rewards as NumPy arrays. PYTHON is the interpreter of .venv-peers: the
simulators of bench/peers.py then take turns with ours, round by round, so that other work on the machine slows all of them, and what is
printed are medians. Each rate is measured by the clock and by the processor's time, which other work changes less.
"""

import json
import multiprocessing
import statistics
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Callable

import numpy as np
import rosflight
from rosflight.gym import FlightVectorEnv

ROOT = Path(__file__).resolve().parents[1]
VARIATION = ROOT / "python/examples/variation.yaml"
VEHICLES, STEPS, ROUNDS, FLIGHTS = 256, 100, 7, 60
PEERS = ("crazyflow", "crazyflow_rotors", "l2f")
Rates = dict[str, float]  #: "per_s" by the clock, "per_core_s" by the processor.


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


class Ours:
    """Vehicles of ours that are stepped."""

    def __init__(self, vehicles: int, steps: int = STEPS, **options):
        self._envs = made(vehicles, **options)
        random = np.random.default_rng(1)
        self._actions = random.uniform(-1, 1, (steps, *self._envs.action_space.shape)).astype(np.float32)
        self._steps = steps * vehicles

    def measure(self) -> Rates:
        watch = Stopwatch()
        for action in self._actions:
            self._envs.step(action)
        clock, processor = watch.read()
        return {"per_s": self._steps / clock, "per_core_s": self._steps / processor}


class Peer:
    """The same of another simulator, in a process and a folder of its own: MuJoCo writes a file where it starts."""

    def __init__(self, python: str, name: str, cores: int):
        self._folder = tempfile.TemporaryDirectory()
        command = [python, str(ROOT / "bench/peers.py"), name, str(VEHICLES), str(cores)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                                         cwd=self._folder.name)
        self._name = name

    def measure(self) -> Rates:
        assert self._process.stdin and self._process.stdout
        print("measure", file=self._process.stdin, flush=True)
        answer = self._process.stdout.readline()
        if not answer:
            raise SystemExit(f"{self._name} ended with {self._process.wait()}; by hand: .venv-peers/bin/python bench/peers.py {self._name} "
                             f"{VEHICLES} 1")
        return json.loads(answer)


def in_turns(contenders: dict[str, Ours | Peer]) -> dict[str, Rates]:
    """Medians of rounds in which each has its turn, after one that does not count."""
    rounds = [{name: one.measure() for name, one in contenders.items()} for _ in range(1 + ROUNDS)][1:]
    return {name: {key: statistics.median(turn[name][key] for turn in rounds) for key in ("per_s", "per_core_s")} for name in contenders}


def steps(peers_python: str | None) -> dict[str, float]:
    contenders: dict[str, Ours | Peer] = {
        "steps": Ours(VEHICLES, threads=2, randomise=VARIATION),
        "steps_1": Ours(VEHICLES, threads=1, randomise=VARIATION),
        "steps_link": Ours(VEHICLES, threads=2, randomise=VARIATION, link=True),
    }
    if peers_python:
        contenders |= {f"{name}_steps_{cores}": Peer(peers_python, name, cores) for name in PEERS for cores in (1, 2)}
    rates = in_turns(contenders)
    ours = rates["steps_1"]["per_core_s"]
    found = {"steps_per_s": rates["steps"]["per_s"], "steps_per_core_s": ours,
             "steps_link_per_s": rates["steps_link"]["per_s"], "steps_link_per_core_s": rates["steps_link"]["per_core_s"],
             "thread_efficiency": rates["steps"]["per_s"] / (2 * rates["steps_1"]["per_s"])}
    for name in PEERS if peers_python else ():
        one, two = (rates[f"{name}_steps_{cores}"] for cores in (1, 2))
        found |= {f"{name}_steps_per_s": two["per_s"], f"{name}_steps_per_core_s": one["per_core_s"],
                  f"over_{name}": ours / one["per_core_s"], f"over_{name}_two_cores": found["steps_per_s"] / two["per_s"]}
    return found


def overhead_us() -> float:
    """What a vector step of one vehicle takes beyond the same vehicle's share of a step of many, on one thread, by the processor."""
    rates = in_turns({"one": Ours(1, 2000), "many": Ours(VEHICLES)})
    return 1e6 * (1 / rates["one"]["per_core_s"] - 1 / rates["many"]["per_core_s"])


def memory_kb(**options) -> float:
    """What a vehicle more takes, in a process of its own: memory that was freed before would be taken again."""
    def resident() -> int:
        return 4 * int(Path("/proc/self/statm").read_text().split()[1])

    first = made(4, **options)
    before = resident()
    second = made(VEHICLES, **options)
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


def bytes_kept() -> dict[str, float]:
    """What a flight leaves: a row of a campaign, and, where it is wanted, its folder with the log."""
    with tempfile.TemporaryDirectory() as scratch:
        file, rows = Path(scratch) / "campaign.yaml", 64
        file.write_text(f"flights: {rows}\nmission: hop\nwind: {{speed_m_s: {{uniform: [0, 6]}}, from_deg: {{uniform: [0, 360]}}}}\n"
                        "set: {body.mass_kg: {uniform: [3, 3.6]}}\n")
        out = Path(scratch) / "rows"
        rosflight.campaign.fly(file, out, workers=2)
        rosflight.fly(seed=1, out=Path(scratch) / "flight")
        kept = sum(path.stat().st_size for path in (Path(scratch) / "flight").rglob("*") if path.is_file())
        return {"row_bytes": (out / "rows.parquet").stat().st_size / rows, "log_bytes": float(kept)}


def alone(function: Callable[..., float], **options) -> float:
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        return pool.submit(function, **options).result()


if __name__ == "__main__":
    found = {"memory_kB": alone(memory_kb, randomise=VARIATION), "memory_equal_kB": alone(memory_kb), "overhead_us": overhead_us(),
             **steps(sys.argv[1] if len(sys.argv) > 1 else None), **flights(), **bytes_kept()}
    print(json.dumps(found))
