# SPDX-License-Identifier: BSD-3-Clause
"""Starts the processes of a plan, passes their lines on, and ends them all.

One thread: a loop over the pipes of all processes. Processes stay in the launch's process group, so a
node may read the terminal; what they start themselves is found as descendants (this process adopts
orphans) and ended with them. If the launch itself is killed, the kernel ends its nodes.
"""

import ctypes
import os
import selectors
import signal
import subprocess
import sys
import time
from collections import deque
from dataclasses import dataclass, field
from pathlib import Path

import yaml

from .plan import Node, Plan
from .ready import GraphWatch, says_not_ready, says_ready

_LAST_LINES = 12
_TICK_S = 0.05
_GRAPH_AFTER_S = 1.0
_LONGEST_LINE = 100_000
_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER = 1, 36
_LIBC = ctypes.CDLL(None, use_errno=True)


@dataclass
class Times:
    """How long the launch waits [s]."""

    ready_s: float = 20.0  # before it names those that are not up
    interrupt_s: float = 5.0  # after SIGINT
    terminate_s: float = 2.0  # after SIGTERM


@dataclass
class Running:
    node: Node
    process: subprocess.Popen
    last: deque = field(default_factory=lambda: deque(maxlen=_LAST_LINES))
    rest: bytes = b""
    up: bool = False
    said_ready: bool = False
    has_work: bool = False  # printed `not ready`: the graph does not count
    nodes: int = 1  # in this process
    ended: bool = False


class Runner:
    def __init__(self, plan: Plan, scratch: Path, times: Times | None = None, out=None):
        self._plan = plan
        self._scratch = scratch
        self._times = times or Times()
        self._out = out or sys.stdout
        self._selector = selectors.DefaultSelector()
        self._running: list[Running] = []
        self._graph = GraphWatch()
        self._asked: int | None = None  # signal that asked for the end
        self._said_ready = False
        self._said_late = False  # who is not up

    def run(self) -> int:
        """0: asked to stop, or all finished well; 1: something died; 2: a node refused what it was given. The last line says
        which."""
        _LIBC.prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
        before = {number: signal.signal(number, self._on_signal)
                  for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
        died: Running | None = None
        start = time.monotonic()
        try:
            for node in self._plan.nodes:
                if self._asked is None:
                    self._running.append(self._start(node))
            while self._asked is None and died is None and not self._all_ended():
                self._pump(_TICK_S)
                died = self._look_for_dead()
                if died is None:
                    self._look_for_ready(time.monotonic() - start)
            if died is not None and not _refused(died):
                self._report(died)
        finally:
            self._graph.stop()
            self._stop_all()
            for number, handler in before.items():
                signal.signal(number, handler)
        if died is None:
            return 0
        if not _refused(died):
            self._say(f"launch: {_end_of(died)}")
            return 1
        last = next((line for line in reversed(died.last) if line.strip()), "(no output)")
        self._say(f"launch: {died.node.name} ({died.node.what}) refused to start: {last}")
        return 2

    def _on_signal(self, number: int, _frame: object) -> None:
        self._asked = number

    def _say(self, text: str) -> None:
        print(text, file=self._out, flush=True)

    # ---- starting -------------------------------------------------------------------------------

    def _start(self, node: Node) -> Running:
        environment = {**os.environ, "PYTHONUNBUFFERED": "1", **node.environment}
        try:
            process = subprocess.Popen(self._command(node), stdin=subprocess.DEVNULL,
                                       stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                       env=environment, preexec_fn=_end_with_parent)
        except OSError as why:
            self._say(f"launch: {node.name} ({node.what}, {node.where}) does not start: "
                      f"{why.strerror}")
            process = subprocess.Popen(["false"], stdout=subprocess.PIPE)
        running = Running(node, process)
        os.set_blocking(process.stdout.fileno(), False)
        self._selector.register(process.stdout, selectors.EVENT_READ, running)
        return running

    def _command(self, node: Node) -> list[str]:
        command = list(node.command)
        if not node.is_ros:
            return command
        ros = list(node.ros_arguments)
        if node.node_name:
            ros += ["-r", f"__node:={node.node_name}"]
        if node.namespace:
            ros += ["-r", f"__ns:={'/' + node.namespace.strip('/')}"]
        for number, source in enumerate(node.parameters):
            if isinstance(source, str):
                ros += ["-p", source]
                continue
            if isinstance(source, dict):
                file = self._scratch / f"{len(self._running)}_{number}.yaml"
                file.write_text(yaml.safe_dump({"/**": {"ros__parameters": source}}))
                source = file
            ros += ["--params-file", str(source)]
        for name, to in node.remappings:
            ros += ["-r", f"{name}:={to}"]
        return command + (["--ros-args", *ros] if ros else [])

    # ---- running --------------------------------------------------------------------------------

    def _pump(self, timeout: float) -> None:
        for key, _ in self._selector.select(timeout):
            self._read(key.data)

    def _read(self, running: Running) -> None:
        try:
            data = os.read(running.process.stdout.fileno(), 65536)
        except BlockingIOError:
            return
        if not data:
            self._selector.unregister(running.process.stdout)
            running.process.stdout.close()
            data = b"\n" if running.rest else b""
        *lines, running.rest = (running.rest + data).split(b"\n")
        if len(running.rest) > _LONGEST_LINE:
            lines, running.rest = [*lines, running.rest], b""
        for line in lines:
            self._line(running, line.decode(errors="replace").rstrip("\r"))

    def _line(self, running: Running, text: str) -> None:
        running.last.append(text)
        if not running.said_ready and (nodes := says_ready(text)):
            running.up = running.said_ready = True
            running.nodes = nodes
            return  # the launch prints `ready` once, for all
        elif not running.said_ready and says_not_ready(text):
            running.up, running.has_work = False, True
        self._say(f"[{running.node.name}] {text}")

    def _look_for_dead(self) -> Running | None:
        """Who ended and should not have. A job that never printed `ready` may end with 0."""
        for running in self._running:
            if running.ended or running.process.poll() is None:
                continue
            self._drain(running)
            running.ended = running.up = True
            if running.process.returncode != 0 or running.said_ready:
                return running
            if not running.has_work:  # else it was waited for, and `ready` means that it is done
                self._say(f"launch: {running.node.name} has finished")
        return None

    def _drain(self, running: Running) -> None:
        end = time.monotonic() + 0.5  # a child of it may hold the pipe open
        while not running.process.stdout.closed and time.monotonic() < end:
            self._pump(0.01)

    def _look_for_ready(self, seconds: float) -> None:
        if self._said_ready:
            return
        for running in self._running:
            running.up = running.up or not running.node.is_ros
        silent = [running for running in self._running if not running.up and not running.has_work]
        if silent and seconds > _GRAPH_AFTER_S:
            seen = self._graph.seen()
            for running in silent:
                running.up = running.node.full_name in seen
        missing = [running.node.name for running in self._running if not running.up]
        if not missing:
            self._said_ready = True
            self._graph.stop()
            count = sum(running.nodes for running in self._running)
            self._say(f"ready: {count} node{'' if count == 1 else 's'} in {seconds:.1f} s")
        elif seconds > self._times.ready_s and not self._said_late:
            self._said_late = True
            self._say(f"launch: not up after {seconds:.0f} s: {', '.join(missing)}")

    def _all_ended(self) -> bool:
        return all(running.ended for running in self._running)

    def _report(self, died: Running) -> None:
        self._say(f"launch: {_end_of(died)}; its last lines:")
        for line in died.last or ["(none)"]:
            self._say(f"    {line}")

    # ---- stopping -------------------------------------------------------------------------------

    def _stop_all(self) -> None:
        # A terminal has signalled all of its foreground processes already; a second signal breaks
        # what they do at their end.
        if self._asked != signal.SIGINT or not _in_foreground():
            self._tell(signal.SIGINT, [r.process.pid for r in self._alive()])
        stages = ((self._times.interrupt_s, signal.SIGTERM), (self._times.terminate_s, signal.SIGKILL))
        for timeout, following in stages:
            self._wait(timeout)
            left = descendants()
            if not left:
                break
            if self._alive():
                names = ", ".join(running.node.name for running in self._alive())
                self._say(f"launch: {names} still there, sending {following.name}")
            self._tell(following, left)
        self._wait(self._times.terminate_s)
        _take_exit_codes_of_adopted()
        self._selector.close()

    def _alive(self) -> list[Running]:
        return [running for running in self._running if running.process.poll() is None]

    def _wait(self, timeout: float) -> None:
        """Until every node has ended, but not for what they left behind."""
        end = time.monotonic() + timeout
        while time.monotonic() < end and self._alive():
            self._pump(_TICK_S)
        for running in self._running:
            if running.process.poll() is not None:
                self._drain(running)

    @staticmethod
    def _tell(number: signal.Signals, pids: list[int]) -> None:
        for pid in pids:
            try:
                os.kill(pid, number)
            except ProcessLookupError:
                pass


def _end_of(died: Running) -> str:
    code = died.process.returncode
    how = f"exit code {code}" if code >= 0 else f"signal {-code} ({_signal_name(-code)})"
    return f"{died.node.name} ({died.node.what}) ended with {how}"


def _refused(died: Running) -> bool:
    """Exit code 2 before it was ready: its input is wrong, and its last line shows how."""
    return died.process.returncode == 2 and not died.said_ready


def _end_with_parent() -> None:
    _LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGTERM, 0, 0, 0)


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return "unknown"


def _in_foreground() -> bool:
    try:
        with open("/dev/tty", "rb") as terminal:
            return os.tcgetpgrp(terminal.fileno()) == os.getpgrp()
    except OSError:
        return False


def _take_exit_codes_of_adopted() -> None:
    """Lets the dead go whose parents have gone. Our own nodes have been waited for by now."""
    end = time.monotonic() + 1.0
    while time.monotonic() < end:
        try:
            pid, _ = os.waitpid(-1, os.WNOHANG)
        except ChildProcessError:
            return
        if pid == 0:
            time.sleep(0.01)


def descendants() -> list[int]:
    """All processes below this one, parents before children; zombies do not count."""
    children: dict[int, list[int]] = {}
    dead = set()
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            fields = (entry / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        children.setdefault(int(fields[1]), []).append(int(entry.name))
        if fields[0] in "ZX":
            dead.add(int(entry.name))
    found: list[int] = []
    parents = [os.getpid()]
    while parents:
        parents = [child for parent in parents for child in children.get(parent, [])]
        found += parents
    return [pid for pid in found if pid not in dead]
