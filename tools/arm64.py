# SPDX-License-Identifier: BSD-3-Clause
"""The companion's computer: everything that is not ROS cross-built for arm64, its tests and flights under qemu-user."""

import concurrent.futures
import json
import subprocess
import tempfile
from pathlib import Path

import cpp_tests
import project
from cpp_tests import Outcome

PRESET = "arm64"
PARTS = {"autonomy", "firmware", "link", "sim"}
FLIGHTS = (["fly"], ["fly", "--vehicle", "anaconda"])
PROGRAM = "apps/rosflight"


def is_possible() -> bool:
    """Where apt finds arm64 packages beside the others: Debian. Ubuntu keeps them in a place of their own."""
    wanted = subprocess.run(["bash", "-c", 'source tools/ready.sh && wanted_packages arm64'], cwd=project.ROOT, capture_output=True,
                            text=True, check=True)
    return bool(wanted.stdout.split())


def run(rest: bool = False) -> Outcome:
    """Tests of what flies and of the world, and both default flights compared with those of this machine by the hash of their
    logs. REST: the other tests instead."""
    if not is_possible():
        print("   skipped: only Debian 12 has the arm64 packages that this needs")
        return Outcome()
    ready = subprocess.run(["bash", "tools/ready.sh", "packages", "run", "test", PRESET], cwd=project.ROOT)
    if ready.returncode or not project.build(PRESET, "build.ninja"):
        return Outcome(failed=1, complaints=["the arm64 build cannot be configured"])
    tests = [one for one in cpp_tests.find(PRESET) if one.part and (one.part in PARTS) != rest and not one.needs_emulator]
    names = [test.name for test in tests]
    if not names or not project.build(PRESET, "rosflight", *names, keep_going=True):
        return Outcome(failed=1, complaints=["does not build, all output is in build/arm64/build.log"])
    built = [one for one in cpp_tests.find(PRESET) if one.name in names]  # now with their commands
    outcomes = list(cpp_tests.run_all(built, project.ROOT / "build/test_results" / PRESET).values())
    if not rest:
        outcomes.append(_flights_agree())
    return Outcome(1 + sum(one.passed for one in outcomes), sum(one.failed for one in outcomes),
                   [line for one in outcomes for line in one.complaints])


def _flights_agree() -> Outcome:
    """One case for each flight: the log of the arm64 program has the hash of the one of this machine's."""
    if not project.build("release", "rosflight"):
        return Outcome(failed=1, complaints=["the program of this machine does not build"])
    release = [str(project.ROOT / "build/release" / PROGRAM)]
    arm64 = ["qemu-aarch64", str(project.ROOT / "build" / PRESET / PROGRAM)]
    with tempfile.TemporaryDirectory(prefix="rosflight_arm64_") as folder, \
            concurrent.futures.ThreadPoolExecutor(project.jobs()) as pool:
        flights = list(pool.map(lambda flight: [_log_hash(program, flight, Path(folder)) for program in (release, arm64)], FLIGHTS))
    complaints = [f"{' '.join(flight)}: log_sha256 {arm64} on arm64, {here} here"
                  for flight, (here, arm64) in zip(FLIGHTS, flights) if here is None or here != arm64]
    return Outcome(len(FLIGHTS) - len(complaints), len(complaints), complaints)


def _log_hash(program: list[str], flight: list[str], folder: Path) -> str | None:
    out = tempfile.mkdtemp(dir=folder)
    flown = subprocess.run([*program, *flight, "--json", "--out", f"{out}/flight"], capture_output=True, text=True)
    try:
        return json.loads(flown.stdout)["log_sha256"]
    except (ValueError, KeyError):
        print(flown.stderr[-2000:])
        return None
