# SPDX-License-Identifier: BSD-3-Clause
"""Shows that the tests see defects: each file of tools/mutations/ is a defect of one line.

A defect is written into a copy of the tree, its test is built there and must fail. A defect in the drivers of a chip goes into the
image of a board, and a flight on the emulated chip, or a test that flies it, must fail. tools/mutations/README.md says what a file holds.
"""

import os
import shlex
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import project
import yaml
from cpp_tests import Outcome

FOLDER = project.ROOT / "tools" / "mutations"
COPY = project.ROOT / "build" / "mutations"
PARTS = ("base", "link", "firmware/hal", "firmware/core", "firmware/boards/common", "firmware/boards/parts", "test_support",
         "firmware/boards/simulated")
AUTONOMY_PARTS = ("base", "config", "test_support", "autonomy")
CHIP_PARTS = ("base", "link", "firmware/hal", "firmware/core", "firmware/boards/parts", "firmware/boards/stm32h7",
              "firmware/boards/pixracer_pro", "firmware/boards/varmint")
FLIGHT_PARTS = ("vehicles", "missions")
PROPERTIES = "firmware_properties_test"
FLYING = "flight_h7_"  # tests of the tree so named fly the image of the copy
FLOWN = ("pixracer_pro", "varmint")
CHEAPEST = ("disarm_leaves_motors", "autonomy_empty_battery_ignored")  # one small file each; those that CI builds
KEYS = {"breaks", "file", "below", "line", "becomes", "test", "case", "flight", "says"}
EMULATOR = "build/release/firmware/boards/stm32h7/emulator/h7_emulator"


@dataclass(frozen=True)
class Mutation:
    name: str
    breaks: str  # the promise that does not hold with it
    file: str
    line: str  # a part of one line ...
    becomes: str  # ... and what stands in its place
    below: str = ""  # the first such line below this one counts
    test: str = PROPERTIES
    case: str = ""  # the only case of the test that is run
    flight: str = ""  # instead of a test: options of `rosflight fly`, which must fail
    says: str = ""  # what the failing test must print, such as the name of the invariant

    @property
    def on_chip(self) -> bool:
        """Whether it goes into an image that is flown."""
        return bool(self.flight) or self.test.startswith(FLYING)

    @property
    def tried(self) -> str:
        """What has to fail, for people."""
        return f"fly {self.flight}" if self.flight else self.case or self.test

    def apply(self, text: str) -> str:
        """@raise ValueError when the line is not there, or not the only one."""
        begin = 0
        if self.below:
            begin = text.find(self.below)
            if begin < 0:
                raise ValueError(f"{self.name}: {self.file} has no '{self.below}'")
        count = text.count(self.line, begin)
        if count == 0 or (count > 1 and not self.below):
            raise ValueError(f"{self.name}: {self.file} has '{self.line}' {count} times, needed once")
        at = text.index(self.line, begin)
        return text[:at] + self.becomes + text[at + len(self.line):]


def read(path: Path) -> Mutation:
    found = yaml.safe_load(path.read_text())
    if not isinstance(found, dict) or not {"breaks", "file", "line", "becomes"} <= set(found) <= KEYS:
        raise ValueError(f"{path.name}: allowed keys are {', '.join(sorted(KEYS))}")
    if "\n" in found["line"] or "\n" in str(found["becomes"] or ""):
        raise ValueError(f"{path.name}: a mutation changes one line")
    if "test" in found and "flight" in found:
        raise ValueError(f"{path.name}: allowed is one of test and flight")
    if "case" in found and "test" not in found:
        raise ValueError(f"{path.name}: a case is one of a test")
    found["becomes"] = found["becomes"] or ""
    return Mutation(path.stem, **found)


def all_mutations(folder: Path = FOLDER) -> list[Mutation]:
    return [read(path) for path in sorted(folder.glob("*.yaml"))]


def chosen(names: list[str]) -> list[Mutation]:
    known = all_mutations()
    for name in names:
        if not any(name in mutation.name for mutation in known):
            raise ValueError(f"no mutation matches '{name}'; mutations: {', '.join(m.name for m in known)}")
    return [m for m in known if not names or any(name in m.name for name in names)]


def copy_tree():
    """The files that the tests are built of; those that did not change keep their time."""
    parts = (*PARTS, *AUTONOMY_PARTS, *CHIP_PARTS, *FLIGHT_PARTS, "cmake", "firmware/boards/common")
    wanted = {path for path in project.own_files() if len(path.parts) == 1 or any(
        path.is_relative_to(part) for part in parts)}
    for path in wanted:
        source, target = project.ROOT / path, COPY / path
        if target.is_file() and target.read_bytes() == source.read_bytes():
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, target)
        target.chmod(source.stat().st_mode)
    for path in COPY.rglob("*"):
        relative = path.relative_to(COPY)
        if path.is_file() and relative.parts[0] not in ("build", ".venv-build") and relative not in wanted:
            path.unlink()
    if not (COPY / ".venv-build").exists():
        (COPY / ".venv-build").symlink_to(project.ROOT / ".venv-build")


def run(command: list[str]) -> subprocess.CompletedProcess:
    # With the copy as base, ccache finds what was compiled for the tree itself.
    environment = {**os.environ, "CCACHE_BASEDIR": str(COPY), "CCACHE_NOHASHDIR": "1",
                   "CCACHE_SLOPPINESS": "pch_defines,time_macros"}
    return subprocess.run(command, cwd=COPY, env=environment, capture_output=True, text=True)


def build_and_run(test: str, case: str = "") -> tuple[bool, str]:
    """Whether the test of the copy, or one case of it, passes, and its output. @raise RuntimeError when it does not build."""
    built = run(["ninja", "-C", str(COPY / "build/release"), "-j", str(project.jobs()), test])
    if built.returncode != 0:
        raise RuntimeError("does not build: " + " ".join(
            line for line in built.stdout.splitlines() if "error" in line)[:400])
    program = next(path for folder in ("firmware", "autonomy") for path in (COPY / "build/release" / folder).rglob(test) if path.is_file())
    return result_of(test, case, run([str(program), f"--gtest_filter={case or '*'}"]))


def result_of(test: str, case: str, done: subprocess.CompletedProcess) -> tuple[bool, str]:
    if case and "[==========] Running 1 test " not in done.stdout:
        raise RuntimeError(f"{test} has no case {case}")
    return done.returncode == 0, done.stdout + done.stderr


def build_images(*boards: str):
    built = run(["ninja", "-C", str(COPY / "build/cortex-m7"), "-j", str(project.jobs()), *(f"firmware_{board}.elf" for board in boards)])
    if built.returncode != 0:
        raise RuntimeError("does not build: " + " ".join(
            line for line in built.stdout.splitlines() if "error" in line)[:400])


def build_and_fly_in_test(test: str, case: str) -> tuple[bool, str]:
    """The same of a test of the tree that flies the images of the copy."""
    build_images(*FLOWN)
    program = project.ROOT / "build/release/flight" / test
    done = subprocess.run([str(program), f"--gtest_filter={case or '*'}"], capture_output=True, text=True, cwd=COPY,
                          env={**os.environ, "ROSFLIGHT_DATA_DIR": str(COPY)}, stdin=subprocess.DEVNULL)
    return result_of(test, case, done)


def build_and_fly(options: str) -> tuple[bool, str]:
    """The same of a flight with the image of the copy on the emulated chip."""
    board = shlex.split(options)[shlex.split(options).index("--board") + 1]
    build_images(board)
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([str(project.ROOT / "build/release/apps/rosflight"), "fly", *shlex.split(options), "--log", "none",
                               "--out", f"{folder}/flight"], cwd=folder, capture_output=True, text=True,
                              env={**os.environ, "ROSFLIGHT_DATA_DIR": str(COPY)}, stdin=subprocess.DEVNULL)
    return done.returncode == 0, done.stdout + done.stderr


def try_out(mutation: Mutation) -> tuple[bool, str]:
    if mutation.flight:
        return build_and_fly(mutation.flight)
    if mutation.on_chip:
        return build_and_fly_in_test(mutation.test, mutation.case)
    return build_and_run(mutation.test, mutation.case)


def says_defect(said: str, wanted: str) -> bool:
    return any(wanted in line for line in said.splitlines())


def try_one(mutation: Mutation) -> str:
    """What is wrong with a mutation; empty when its test catches it."""
    file = COPY / mutation.file
    original = file.read_text()
    try:
        file.write_text(mutation.apply(original))
        passed, said = try_out(mutation)
    except (RuntimeError, ValueError) as error:
        return str(error)
    finally:
        file.write_text(original)
    if passed:
        return f"not caught by {mutation.tried}"
    if mutation.says and not says_defect(said, mutation.says):
        return f"{mutation.tried} fails, but says nothing of '{mutation.says}'"
    return ""


def prepare_flights(tests=()) -> bool:
    """The simulation, the emulator and the tests are those of the tree; only the image is the copy's."""
    if not project.build("release", "rosflight", "h7_emulator", *tests):
        return False
    link = COPY / EMULATOR
    link.parent.mkdir(parents=True, exist_ok=True)
    link.unlink(missing_ok=True)
    link.symlink_to(project.ROOT / EMULATOR)
    return True


def test(names: list[str] = ()) -> Outcome:
    """Each chosen mutation counts once. Without one the tests must pass, or a failure means nothing."""
    mutations = chosen(list(names))
    copy_tree()
    # For a few defects as the tree is built: ccache has all but the files beside each. For many, the fewer files beside each the better.
    together = "9" if len(mutations) <= len(CHEAPEST) else "1"
    configurations = []
    if tested := [mutation for mutation in mutations if not mutation.on_chip]:
        parts = list(PARTS) if any(not mutation.file.startswith("autonomy/") for mutation in tested) else []
        if any(mutation.file.startswith("autonomy/") for mutation in tested):
            parts += [part for part in AUTONOMY_PARTS if part not in parts]
        configurations.append(["release", "-DROSFLIGHT_QUICK_BUILD=ON", f"-DROSFLIGHT_FILES_AT_A_TIME={together}",
                               f"-DROSFLIGHT_PARTS={';'.join(parts)}"])
    if flown := [mutation for mutation in mutations if mutation.on_chip]:
        configurations.append(["cortex-m7", f"-DROSFLIGHT_PARTS={';'.join(CHIP_PARTS)}"])
        if not prepare_flights(sorted({mutation.test for mutation in flown if not mutation.flight})):
            return Outcome(failed=1, complaints=["rosflight and h7_emulator do not build, all output is in build/release/build.log"])
    for preset, *options in configurations:
        configured = run(["cmake", "--preset", preset, *options])
        if configured.returncode != 0:
            return Outcome(failed=1, complaints=configured.stderr.splitlines()[-5:])
    outcome = Outcome()
    for mutation in {m.flight or f"{m.test} {m.case}": m for m in mutations}.values():
        try:
            passed, said = try_out(mutation)
        except RuntimeError as error:
            passed, said = False, str(error)
        if not passed:
            outcome.failed += 1
            outcome.complaints += [f"{mutation.tried} fails without any mutation", *said.splitlines()[-5:]]
    for mutation in mutations:
        complaint = try_one(mutation)
        print(f"   {mutation.name}: {complaint or 'caught'}", flush=True)
        outcome.passed += not complaint
        outcome.failed += bool(complaint)
        if complaint:
            outcome.complaints.append(f"{mutation.name} ({mutation.breaks}): {complaint}")
    return outcome


def test_cheapest() -> Outcome:
    return test(CHEAPEST)
