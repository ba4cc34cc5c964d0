# SPDX-License-Identifier: BSD-3-Clause
"""When a node is up.

A node is up when it has printed a line whose message begins with `ready`, as all of ours do once their
topics and services are there; or when its name can be seen in the ROS graph, for nodes of others. One
whose message begins with `not ready` does something first that the launch is to wait for: it is up when it
has said `ready`, or has finished. What stands on the command line as `executable` is up when it runs.
"""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

_READY = re.compile(r"(^|\]: )ready\b(: (?P<nodes>\d+) nodes)?")
_NOT_READY = re.compile(r"(^|\]: )not ready\b")


def says_ready(line: str) -> int:
    """How many nodes are up according to the line; 0: it has no such number."""
    found = _READY.search(line)
    return int(found["nodes"] or 1) if found else 0


def says_not_ready(line: str) -> bool:
    return _NOT_READY.search(line) is not None


class GraphWatch:
    """A process of its own that looks at the graph, so that this one needs no ROS.

    It is started only while somebody is silent, and reports full names of nodes, one JSON list a line.
    """

    def __init__(self):
        self._process: subprocess.Popen | None = None
        self._failed = False
        self._rest = b""

    @property
    def pid(self) -> int | None:
        return self._process.pid if self._process else None

    def seen(self) -> set[str]:
        """Names of nodes that came up since the last call."""
        if self._failed:
            return set()
        if self._process is None:
            script = Path(__file__).with_name("graph_watch.py")
            self._process = subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE,
                                             stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL)
            os.set_blocking(self._process.stdout.fileno(), False)
        try:
            data = self._process.stdout.read() or b""
        except BlockingIOError:
            data = b""
        if not data and self._process.poll() is not None:
            self.stop()
            self._failed = True
        *lines, self._rest = (self._rest + data).split(b"\n")
        return {name for line in lines for name in json.loads(line)}

    def stop(self) -> None:
        if self._process is None:
            return
        self._process.kill()
        self._process.wait()
        self._process.stdout.close()
        self._process = None
