# SPDX-License-Identifier: BSD-3-Clause
"""How a campaign endures on a Dask LocalCluster whose workers are killed, and what the cluster costs; prints JSON. Runs in the environment
of the Python package: ./rosflight bench scale.rows, ./rosflight bench scale.dask.

    cluster.py endurance [FLIGHTS] [--every S] [--kills N] [--restart-every S]
                                       100 000 flights, a worker killed each minute from the first row on, without a limit, no restart
    cluster.py efficiency [FLIGHTS]    flights per minute of two workers over twice those of one

The cluster is a process of its own, with a nanny that replaces the workers: two of them with one thread each. Killed is by SIGKILL, a
worker or, for a restart of the scheduler, all of that process. Lost are seeds without a row in rows.parquet, double are rows beyond the
first of a seed, and differing are rows of which the flight, flown again here, moves otherwise.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

MISSION, WORKERS, FLIGHTS, EVERY_S, AGAIN = "hop", 2, 100_000, 60.0, 20
MEASURED, ROUNDS = 900, 3  #: Flights of a measurement of the efficiency, and how often each is made.


def serve(port: int, workers: int) -> None:
    """In a process of its own: the cluster. Each line of the standard input is the number of a worker to be killed."""
    import dask
    from distributed import LocalCluster

    # It is the nanny that replaces a worker; the cluster itself would remove both if the worker is away at a moment of its choice.
    dask.config.set({"distributed.deploy.lost-worker-timeout": "365 days"})
    with LocalCluster(n_workers=workers, threads_per_worker=1, host="127.0.0.1", scheduler_port=port, dashboard_address=None) as cluster:
        print("runs", flush=True)
        for line in sys.stdin:
            pid = list(cluster.workers.values())[int(line) % workers].pid
            if pid:  # else it is starting
                os.kill(pid, signal.SIGKILL)
            print(int(bool(pid)), flush=True)


class Cluster:
    """That process."""

    def __init__(self, workers: int):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self._port = free.getsockname()[1]
        self._workers = workers
        self._lock = threading.Lock()
        self._ended = False
        self.address = f"tcp://127.0.0.1:{self._port}"
        self._start()

    def _start(self) -> None:
        self._process = subprocess.Popen([sys.executable, __file__, "serve", str(self._port), str(self._workers)], stdin=subprocess.PIPE,
                                         stdout=subprocess.PIPE, text=True, start_new_session=True)
        if self._process.stdout.readline() != "runs\n":
            raise RuntimeError("the cluster does not start")

    def kill_worker(self, number: int) -> bool:
        """False: it was starting."""
        with self._lock:
            if self._ended:
                return False
            self._process.stdin.write(f"{number}\n")
            self._process.stdin.flush()
            return self._process.stdout.readline() == "1\n"

    def _kill(self) -> None:
        os.killpg(self._process.pid, signal.SIGKILL)
        self._process.communicate()

    def restart(self) -> bool:
        """Scheduler, nannies and workers end at once; others begin at the same address."""
        with self._lock:
            if self._ended:
                return False
            self._kill()
            self._start()
            return True

    def end(self) -> None:
        with self._lock:
            self._ended = True
            self._kill()


class Repeated(threading.Thread):
    """Calls something each so many seconds and counts how often it says that it was done, up to a limit."""

    def __init__(self, every_s: float, what, limit: float = math.inf):
        super().__init__(daemon=True)
        self.count = 0
        self._every_s, self._what, self._limit, self._over = every_s, what, limit, threading.Event()

    def run(self) -> None:
        turn = 0
        while self.count < self._limit and not self._over.wait(self._every_s):
            self.count += self._what(turn)
            turn += 1

    def end(self) -> None:
        self._over.set()
        if self.is_alive():
            self.join()


def campaign_file(folder: Path, flights: int) -> Path:
    file = folder / "campaign.yaml"
    file.write_text(f"flights: {flights}\nmission: {MISSION}\nwind: {{speed_m_s: {{uniform: [0, 4]}}, from_deg: {{uniform: [0, 360]}}}}\n")
    return file


def lost_and_double(seeds: list[int], flights: int) -> tuple[int, int]:
    """Of the seeds from 1 on: those without a row, and rows beyond the first of one."""
    return len(set(range(1, flights + 1)) - set(seeds)), len(seeds) - len(set(seeds))


def endurance(flights: int, every_s: float, kills: float, restart_every_s: float) -> dict[str, float]:
    import numpy as np
    import pyarrow.parquet as pq
    from rosflight import _worker, campaign

    random = np.random.default_rng(1)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        cluster = Cluster(WORKERS)
        killer = Repeated(every_s, lambda turn: cluster.kill_worker(int(random.integers(WORKERS))), kills)
        restarter = Repeated(restart_every_s or threading.TIMEOUT_MAX, lambda turn: cluster.restart())
        begun = time.monotonic()

        def begin(done: int, wanted: int) -> None:
            if done == 1:
                killer.start()
                restarter.start()

        try:
            flown = campaign.fly(campaign_file(folder, flights), folder / "out", dask=cluster.address, progress=begin)
            took_s = time.monotonic() - begun
        finally:
            killer.end()
            restarter.end()
            cluster.end()
        rows = pq.read_table(folder / "out/rows.parquet", columns=["seed", "motion_sha256"]).to_pydict()
    lost, double = lost_and_double(rows["seed"], flights)
    seeds = set(rows["seed"])
    sums = dict(zip(rows["seed"], rows["motion_sha256"]))
    again = random.choice(sorted(seeds), min(AGAIN, len(seeds)), replace=False)
    differing = sum(_worker.fly(flown.configuration.arguments(int(seed)))["motion_sha256"] != sums[seed] for seed in again)
    return {"flights": flights, "rows_kills": killer.count, "restarts": restarter.count, "rows_lost": lost, "rows_double": double,
            "rows_differing": differing, "flights_passed": flown.passed,
            "flights_per_minute": 60 * flights / took_s}


def rate(workers: int, flights: int) -> float:
    """Flights per minute once all workers fly."""
    from rosflight import campaign

    ended: list[float] = []
    cluster = Cluster(workers)
    try:
        with tempfile.TemporaryDirectory() as place:
            campaign.fly(campaign_file(Path(place), flights), Path(place) / "out", dask=cluster.address,
                         progress=lambda done, wanted: ended.append(time.monotonic()))
    finally:
        cluster.end()
    first, last = flights // 4, flights - flights // 10  # without the start, and the end at which a worker may be idle
    return 60 * (last - first) / (ended[last - 1] - ended[first - 1])


def efficiency(flights: int) -> dict[str, float]:
    rates = [(rate(1, flights), rate(2, flights)) for _ in range(ROUNDS)]
    one, two = (statistics.median(column) for column in zip(*rates))
    return {"dask_efficiency": two / (2 * one), "dask_flights_per_minute": two}


def main(words: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="bench/cluster.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    enduring = commands.add_parser("endurance")
    enduring.add_argument("flights", nargs="?", type=int, default=FLIGHTS)
    enduring.add_argument("--every", type=float, default=EVERY_S)
    enduring.add_argument("--kills", type=float, default=math.inf)
    enduring.add_argument("--restart-every", type=float, default=0.0)
    commands.add_parser("efficiency").add_argument("flights", nargs="?", type=int, default=MEASURED)
    serving = commands.add_parser("serve")
    serving.add_argument("port", type=int)
    serving.add_argument("workers", type=int)
    options = parser.parse_args(words)
    if options.command == "serve":
        serve(options.port, options.workers)
        return 0
    low = 20 if options.command == "efficiency" else 1
    if options.flights < low:
        parser.error(f"FLIGHTS: found {options.flights}, allowed at least {low}")
    if options.command == "efficiency":
        print(json.dumps(efficiency(options.flights)))
        return 0
    limits = (("every", options.every, options.every > 0), ("restart-every", options.restart_every, options.restart_every >= 0),
              ("kills", options.kills, options.kills >= 0))
    for name, value, allowed in limits:
        if not allowed:
            parser.error(f"--{name}: found {value}, allowed {'more than' if name == 'every' else 'at least'} 0")
    print(json.dumps(endurance(options.flights, options.every, options.kills, options.restart_every)))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
