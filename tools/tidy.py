# SPDX-License-Identifier: BSD-3-Clause
"""Runs clang-tidy over our .cpp files and remembers which were clean.

A file is looked at again when it, a header of ours that it includes, its compile command, the
configuration or the tool changes. Usage: tidy.py [BUILD [NAME...]], after a build; BUILD is
build/release, build/cortex-m7 or build/ros/build.
"""

import concurrent.futures
import functools
import hashlib
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import project

PRECOMPILED = re.compile(r" -Winvalid-pch| -fpch-preprocess| -include \S*/cmake_pch\.hxx")
INCLUDED = re.compile(r'^#include "(.*)"$', re.MULTILINE)


def memory() -> Path:
    """Which files were clean, with the user, so that a new clone knows too; in build/ when the home folder takes nothing."""
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path(os.environ.get("HOME") or "/nonexistent") / ".cache")
    place = home / "rosflight" / "clang_tidy"
    try:
        place.mkdir(parents=True, exist_ok=True)
        if os.access(place, os.W_OK):
            return place
    except OSError:
        pass
    place = project.ROOT / "build" / "clang_tidy" / "clean"
    place.mkdir(parents=True, exist_ok=True)
    return place


def without_precompiled(entry: dict) -> dict:
    """The compile command as if no header were precompiled: a missing #include shows then."""
    return {**entry, "command": PRECOMPILED.sub("", entry["command"])}


def file_by_file(entry: dict) -> list[dict]:
    """The compile commands of the files that a quick build compiles together; of another file, its own."""
    together = Path(entry["file"])
    if together.parent.name != "Unity":
        return [entry]
    return [{**entry, "file": file, "command": entry["command"].replace(str(together), file)}
            for file in INCLUDED.findall(together.read_text())]


def tidy_program() -> str:
    return str(project.ROOT / ".venv/bin/clang-tidy")


def headers_by_object(build: Path) -> dict[str, list[Path]]:
    """Headers of ours (written or generated) that each object file was made from, from ninja."""
    listed = subprocess.run(["ninja", "-C", str(build), "-t", "deps"], capture_output=True, text=True)
    found: dict[str, list[Path]] = {}
    current: list[Path] = []
    for line in listed.stdout.splitlines():
        if match := re.match(r"(\S.*): #deps", line):
            current = found.setdefault(match[1], [])
        elif line.startswith("    "):
            path = (build / line.strip()).resolve()
            if path.is_relative_to(project.ROOT) and path.suffix != ".cpp":
                current.append(path)
    return found


def all_headers() -> list[Path]:
    return [project.ROOT / path for path in project.own_files() if path.suffix == ".hpp"]


def key_of(entry: dict, headers: list[Path], common: bytes) -> str:
    """The same in every clone: paths count from its root."""
    digest = hashlib.sha256(common)
    digest.update(entry["command"].replace(str(project.ROOT), ".").encode())
    for path in [Path(entry["file"]), *sorted(headers)]:
        digest.update(str(path).replace(str(project.ROOT), ".").encode() + b"\0")
        digest.update(path.read_bytes() if path.is_file() else b"gone")
    return digest.hexdigest()


@functools.cache
def headers_of_cross_compiler(compiler: str, options: tuple[str, ...]) -> list[str]:
    """Where a compiler for another machine finds its own headers: clang does not look there."""
    said = subprocess.run([compiler, *options, "-x", "c++", "-E", "-v", "-"], stdin=subprocess.DEVNULL,
                          capture_output=True, text=True, check=True).stderr
    listed = said.split("#include <...> search starts here:")[1].split("End of search list.")[0]
    return [f"--extra-arg=-isystem{line.strip()}" for line in listed.splitlines() if line.strip()]


def extra_arguments(entry: dict) -> list[str]:
    compiler, *options = entry["command"].split()
    if "arm-none-eabi" not in compiler:
        return []
    return headers_of_cross_compiler(compiler, tuple(word for word in options if word.startswith("-m")))


def check(entry: dict, build: Path, commands: Path) -> str:
    """The complaints about one file, empty when clean. `commands` is the folder of the compile commands."""
    done = subprocess.run(
        [tidy_program(), "-p", str(commands), "--quiet", *extra_arguments(entry), entry["file"]], cwd=build,
        capture_output=True, text=True)
    said = [line for line in (done.stdout + done.stderr).splitlines()
            if not re.fullmatch(r"\d+ warnings? (generated|treated as errors?)\.?", line.strip())]
    return "" if done.returncode == 0 else "\n".join(said)


def is_test(path: Path) -> bool:
    return "test" in path.parts or "fuzz" in path.parts


def run(folder: str = "build/release", names: list[str] | None = None,
        wanted=lambda path: True) -> tuple[int, list[str]]:
    """Number of clean files, and the complaints about the others; `wanted` chooses by path. A build that ninja alone
    did not make (colcon) does not tell who includes what: any header may have mattered then."""
    build = project.ROOT / folder
    ours = {project.ROOT / path for path in project.own_files()
            if path.suffix == ".cpp" and wanted(path)}
    every = [without_precompiled(single) for entry in json.loads((build / "compile_commands.json").read_text())
             for single in file_by_file(entry)]
    commands = project.ROOT / "build" / "clang_tidy" / build.relative_to(project.ROOT)
    commands.mkdir(parents=True, exist_ok=True)
    (commands / "compile_commands.json").write_text(json.dumps(every))
    entries = {
        entry["file"]: entry
        for entry in every
        if Path(entry["file"]) in ours and (not names or any(n in entry["file"] for n in names))
    }
    made_by_ninja = (build / "build.ninja").exists()
    headers = headers_by_object(build) if made_by_ninja else {}
    any_header = None if made_by_ninja else all_headers()
    version = subprocess.run([tidy_program(), "--version"], capture_output=True).stdout
    common = version + (project.ROOT / ".clang-tidy").read_bytes()
    cleaned = memory()
    complaints: list[str] = []
    clean = 0

    def look(entry: dict) -> str:
        used = headers.get(entry.get("output", ""), any_header)
        known = cleaned / key_of(entry, used or [], common)
        if used is not None and known.exists():
            return ""
        said = check(entry, build, commands)
        if not said:
            known.touch()
        return said

    with concurrent.futures.ThreadPoolExecutor(project.jobs()) as pool:
        for said in pool.map(look, entries.values()):
            clean += not said
            complaints += [said] if said else []
    return clean, complaints


if __name__ == "__main__":
    clean, complaints = run(*sys.argv[1:2], names=sys.argv[2:])
    print("\n".join([*complaints, f"{clean} clean, {len(complaints)} with complaints"]))
    sys.exit(bool(complaints))
