# SPDX-License-Identifier: BSD-3-Clause
"""Instructions that one call costs, counted by valgrind's callgrind."""

import re
import subprocess
import tempfile
from pathlib import Path


def instructions(command: list[str]) -> int:
    """Instructions that a program executes from start to end."""
    with tempfile.TemporaryDirectory() as scratch:
        profile = Path(scratch) / "profile"
        done = subprocess.run(
            ["valgrind", "--tool=callgrind", f"--callgrind-out-file={profile}", *command],
            capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"{command[0]} ended with {done.returncode} under callgrind: "
                               f"{(done.stderr.strip().splitlines() or [''])[-1]}")
        return total(profile.read_text())


def total(profile: str) -> int:
    """The sum over the program, from a profile's "totals:" line, "summary:" in older versions."""
    match = re.search(r"^(?:totals|summary):\s*(\d+)", profile, re.M)
    if match is None:
        raise RuntimeError("callgrind's profile has no totals")
    return int(match[1])


def instructions_by_call(command: list[str], function: str) -> list[int]:
    """Instructions of each call of a C function, in the order of the calls; nothing else counts."""
    with tempfile.TemporaryDirectory() as scratch:
        profile = Path(scratch) / "profile"
        done = subprocess.run(
            ["valgrind", "--tool=callgrind", f"--callgrind-out-file={profile}",
             f"--toggle-collect={function}", f"--dump-after={function}", *command],
            capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"{command[0]} ended with {done.returncode} under callgrind: "
                               f"{(done.stderr.strip().splitlines() or [''])[-1]}")
        # One dump after each call, numbered from 1; the file without a number is from the end.
        dumps = sorted(Path(scratch).glob("profile.*"), key=lambda dump: int(dump.suffix[1:]))
        if not dumps:
            raise RuntimeError(f"{command[0]} never called {function}")
        return [total(dump.read_text()) for dump in dumps]


def instructions_per_call(command: list[str], few: int, many: int) -> float:
    """Difference of two run lengths, so that start, warm-up and end drop out.

    The program takes the number of calls as its last argument.
    """
    counts = [instructions([*command, str(calls)]) for calls in (few, many)]
    return (counts[1] - counts[0]) / (many - few)
