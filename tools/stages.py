# SPDX-License-Identifier: BSD-3-Clause
"""The stages of ./rosflight test. Each runs by itself and returns what passed and what failed."""

import concurrent.futures
import csv
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import check_structure as structure
import check_text
import cpp_tests
import project
import pytest_files
import python_package
import ros_test
import tidy as clang_tidy
import web_test
from cpp_tests import Binary, Outcome
from project import ROOT

RESULTS = ROOT / "build" / "test_results"
SHORT_FUZZ = ("-max_total_time=6", "-runs=100000")


def _run(command: list[str], **options) -> subprocess.CompletedProcess:
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, **options)


def _check(complaints: list[str]) -> Outcome:
    """One check: it passes when there is nothing to complain about."""
    return Outcome(int(not complaints), int(bool(complaints)), complaints)


def add(outcomes) -> Outcome:
    total = Outcome()
    for outcome in outcomes:
        total.passed += outcome.passed
        total.failed += outcome.failed
        total.complaints += outcome.complaints
        total.skipped += outcome.skipped
    return total


# ---- checks of the text -------------------------------------------------------------------------


def check_format() -> Outcome:
    """C++ as .clang-format wants it, shell scripts as shellcheck does."""
    files = project.own_files()
    sources = [str(path) for path in files if path.suffix in (".cpp", ".hpp")]
    scripts = [str(path) for path in files if structure.is_shell(ROOT / path)]
    cpp = _run([str(ROOT / ".venv/bin/clang-format"), "--dry-run", "--Werror", *sources])
    shell = _run(["shellcheck", "-x", *scripts])
    unformatted = sorted({line.split(":")[0] for line in cpp.stderr.splitlines() if ": error:" in line})
    cpp_says = [f"{name}: not formatted; run .venv/bin/clang-format -i {name}" for name in unformatted]
    if cpp.returncode and not cpp_says:
        cpp_says = [cpp.stderr.strip()]
    return add([_check(cpp_says), _check(shell.stdout.splitlines() if shell.returncode else [])])


def check_structure() -> Outcome:
    """Who uses whom, names, sizes of files; words, equations and suffixes of frames in comments and documents."""
    return add(_check(found) for checks in (structure, check_text) for found in checks.run().values())


RELEASE, ROS, CORTEX_M7 = "build/release", "build/ros/build", "build/cortex-m7"
FLIES = {"autonomy", "companion", "config", "firmware", "link"}
# What no other compiler than the microcontroller's sees.
BOARDS = tuple(f"firmware/boards/{name}" for name in ("qemu_m7", "stm32h7", "pixracer_pro", "varmint"))
SANITIZED = FLIES | {"flight"}
EMULATOR = "h7_emulator"  # built by name: its engine is in .venv
EMULATED_PROGRAMS = ("rosflight", "rosflight_ground_tools")  # what tests with an emulator start


def _flies(path: Path) -> bool:
    return path.parts[0] in FLIES and not clang_tidy.is_test(path)


def tidy_product() -> Outcome:
    on_board = _tidy(CORTEX_M7, lambda path: _flies(path) and any(path.is_relative_to(board) for board in BOARDS))
    return add([_tidy(RELEASE, _flies), on_board])


def tidy_rest() -> Outcome:
    return _tidy(RELEASE, lambda path: not _flies(path))


def tidy_ros() -> Outcome:
    return _tidy(ROS, lambda path: True)


def _tidy(build: str, wanted) -> Outcome:
    if build != ROS and (built := _build(Path(build).name)).failed:
        return built
    clean, complaints = clang_tidy.run(build, wanted=wanted)
    print(f"   {clean} files clean")
    return _check(complaints)


# ---- builds and what they hold ------------------------------------------------------------------


def _build(preset: str, *targets: str) -> Outcome:
    if project.build(preset, *targets, keep_going=True):
        return Outcome(passed=1)
    return Outcome(failed=1, complaints=[f"does not build, all output is in build/{preset}/*.log"])


def build_release() -> Outcome:
    return add([_build("release"), gazebo_engine()])


GAZEBO_RELEASES = ("bookworm", "jammy")  # with the packages of tools/system_packages.txt, [gazebo]


def gazebo_engine() -> Outcome:
    """The program that Gazebo's libraries are linked to. Where they cannot be installed it is not built, and the tests that
    need it are skipped."""
    release = subprocess.run(["bash", "-c", "source tools/ready.sh && release_codename"], cwd=ROOT, capture_output=True, text=True)
    wanted = release.stdout.strip() in GAZEBO_RELEASES
    if wanted and subprocess.run(["bash", "tools/ready.sh", "packages", "run", "gazebo"], cwd=ROOT).returncode == 0:
        # The simulator itself, for ros/rosflight_sim/gazebo; where it cannot be installed the tests with it are skipped.
        subprocess.run(["bash", "tools/ready.sh", "packages", "gazebo-server"], cwd=ROOT, check=False)
        return _build("gazebo", "gazebo_engine")
    print("   gazebo_engine is not built: no packages of Gazebo for this release, or they cannot be installed")
    return Outcome()


def cortex_m7() -> Outcome:
    """Everything for the microcontroller built, and run: the board's own tests on the emulated
    processor, and flights with the firmware on it."""
    names = _emulator_tests()
    built = add([_build("cortex-m7"), _build("release", EMULATOR, *names, *EMULATED_PROGRAMS)])
    if built.failed:
        return built
    on_target = _run_binaries("cortex-m7")
    by_command = pytest_files.run(emulator_files(), sys.executable, RESULTS / "python")
    return add([built, *on_target.values(), *_run_binaries("release", names).values(), by_command])


def _emulator_tests(names: list[str] | None = None) -> list[str]:
    """Tests of the release build, all or of these, that need the microcontroller's image."""
    project.build("release", "build.ninja")
    return [b.name for b in cpp_tests.find("release")
            if b.needs_emulator and (names is None or b.name in names)]


def test_names() -> list[str]:
    """Names of all C++ tests, from the release build, configured if it is not yet."""
    project.build("release", "build.ninja")
    return [binary.name for binary in cpp_tests.find("release")]


def python_files() -> list[Path]:
    """All pytest files but those that need the ROS environment, the Python package or an emulated board."""
    return [path for path in project.own_files() if re.fullmatch(r"test_\w+\.py", path.name)
            and not ros_test.needs_ros(path) and not python_package.needs_package(path) and not needs_emulator(path)]


def needs_emulator(path: Path) -> bool:
    """By its name: it starts an emulated board, and needs the images of the preset cortex-m7."""
    return re.fullmatch(r"test_emulated_\w+\.py", path.name) is not None


def emulator_files() -> list[Path]:
    """The pytest files of the stage cortex-m7."""
    return [path for path in project.own_files() if needs_emulator(path)]


def matching(parts: list[str]) -> tuple[list[str], list[Path]]:
    """Test programs and pytest files with one of the parts in their name."""
    files = [path for path in [*python_files(), *emulator_files()] if any(part in str(path) for part in parts)]
    return [name for name in test_names() if any(part in name for part in parts)], files


def _run_binaries(preset: str, names: list[str] | None = None) -> dict[str, Outcome]:
    binaries = [b for b in cpp_tests.find(preset)
                if (b.name in names if names is not None else not b.needs_emulator)]
    stale = {b.name for b in binaries if not _is_built(preset, b)}
    outcomes = cpp_tests.run_all([b for b in binaries if b.name not in stale], RESULTS / preset)
    for name in stale:
        outcomes[name] = Outcome(failed=1, complaints=[f"{name}: not built"])
    return outcomes


def _is_built(preset: str, binary: Binary) -> bool:
    """After a failed build an old program may still be there: it must not pass for the new one."""
    if not binary.command:
        return False
    build = ROOT / "build" / preset
    emulated = Path(binary.command[0]).name == "qemu-aarch64"  # -L FOLDER PROGRAM
    program = Path(binary.command[3 if emulated else 0])
    return not program.is_relative_to(build) or project.is_up_to_date(
        preset, str(program.relative_to(build)))


def _programs(names: list[str]) -> list[str]:
    """Those of the tests that are programs of the build; others, such as cmake -P, need all of it."""
    chosen = [b for b in cpp_tests.find("release") if b.name in names]
    ours = [b.name for b in chosen if b.part]
    return ours if len(ours) == len(chosen) else []


def unit_tests(names: list[str] | None = None) -> Outcome:
    """Every case of every C++ test of the release build counts."""
    if names is not None and not project.build("release", *_programs(names), keep_going=True):
        return Outcome(failed=1, complaints=["does not build, all output is in build/release/*.log"])
    if names is not None and _emulator_tests(names):
        if _build("cortex-m7").failed:
            return Outcome(failed=1, complaints=["does not build, all output is in build/cortex-m7/*.log"])
        if _build("release", EMULATOR, *EMULATED_PROGRAMS).failed:
            return Outcome(failed=1, complaints=["does not build, all output is in build/release/*.log"])
    return add(_run_binaries("release", names).values())


def sanitizers() -> Outcome:
    """Tests of what flies and whole flights under address and undefined-behaviour sanitizers; each program counts
    once."""
    return _sanitized(lambda folder: folder in SANITIZED)


def sanitizers_rest() -> Outcome:
    """The other tests under sanitizers."""
    return _sanitized(lambda folder: folder not in SANITIZED)


def _sanitized(wanted) -> Outcome:
    project.build("sanitizers", "build.ninja")
    names = [b.name for b in cpp_tests.find("sanitizers")
             if b.part and wanted(b.part) and not b.needs_emulator]
    if not names:
        return Outcome(failed=1, complaints=["no test to run under sanitizers"])
    built = _build("sanitizers", *names)
    return add([built, *(_check(ran.complaints) for ran in _run_binaries("sanitizers", names).values())])


PROGRAMS = ("rosflight", "rosflight_tools", "rosflight_ground_tools", "rosflight_view")


def python_tests(named: list[Path] | None = None) -> Outcome:
    """All files, after the stage build, or these, with the programs they run built first."""
    files = python_files() if named is None else named
    if not files:
        return Outcome()
    if named and not project.build("release", *PROGRAMS, keep_going=True):
        return Outcome(failed=1, complaints=["the programs cannot be built"])
    if any(needs_emulator(path) for path in files):
        built = add([_build("cortex-m7"), _build("release", EMULATOR)])
        if built.failed:
            return built
    return pytest_files.run(files, sys.executable, RESULTS / "python")


def ros_tests(names: list[str] = ()) -> Outcome:
    """The packages under ros/ built, and their pytest files run in the ROS environment."""
    return ros_test.run(names)


def ros_sanitizers() -> Outcome:
    """What stands in for rclcpp under sanitizers; nothing with a ROS installation."""
    return ros_test.sanitizers()


def python_package_tests(names: list[str] = ()) -> Outcome:
    """The Python package built by pip, its types checked, and its pytest files run where it is installed."""
    return python_package.run(names)


def web_tests() -> Outcome:
    """The browser's page: types, reader of logs, views in a headless browser."""
    return web_test.run()


def web_rest() -> Outcome:
    """Calibrations that a person does, over a minute of real time each, and a flight looked at by touch and changed without a mouse."""
    return web_test.run("test/*.browser.test.ts", ROSFLIGHT_WEB_LONG="1")


# ---- the fault campaign -------------------------------------------------------------------------


SEEDS = 150  # of each vehicle
# Least share of the flights of the quarter with a wrong position that report it in time; docs/faults.md names those that do not.
SAID_IN_TIME = 0.95


def faults() -> Outcome:
    """A fixed quarter of the fault campaign, whether the estimate reports in it how wrong it is, and seeded flights in gusts."""
    built = _build("release", "bench/faults", "apps/rosflight")
    if built.failed:
        return built
    return add([_fault_quarter(), *(gusty_seeds(vehicle, SEEDS) for vehicle in ("multirotor", "anaconda"))])


def _fault_quarter() -> Outcome:
    """Each flight that ends otherwise than docs/fault-matrix.md or the rules say is a failure. What no rule explains and the
    page lists as such is open work: it counts in ./rosflight bench faults and is printed here."""
    page = ROOT / "docs/fault-matrix.md"
    done = _run([str(ROOT / "build/release/bench/faults"), "--quarter", "--compare", str(page)])
    said = [line for line in done.stderr.splitlines() if not line.endswith(" flights")]
    listed = page.read_text().partition("## What no rule explains")[2].replace("`", "")
    known = [line for line in said if line.removeprefix("no rule explains: ") in listed]
    print("".join(f"   open: {line}\n" for line in known), end="")
    complaints = [line for line in said if line not in known]
    if done.returncode:
        return Outcome(failed=1, complaints=complaints or [f"bench/faults ended with {done.returncode}"])
    found = json.loads(done.stdout)
    failed = min(len(complaints), found["flights"])
    return add([Outcome(found["flights"] - failed, failed, complaints), _estimate_with_faults(found)])


def _estimate_with_faults(found: dict) -> Outcome:
    """The limits of ./rosflight bench faults, over the flights of the quarter."""
    return add([_check([f"{name}: found {found[name]:.4f}, allowed {limit}"] if wrong else []) for name, limit, wrong in (
        ("outside_worst", "at most 0.01", found["outside_worst"] > 0.01),
        ("said_in_time_share", f"at least {SAID_IN_TIME}", found["said_in_time_share"] < SAID_IN_TIME),
        ("nominal_said", "0", found["nominal_said"] > 0))])


def gusty_seeds(vehicle: str, count: int) -> Outcome:
    """The default mission in 6 m/s of wind with gusts: each seed has to end with the mission done."""
    with tempfile.TemporaryDirectory() as scratch:
        rows = Path(scratch) / "seeds.csv"
        done = _run([str(ROOT / "build/release/apps/rosflight"), "fly", "--vehicle", vehicle, "--seeds", f"1:{count}",
                     "--wind", "6,270,6", "--no-log", "--out", str(rows)])
        if not rows.exists():
            return Outcome(failed=1, complaints=[f"{vehicle}, seeds: {done.stderr.strip()}"])
        with rows.open() as table:
            flown = list(csv.DictReader(table))
    failed = [f"{vehicle}, seed {row['seed']} in gusts: {row['outcome']}" for row in flown if row["success"] != "1"]
    missing = [f"{vehicle}: {len(flown)} of {count} seeds flown"] if len(flown) != count else []
    return Outcome(len(flown) - len(failed), len(failed) + len(missing), failed + missing)


# ---- fuzzing ------------------------------------------------------------------------------------


def fuzzers() -> list[str]:
    """Names of the fuzzers, as rosflight_fuzzer(NAME ...) in the folders' CMakeLists.txt has them."""
    lists = [ROOT / path for path in project.own_files() if path.name == "CMakeLists.txt"]
    named = (re.findall(r"^\s*rosflight_fuzzer\(\s*(\w+)", text.read_text(), re.M) for text in lists)
    return sorted(name for names in named for name in names)


# No record of who allocated, and little freed memory kept back: a third less time. An input that was found, tried by hand, shows both.
ASAN_OF_FUZZERS = "malloc_context_size=0:quarantine_size_mb=8"


def run_fuzzer(name: str, *limits: str) -> tuple[int, list[str]]:
    """Runs one fuzzer from a fixed seed; how many inputs it tried and what it found."""
    program = next((path for path in (ROOT / "build/sanitizers").rglob(name) if path.is_file()), None)
    if program is None:
        return 0, [f"{name}: not built"]
    seeds = [str(path) for path in ROOT.glob(f"**/fuzz/corpus/{name}") if path.is_dir()]
    with tempfile.TemporaryDirectory() as scratch:
        found = Path(scratch) / "found"
        grown = Path(scratch) / "grown"
        grown.mkdir()
        done = _run([str(program), "-seed=1", "-print_final_stats=1", *limits,
                     f"-artifact_prefix={found}-", str(grown), *seeds],
                    env={**os.environ, "ASAN_OPTIONS": ASAN_OF_FUZZERS})
        runs = re.search(r"stat::number_of_executed_units:\s*(\d+)", done.stderr)
        if done.returncode == 0 and runs:
            return int(runs[1]), []
        complaints = [f"{name}: " + (_first_error(done.stderr) or f"ended with {done.returncode}")]
        for path in Path(scratch).glob("found-*"):
            complaints.append(f"{name}: input of {path.stat().st_size} B: {path.read_bytes()[:400].hex()}")
        return int(runs[1]) if runs else 0, complaints


def _first_error(said: str) -> str:
    return next((line.strip() for line in said.splitlines() if "ERROR" in line or "error:" in line), "")


def fuzz() -> Outcome:
    """A short run of each fuzzer; the long one is in ./rosflight bench."""
    names = fuzzers()
    if not names:
        return Outcome()
    built = _build("sanitizers", *names)
    with concurrent.futures.ThreadPoolExecutor(project.jobs()) as pool:
        found = list(pool.map(lambda name: run_fuzzer(name, *SHORT_FUZZ)[1], names))
    return add([built, *map(_check, found)])
