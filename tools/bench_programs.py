# SPDX-License-Identifier: BSD-3-Clause
"""Runs the programs that ./rosflight bench measures, and reads their numbers.

Most stand under bench/; what they take and print stands in bench/README.md. What several figures read is run once.
"""

import functools
import json
import re
import resource
import statistics
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Callable

import callgrind
import project
import python_package
import stages

RELEASE = project.ROOT / "build" / "release"
FUZZ_RUNS = 1_000_000
# Bytes that reach the firmware in flight from devices which anybody may connect. An input has room for several frames: ten of
# S.Bus, four of CRSF at their longest, two solutions of UBX.
FUZZ_RUNS_OF = dict.fromkeys(("fuzz_parts_sbus", "fuzz_parts_crsf", "fuzz_parts_ubx"), 10_000_000)
FUZZ_BYTES_OF = dict.fromkeys(FUZZ_RUNS_OF, 256)
STORM_PASSES = 60
PROPERTY_FLIGHTS = 25_000  # of 4000 passes each
SEEDS = 5000  # of each vehicle
RANDOM_FLIGHTS = 500


def prepare(preset: str):
    """Builds what the figures run. What does not build fails where it is measured."""
    if preset == "none":
        return
    if preset == "release":
        project.build("release", "bench/all", keep_going=True)
        project.build("release", "rosflight", keep_going=True)
    elif preset == "gazebo":
        project.build("release", "rosflight", "bench/worlds", keep_going=True)
        stages.gazebo_engine()
        environment(".venv-jsbsim", "tools/requirements-jsbsim.txt")
    elif preset == "sanitizers":
        project.build(preset, "bench/properties", keep_going=True)
    elif preset == "cortex-m7":
        project.build("release", "rosflight", "h7_emulator", keep_going=True)
        project.build(preset, keep_going=True)
    else:
        raise ValueError(f"preset: found {preset}, allowed none, release, gazebo, sanitizers, cortex-m7")


def environment(name: str, requirements: str):
    """A Python environment of its own, made where it is missing."""
    subprocess.run(["bash", str(project.ROOT / "tools/ready.sh"), "environment", name, requirements], check=True)


def program(name: str, folder: str = "bench") -> str:
    path = RELEASE / folder / name
    target = f"{folder}/{name}"
    if not path.is_file() or not project.is_up_to_date("release", target):
        raise RuntimeError(f"{target} does not build, see build/release/build.log")
    return str(path)


def run_json(command: list[str], ending: tuple[int, ...] = (0,)) -> dict:
    """What a program prints on stdout, as JSON."""
    done = subprocess.run(command, cwd=project.ROOT, capture_output=True, text=True)
    if done.returncode not in ending:
        last = (done.stderr.strip().splitlines() or ["it printed nothing"])[-1]
        raise RuntimeError(f"{command[0]} ended with {done.returncode}: {last}")
    try:
        return json.loads(done.stdout)
    except json.JSONDecodeError as error:
        raise RuntimeError(f"{command[0]} printed no JSON: {error}") from None


def number(printed: dict, key: str) -> float:
    value = printed.get(key)
    if not isinstance(value, (int, float)) or isinstance(value, bool):
        raise RuntimeError(f"no number '{key}' among {', '.join(printed) or 'nothing'}")
    return value


@functools.cache
def firmware_pass(protocol: str = "mavlink", load: str = "hover") -> float:
    return callgrind.instructions_per_call(
        [program("firmware_pass"), "--link-protocol", protocol, "--load", load, "--passes"],
        few=4_000, many=20_000)


def loop_steps(kind: str) -> float:
    """A step of 2.5 ms between 15 and 25 s of simulated time, the vehicle in flight."""
    return callgrind.instructions_per_call([program("loop_steps"), kind, "--steps"], few=6_000, many=10_000)


def setup_share() -> float:
    """Setting up the n-th flight of a campaign over setting up the first one, each flight with other conditions."""
    command = [program("loop_steps"), "setup", "--steps"]
    return callgrind.instructions_per_call(command, few=8, many=40) / callgrind.instructions_per_call(command, few=0, many=1)


def inference() -> float:
    return callgrind.instructions_per_call([program("inference"), "--count"], few=100, many=1_000)


def worst_over_mean() -> float:
    """The dearest pass of a storm in which everything comes at once, over the mean of the full load."""
    storm = callgrind.instructions_by_call(
        [program("firmware_pass"), "--load", "storm", "--passes", str(STORM_PASSES)],
        "bench_counted_pass")
    return max(storm) / firmware_pass(load="full")


@functools.cache
def properties() -> dict:
    """Random flights under sanitizers, a share on each processor. What did not hold stands in build/properties.log."""
    path = project.ROOT / "build" / "sanitizers" / "bench" / "properties"
    if not path.is_file() or not project.is_up_to_date("sanitizers", "bench/properties"):
        raise RuntimeError("bench/properties does not build, see build/sanitizers/build.log")
    share = PROPERTY_FLIGHTS // project.jobs() + 1
    log = (project.ROOT / "build" / "properties.log").open("w")
    running = [subprocess.Popen([str(path), "--first", str(1 + k * share), "--flights", str(share)],
                                stdout=subprocess.PIPE, stderr=log, text=True)
               for k in range(project.jobs())]
    printed = [json.loads(process.communicate()[0] or "{}") for process in running]
    return {key: sum(number(one, key) for one in printed) for key in ("passes", "violations")}


def link_rate(protocol: str) -> float:
    """Telemetry of the default flight, board to companion."""
    return number(run_json([program("link_rate"), protocol]), "bytes_per_s")


@functools.cache
def loop_runs() -> list[dict]:
    command = [program("loop")]
    return [run_json(command) for _ in range(5)]


def loop_factor(key: str) -> float:
    return statistics.median(number(printed, key) for printed in loop_runs())


def dart_realtime_factor() -> float:
    """Simulated seconds in a second of processor time of both processes, which take turns; the start of the engine is in neither:
    a long flight less a short one, the least of nine of each, because other work on the machine only adds."""
    (long_s, long_cpu_s), (short_s, short_cpu_s) = (_dart_flight(mission) for mission in ("default", "hop"))
    return (long_s - short_s) / (long_cpu_s - short_cpu_s)


def _dart_flight(mission: str) -> tuple[float, float]:
    """Simulated seconds of a flight, and the processor time of both processes."""
    cpu_s = []
    for _ in range(9):
        with tempfile.TemporaryDirectory() as folder:
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            printed = run_json([program("rosflight", "apps"), "fly", "--physics", "gazebo", "--mission", mission, "--no-log", "--json",
                                "--out", f"{folder}/flight"])
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
        cpu_s.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return number(printed, "sim_time_s"), min(cpu_s)


def log_share() -> float:
    """Speed of `fly` over that of `fly --no-log`, which keeps what the report shows: processor time of all threads."""
    return statistics.median(number(printed, "realtime_factor_log") / number(printed, "realtime_factor_no_log")
                             for printed in loop_runs())


@functools.cache
def estimation() -> dict:
    return run_json([program("estimation")])


def estimation_figure(noise: str, quantity: str) -> float:
    return number(estimation()[noise], quantity)


@functools.cache
def missions() -> dict:
    return run_json([program("missions")])


@functools.cache
def fixedwing_missions() -> dict:
    return run_json([program("missions_fixedwing")])


def mission_figure(name: str, quantity: str) -> float:
    flown = fixedwing_missions() if name.startswith("fixedwing_") else missions()
    return number(flown[name], quantity)


def wind_limit(vehicle: str) -> float:
    return number(run_json([program("wind_limits"), vehicle])[vehicle], "wind_limit_m_s")


@functools.cache
def faults() -> dict:
    """Every flight of the fault campaign. The matrix goes to the terminal, to build/faults.csv and to its page."""
    build = project.ROOT / "build"
    printed = run_json([program("faults"), "--text", str(build / "faults.txt"), "--csv", str(build / "faults.csv"),
                        "--page", str(project.ROOT / "docs" / "fault-matrix.md")])
    print((build / "faults.txt").read_text(), flush=True)
    return printed


@functools.cache
def random_faults() -> dict:
    """Random flights with faults. How they ended goes to the terminal and to build/random_faults.csv."""
    build = project.ROOT / "build"
    printed = run_json([program("faults"), "--random", str(RANDOM_FLIGHTS), "--seed", "1",
                        "--text", str(build / "random_faults.txt"), "--csv", str(build / "random_faults.csv")])
    print((build / "random_faults.txt").read_text(), flush=True)
    return printed


def seeds_failed() -> int:
    """Default missions of both vehicles in 6 m/s of wind with gusts that did not end with the mission done."""
    flown = stages.add(stages.gusty_seeds(vehicle, SEEDS) for vehicle in ("multirotor", "anaconda"))
    print("\n".join(flown.complaints), flush=True)
    return flown.failed


@functools.cache
def sizes() -> dict:
    return run_json([program("sizes")])


def size(key: str) -> float:
    return number(sizes(), key)


@functools.cache
def fly_runs() -> list[tuple[float, dict]]:
    """Wall time and summary of the default flight, three times; it must succeed to count."""
    runs = []
    for _ in range(3):
        with tempfile.TemporaryDirectory() as scratch:
            start = time.monotonic()
            printed = run_json([program("rosflight", "apps"), "fly", "--json", "--out", f"{scratch}/flight"])
            runs.append((time.monotonic() - start, printed))
        if printed.get("success") is not True:
            raise RuntimeError("the flight did not succeed")
    return runs


def fly_wall_s() -> float:
    return statistics.median(wall for wall, _ in fly_runs())


def counted(*names: str) -> float:
    """Sum of what the firmware counted in the default flight."""
    counters = fly_runs()[0][1].get("counters") or {}
    values = [counters.get(name) for name in names]
    if None in values:
        raise RuntimeError(f"no counters {names} in the summary of the flight")
    return float(sum(sum(value) if isinstance(value, list) else value for value in values))


@functools.cache
def demo(*words: str):
    with tempfile.TemporaryDirectory() as scratch:
        return run_json([str(project.ROOT / "rosflight"), "ros", "demo", *words, "--json", "--out", scratch])


def round_trip(path: str, quantity: str, fastest: bool = False) -> float:
    """A number of one row of the table of ./rosflight ros demo rtt. The fastest rate counts without loss only."""
    rows = demo("rtt", "--link", "udp", "--count", "20000")
    row = next(row for row in rows if row["path"] == path and row["load"] == "idle"
               and (row["wanted_hz"] is None) == fastest)
    if fastest and row["lost"]:
        raise RuntimeError(f"{row['lost']} of {row['sent']} commands were lost at full speed")
    return number(row, quantity)


def ros_factor(quantity: str, composed: bool) -> float:
    """Real-time factor of the launched simulator and roscopter, and wake-ups of their threads for each step of the world."""
    row, = (row for row in demo("factor") if row["composed"] == composed)
    return number(row, quantity)


def ready_python():
    if subprocess.run(["bash", str(project.ROOT / "tools/ready.sh"), "python"]).returncode:
        raise RuntimeError("the Python package does not build, see build/.ready/python.log")


@functools.cache
def learned(task: str, seed: int) -> dict:
    """How python/examples/ppo.py learns a task: successes of 100 episodes without noise, seconds of the clock and of the processor."""
    ready_python()
    with tempfile.TemporaryDirectory() as scratch:
        curve = Path(scratch) / "curve.csv"
        done = subprocess.run([str(python_package.PYTHON), "python/examples/ppo.py", task, "--seed", str(seed), "--csv", str(curve)],
                              cwd=project.ROOT, capture_output=True, text=True)
        judged = re.search(r"^(\d+) of 100 episodes without noise succeed$", done.stdout, re.MULTILINE)
        if done.returncode or judged is None:
            raise RuntimeError(f"ppo.py ended with {done.returncode}: {(done.stderr.strip().splitlines() or ['it printed nothing'])[-1]}")
        names, *_, last = curve.read_text().splitlines()
    return dict(zip(names.split(","), map(float, last.split(",")))) | {"successes": int(judged[1])}


def worst_learned(worst: Callable, task: str, quantity: str) -> float:
    """The worst of two seeds."""
    return worst(number(learned(task, seed), quantity) for seed in (1, 2))


def with_package(*words: str) -> dict:
    """What a program prints that is run in the environment of the Python package."""
    ready_python()
    return run_json([str(project.ROOT / "rosflight"), "python", *words])


@functools.cache
def scale() -> dict:
    """What bench/scale.py prints; without the other simulators where these cannot be installed."""
    try:
        environment(".venv-peers", "tools/requirements-peers.txt")
    except subprocess.CalledProcessError:
        return with_package("bench/scale.py")
    return with_package("bench/scale.py", str(project.ROOT / ".venv-peers/bin/python"))


@functools.cache
def cluster(what: str) -> dict:
    return with_package("bench/cluster.py", what)


def load(quantity: str):
    return demo("load", "--seconds", "600")[quantity]


def fuzz_target(name: str) -> int:
    return FUZZ_RUNS_OF.get(name, FUZZ_RUNS)


def fuzz_runs(name: str) -> float:
    """Inputs that one fuzzer tried; a finding is an error. Builds that fuzzer."""
    if not project.build("sanitizers", name):
        raise RuntimeError(f"{name} does not build, see build/sanitizers/build.log")
    limit = [f"-max_len={FUZZ_BYTES_OF[name]}"] if name in FUZZ_BYTES_OF else []
    runs, complaints = stages.run_fuzzer(name, f"-runs={fuzz_target(name)}", *limit)
    if complaints:
        raise RuntimeError("; ".join(complaints))
    return runs
