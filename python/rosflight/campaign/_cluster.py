# SPDX-License-Identifier: BSD-3-Clause
"""Workers of a Dask cluster that fly. The rows are written by the campaign alone, so that none can come twice."""

from __future__ import annotations

import asyncio
import logging
import time
from collections import deque
from collections.abc import Generator, Iterable, Iterator
from itertools import islice
from typing import Any, NoReturn

from .. import _worker
from ._tasks import MAX_TRIES, Flight, FlightRefused, Result, Task
from ._yaml import CampaignError

CONNECT_S, RECONNECT_S, NO_WORKER_S, POLL_S = 5.0, 60.0, 60.0, 0.5
PER_THREAD = 3  #: Tasks at a scheduler for each thread of its workers.
#: A task is as many flights as take so long together: scheduler and campaign need some milliseconds for each task, however short.
TASK_S, MAX_FLIGHTS = 0.5, 64


class _Lost(Exception):
    """The scheduler has gone, with all that it knew."""


class Cluster:
    """A scheduler that runs already. One that is restarted gets all flights again that had no result."""

    def __init__(self, address: str):
        try:
            import distributed
        except ImportError:
            raise CampaignError("--dask: found no distributed, allowed with pip install '.[dask]'") from None
        self._distributed: Any = distributed
        self._address = address
        for name in ("distributed", "distributed.client"):  # the second has a level of its own
            logging.getLogger(name).setLevel(logging.CRITICAL)
        self._client: Any = self._connect(CONNECT_S)
        self._size = 1  #: Flights of a task.

    def _connect(self, timeout_s: float) -> Any:
        try:
            return self._distributed.Client(self._address, timeout=timeout_s, set_as_default=False)
        except (OSError, asyncio.TimeoutError, ValueError) as error:
            reason = " ".join(str(error).split())[:100]
            raise CampaignError(f"--dask: found no scheduler at '{self._address}' ({reason}), allowed the address of one that runs, such as "
                                "tcp://host:8786") from None

    def close(self) -> None:
        try:
            self._client.close(timeout=1)
        except (OSError, asyncio.TimeoutError):
            pass

    def results(self, tasks: Iterable[tuple[int, Task]]) -> Generator[tuple[int, Result], None, None]:
        """The results of the tasks, which have their seeds, as they come."""
        waiting = (Flight(seed, task) for seed, task in tasks)
        again: deque[Flight] = deque()
        flying: dict[Any, list[Flight]] = {}
        while True:
            try:
                yield from self._fly(waiting, again, flying)
                return
            except _Lost:
                again.extend(flight for flights in flying.values() for flight in flights)
                flying.clear()
                self._reconnect()

    def _reconnect(self) -> None:
        self.close()
        until = time.monotonic() + RECONNECT_S
        while True:
            try:
                self._client = self._connect(CONNECT_S)
                return
            except CampaignError:
                if time.monotonic() > until:
                    raise
                time.sleep(POLL_S)

    def _fly(self, waiting: Iterator[Flight], again: deque[Flight], flying: dict[Any, list[Flight]]) -> Iterator[tuple[int, Result]]:
        idle_since = time.monotonic()
        while True:
            threads = self._threads()
            if threads:
                idle_since = time.monotonic()
            elif time.monotonic() - idle_since > NO_WORKER_S:
                raise CampaignError(f"--dask: found a scheduler without workers for {NO_WORKER_S:g} s, allowed at least one worker")
            while len(flying) < PER_THREAD * threads:
                # One that was lost goes alone: if it is the cause it takes no others with it.
                flights = [again.popleft()] if again else list(islice(waiting, self._size))
                if not flights:
                    break
                self._submit(flights, flying)
            if not flying and threads:
                return
            for future in self._ended(flying):
                flights = flying.pop(future)
                results = self._results(future, flights)
                future.release()  # else the scheduler has it computed again when its worker ends
                for flight, result in zip(flights, results):
                    if result is None:
                        again.append(flight)
                    else:
                        yield flight.seed, result

    def _threads(self) -> int:
        if self._client.status != "running":
            raise _Lost
        try:
            return sum(self._client.nthreads().values())
        except (OSError, asyncio.TimeoutError):
            raise _Lost from None

    def _submit(self, flights: list[Flight], flying: dict[Any, list[Flight]]) -> None:
        future = self._client.submit(_worker.fly_as, _worker.program(), [flight.task["arguments"] for flight in flights], pure=False)
        flying[future] = flights

    def _ended(self, flying: dict[Any, list[Flight]]) -> list[Any]:
        if flying:
            try:
                with self._client.as_current():
                    self._distributed.wait(list(flying), timeout=POLL_S, return_when="FIRST_COMPLETED")
            except asyncio.TimeoutError:
                pass
            except (OSError, self._distributed.CancelledError):
                raise _Lost from None
        else:
            time.sleep(POLL_S)
        return [future for future in flying if future.status != "pending"]

    def _results(self, future: Any, flights: list[Flight]) -> Iterable[Result | None]:
        """None: to be flown again."""
        if future.status == "finished":
            try:
                took_s, answers = future.result(timeout=CONNECT_S)
            except (OSError, asyncio.TimeoutError, self._distributed.CancelledError):
                return [None] * len(flights)  # its worker has gone since
            self._size = max(1, min(MAX_FLIGHTS, round(TASK_S * len(flights) / max(took_s, 1e-6))))
            return (self._result(flight, answer) for flight, answer in zip(flights, answers))
        if future.status == "error":
            self._failed(future.exception(), flights)
        return [None] * len(flights)

    def _result(self, flight: Flight, answer: dict[str, Any]) -> Result | None:
        if "refused" in answer:
            raise FlightRefused(flight.seed, answer["refused"])
        if "failed" in answer:
            _count_failure(flight, answer["failed"])
            return None
        result: Result = answer["result"]
        return result

    def _failed(self, error: BaseException, flights: list[Flight]) -> None:
        """Returns if the flights are to be flown again."""
        if isinstance(error, (ImportError, _worker.OtherProgram)):
            _refuse_worker(error)
        if len(flights) == 1:  # of more the cause is not known yet
            _count_failure(flights[0], str(error))


def _count_failure(flight: Flight, error: str) -> None:
    flight.tries += 1
    if flight.tries >= MAX_TRIES:
        raise CampaignError(f"seed {flight.seed}: failed {MAX_TRIES} times on the cluster: {' '.join(error.split())[:200]}")


def _refuse_worker(error: BaseException) -> NoReturn:
    raise CampaignError(f"--dask: found a worker that cannot fly this ({' '.join(str(error).split())}), allowed workers with this package")
