# SPDX-License-Identifier: BSD-3-Clause
"""A machine that has too much to do."""

import contextlib
import os
import subprocess
import sys

LOOPS_PER_PROCESSOR = 4


@contextlib.contextmanager
def busy():
    """Programs that want all processors."""
    loops = [subprocess.Popen([sys.executable, "-c", "while True: pass"])
             for _ in range(LOOPS_PER_PROCESSOR * len(os.sched_getaffinity(0)))]
    try:
        yield
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()
