# SPDX-License-Identifier: BSD-3-Clause
"""Processor time of all that ./rosflight fly compiles, on an empty cache.

The figure build.flight_cpu_s of ./rosflight bench build. For another commit, measured the same way:

    .venv/bin/python3 tools/bench_build.py COMMIT
"""

import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import project

TARGET = "rosflight"


def flight_cpu_s(source: Path = project.ROOT) -> float:
    """User and system time of compilers, generators, archiver and linker, without ccache."""
    made = subprocess.run(["bash", "tools/ready.sh", "build", "release", "build.ninja"], cwd=source,
                          capture_output=True, text=True)
    if made.returncode:
        raise RuntimeError(last_line(made.stderr))
    options = [line for line in (source / "build/release/CMakeCache.txt").read_text().splitlines()
               if line.startswith(("ROSFLIGHT_PRECOMPILE:", "ROSFLIGHT_QUICK_BUILD:"))]
    with tempfile.TemporaryDirectory() as scratch:
        configured = subprocess.run(
            ["cmake", "--preset", "release", "-B", scratch, "-DCMAKE_C_COMPILER_LAUNCHER=",
             "-DCMAKE_CXX_COMPILER_LAUNCHER=", *(f"-D{option}" for option in options)],
            cwd=source, capture_output=True, text=True)
        if configured.returncode:
            raise RuntimeError(last_line(configured.stderr))
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        built = subprocess.run(["ninja", "-C", scratch, TARGET], capture_output=True, text=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if built.returncode:
            raise RuntimeError(last_line(built.stdout))
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def last_line(said: str) -> str:
    return (said.strip().splitlines() or ["it printed nothing"])[-1]


def of_commit(commit: str) -> float:
    with tempfile.TemporaryDirectory() as scratch:
        subprocess.run(["git", "clone", "-q", str(project.ROOT), scratch], check=True)
        subprocess.run(["git", "-C", scratch, "checkout", "-q", commit], check=True)
        (Path(scratch) / ".venv").symlink_to(project.ROOT / ".venv")  # commits before .venv-build generate with it
        return flight_cpu_s(Path(scratch))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__.strip())
    print(f"{of_commit(sys.argv[1]):.0f} s")
