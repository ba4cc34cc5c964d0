# SPDX-License-Identifier: BSD-3-Clause
"""Shows that the tests see defects: each file of tools/mutations/ is a defect of one line.

A defect is written into a copy of the tree, its test is built there and must fail. tools/mutations/README.md
says what a file holds.
"""

import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import project
import yaml
from cpp_tests import Outcome

FOLDER = project.ROOT / "tools" / "mutations"
COPY = project.ROOT / "build" / "mutations"
PARTS = ("base", "link", "firmware/hal", "firmware/core", "firmware/boards/parts", "test_support", "firmware/boards/simulated")
PROPERTIES = "firmware_properties_test"
CHEAPEST = "disarm_leaves_motors"  # one small file of the core; the one that CI builds
KEYS = {"breaks", "file", "below", "line", "becomes", "test", "says"}


@dataclass(frozen=True)
class Mutation:
    name: str
    breaks: str  # the promise that does not hold with it
    file: str
    line: str  # a part of one line ...
    becomes: str  # ... and what stands in its place
    below: str = ""  # the first such line below this one counts
    test: str = PROPERTIES
    says: str = ""  # what the failing test must print, such as the name of the invariant

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
    parts = (*PARTS, "cmake", "firmware/boards/common")
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


def build_and_run(test: str) -> tuple[bool, str]:
    """Whether the test of the copy passes, and its output. @raise RuntimeError when it does not build."""
    built = run(["ninja", "-C", str(COPY / "build/release"), "-j", str(project.jobs()), test])
    if built.returncode != 0:
        raise RuntimeError("does not build: " + " ".join(
            line for line in built.stdout.splitlines() if "error" in line)[:400])
    program = next(path for path in (COPY / "build/release/firmware").rglob(test) if path.is_file())
    done = run([str(program)])
    return done.returncode == 0, done.stdout + done.stderr


def says_defect(said: str, wanted: str) -> bool:
    return any(wanted in line for line in said.splitlines())


def try_one(mutation: Mutation) -> str:
    """What is wrong with a mutation; empty when its test catches it."""
    file = COPY / mutation.file
    original = file.read_text()
    try:
        file.write_text(mutation.apply(original))
        passed, said = build_and_run(mutation.test)
    except (RuntimeError, ValueError) as error:
        return str(error)
    finally:
        file.write_text(original)
    if passed:
        return f"not caught by {mutation.test}"
    if mutation.says and not says_defect(said, mutation.says):
        return f"{mutation.test} fails, but says nothing of '{mutation.says}'"
    return ""


def test(names: list[str] = ()) -> Outcome:
    """Each chosen mutation counts once. Without one the tests must pass, or a failure means nothing."""
    mutations = chosen(list(names))
    copy_tree()
    # For one defect as the tree is built: ccache has all but the files beside it. For many, the fewer files beside each the better.
    together = "9" if len(mutations) == 1 else "1"
    configured = run(["cmake", "--preset", "release", "-DROSFLIGHT_QUICK_BUILD=ON", f"-DROSFLIGHT_FILES_AT_A_TIME={together}",
                      f"-DROSFLIGHT_PARTS={';'.join(PARTS)}"])
    if configured.returncode != 0:
        return Outcome(failed=1, complaints=configured.stderr.splitlines()[-5:])
    outcome = Outcome()
    for name in sorted({mutation.test for mutation in mutations}):
        passed, said = build_and_run(name)
        if not passed:
            outcome.failed += 1
            outcome.complaints += [f"{name} fails without any mutation", *said.splitlines()[-5:]]
    for mutation in mutations:
        complaint = try_one(mutation)
        print(f"   {mutation.name}: {complaint or 'caught'}", flush=True)
        outcome.passed += not complaint
        outcome.failed += bool(complaint)
        if complaint:
            outcome.complaints.append(f"{mutation.name} ({mutation.breaks}): {complaint}")
    return outcome


def test_one() -> Outcome:
    return test([CHEAPEST])
