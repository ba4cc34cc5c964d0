# SPDX-License-Identifier: BSD-3-Clause
"""Processes on this machine that fly. One that ends early is replaced, and its flight is flown again."""

from __future__ import annotations

import json
import os
import selectors
import signal
import subprocess
import sys
from collections import deque
from collections.abc import Generator, Iterable
from typing import Any

from ._tasks import MAX_KILLS, MAX_TRIES, Flight, FlightRefused, Result, Task
from ._yaml import CampaignError


class _Process:
    def __init__(self) -> None:
        # Ctrl-C is for the campaign, which ends its workers: here the signal stays blocked.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            self._process = subprocess.Popen([sys.executable, "-m", "rosflight._worker"], stdin=subprocess.PIPE,
                                             stdout=subprocess.PIPE, bufsize=0)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        self.flight: Flight | None = None
        self._answer = b""

    @property
    def out(self) -> int:
        assert self._process.stdout is not None
        return self._process.stdout.fileno()

    def start(self, flight: Flight) -> None:
        self.flight = flight
        flight.tries += 1
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(json.dumps(flight.task).encode() + b"\n")
        except BrokenPipeError:
            pass  # it has ended, as its output will show

    def read(self) -> dict[str, Any] | None:
        """An answer, if it is whole. Raises EOFError once the process has ended."""
        piece = os.read(self.out, 1 << 16)
        if not piece:
            raise EOFError
        self._answer += piece
        if not self._answer.endswith(b"\n"):
            return None
        whole, self._answer = self._answer, b""
        answer: dict[str, Any] = json.loads(whole)
        return answer

    def end(self) -> int:
        self._process.kill()
        for pipe in (self._process.stdin, self._process.stdout):
            assert pipe is not None
            pipe.close()
        return self._process.wait()


def results(tasks: Iterable[tuple[int, Task]], count: int) -> Generator[tuple[int, Result], None, None]:
    """The results of the tasks, which have their seeds, as they come. The processes end with the iterator."""
    waiting = iter(tasks)
    again: deque[Flight] = deque()

    def following() -> Flight | None:
        if again:
            return again.popleft()
        new = next(waiting, None)
        return None if new is None else Flight(*new)

    def occupy() -> None:
        """Gives each idle process a flight, and starts as many as are needed."""
        idle = [process for process in processes if process.flight is None]
        while idle or len(processes) < count:
            flight = following()
            if flight is None:
                return
            process = idle.pop() if idle else _Process()
            if process not in processes:
                processes.append(process)
                selector.register(process.out, selectors.EVENT_READ, process)
            process.start(flight)

    processes: list[_Process] = []
    with selectors.DefaultSelector() as selector:
        try:
            occupy()
            while any(process.flight for process in processes):
                for key, _ in selector.select():
                    process: _Process = key.data
                    flight = process.flight
                    try:
                        answer = process.read()
                    except EOFError:
                        selector.unregister(process.out)
                        processes.remove(process)
                        _lost(flight, process.end())
                        if flight:
                            again.append(flight)
                        continue
                    if answer is not None and flight is not None:
                        process.flight = None
                        yield flight.seed, _result(flight.seed, answer)
                occupy()
        finally:
            for process in processes:
                process.end()


def _lost(flight: Flight | None, status: int) -> None:
    """@param status  of the process. One that was killed from outside says little about its flight."""
    allowed = MAX_KILLS if status in (-signal.SIGKILL, -signal.SIGTERM) else MAX_TRIES
    if flight and flight.tries >= allowed:
        how = f"by signal {-status}" if status < 0 else f"with status {status}"
        raise CampaignError(f"seed {flight.seed}: the process that flies it ended {flight.tries} times, the last time {how}")


def _result(seed: int, answer: dict[str, Any]) -> Result:
    if "refused" in answer:
        raise FlightRefused(seed, answer["refused"])
    if "failed" in answer:
        raise OSError(answer["failed"])
    result: Result = answer["result"]
    return result
