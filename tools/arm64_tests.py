# SPDX-License-Identifier: BSD-3-Clause
"""The stages arm64 and arm64-rest of ./rosflight test: tests and flights on an emulated arm64, the processor of the companion's
computer. Its preset arm64-tests is made for short compile times; the preset arm64 gives what is installed there."""

import json
import re
import struct
import tempfile
from pathlib import Path

import cpp_tests
import project
import stages
from cpp_tests import Binary, Outcome
from project import ROOT

TESTS, PROGRAMS = "arm64-tests", "arm64"
VEHICLES = ("multirotor", "anaconda")
EMULATOR = ("qemu-aarch64", "-L", str(ROOT / "build/arm64-root"))
# Besides what the stage arm64 leaves out: none of these needs a network.
REST = {"base", "config", "companion", "firmware", "link", "sim", "autonomy"}
NOT_THERE = re.compile(r"^(linux_|simulated_|h7_|stm32)")  # firmware/boards but parts: tests of this computer's own boards
AARCH64 = 183  # e_machine, ELF for the Arm 64-bit Architecture
# Debian's packages of the shared libraries, by soname.
PACKAGES = {
    "ld-linux-aarch64.so.1": "libc6", "libc.so.6": "libc6", "libm.so.6": "libc6", "libcrypto.so.3": "libssl3", "libssl.so.3": "libssl3",
    "libfmt.so.9": "libfmt9", "libgcc_s.so.1": "libgcc-s1", "libstdc++.so.6": "libstdc++6", "libtinyxml2.so.9": "libtinyxml2-9", "libyaml-cpp.so.0.7": "libyaml-cpp0.7",
    "libz.so.1": "zlib1g", "libzstd.so.1": "libzstd1"}


def is_here() -> bool:
    """Whether this machine can unpack Debian's libraries for arm64."""
    asked = "source tools/ready.sh && source tools/arm64.sh && arm64_is_there"
    if stages._run(["bash", "-c", asked]).returncode == 0:
        return True
    print("   left out: Debian's packages for arm64 are for Debian 12 (bookworm)")
    return False


def is_quick(test: Binary) -> bool:
    """What cmake/joined_tests.cmake joins."""
    return test.name.startswith("joined_")


def is_rest(test: Binary) -> bool:
    return test.part in REST and not is_quick(test) and not test.needs_emulator and not NOT_THERE.match(test.name)


def quick() -> Outcome:
    """Every test of core, link, simulation and autonomy but the long ones, and one flight that has the bits that it has here."""
    if not is_here():
        return Outcome()
    built, tests = _tests(is_quick, "rosflight")
    if built.failed:
        return built
    return stages.add([built, *tests, _flies(VEHICLES[0], ROOT / "build" / TESTS / "apps/rosflight")])


def rest() -> Outcome:
    """The other tests of those folders, those of what they are built on, and the Debian package, unpacked and flown."""
    if not is_here():
        return Outcome()
    built, tests = _tests(is_rest)
    package = stages._build(PROGRAMS, "rosflight", "rosflight_tools", "rosflight_ground_tools", "rosflight_view")
    return stages.add([built, *tests, package, *([] if package.failed else _package())])


def _tests(wanted, *programs: str) -> tuple[Outcome, list[Outcome]]:
    """What was built, and what the tests among it found."""
    if not project.build(TESTS, "build.ninja"):
        return stages._build(TESTS, "build.ninja"), []
    names = [test.name for test in cpp_tests.find(TESTS) if wanted(test)]
    if not names:
        return Outcome(failed=1, complaints=["no test to run on arm64"]), []
    built = stages.add([stages._build(TESTS, *names, *programs), stages._build("release", "rosflight")])
    return built, list(stages._run_binaries(TESTS, names).values())


def _flies(vehicle: str, program: Path) -> Outcome:
    return stages._check(differs(vehicle, program))


def differs(vehicle: str, program: Path) -> list[str]:
    """What is wrong with the default flight of a vehicle by a program for arm64, beside that of this computer."""
    found = {}
    for where, start in (("arm64", [*EMULATOR, str(program)]), ("here", [str(ROOT / "build/release/apps/rosflight")])):
        with tempfile.TemporaryDirectory() as scratch:
            done = stages._run([*start, "fly", "--vehicle", vehicle, "--json", "--out", f"{scratch}/flight"])
        if done.returncode:
            return [f"{vehicle}, {where}: {done.stderr.strip()[-400:]}"]
        found[where] = json.loads(done.stdout)["log_sha256"]
    if found["arm64"] == found["here"]:
        return []
    return [f"{vehicle}: log_sha256 is {found['arm64']} on arm64, {found['here']} here"]


def _package() -> list[Outcome]:
    with tempfile.TemporaryDirectory() as scratch:
        packed = stages._run(["cpack", "--config", str(ROOT / "build" / PROGRAMS / "CPackConfig.cmake"), "-G", "DEB", "-B", scratch])
        found = list(Path(scratch).glob("*.deb"))
        if packed.returncode or len(found) != 1:
            return [Outcome(failed=1, complaints=[f"cpack: {(packed.stdout + packed.stderr).strip()[-400:]}"])]
        root = Path(scratch) / "root"
        stages._run(["dpkg-deb", "--extract", str(found[0]), str(root)])
        architecture, depends = (stages._run(["dpkg-deb", "--field", str(found[0]), field]).stdout.strip()
                                 for field in ("Architecture", "Depends"))
        programs = sorted((root / "usr/bin").iterdir())
        return [stages._check(wrong_package(architecture, depends, programs)),
                *(_flies(vehicle, root / "usr/bin/rosflight") for vehicle in VEHICLES)]


def wrong_package(architecture: str, depends: str, programs: list[Path]) -> list[str]:
    """What is wrong with a Debian package: its architecture, that of its programs, or the packages of the libraries they need."""
    wrong = [] if architecture == "arm64" else [f"Architecture: found {architecture}, allowed arm64"]
    if "rosflight" not in [program.name for program in programs]:
        wrong.append("usr/bin holds no rosflight")
    wrong += [f"{program.name}: made for another processor" for program in programs if machine(program) != AARCH64]
    needed = {name for program in programs for name in libraries(program)}
    wrong += [f"{name}: its package is not known" for name in sorted(needed - set(PACKAGES))]
    wanted = {PACKAGES[name] for name in needed & set(PACKAGES)}
    given = {entry.split()[0] for entry in depends.split(", ") if entry}
    return wrong + [f"Depends: {name} is missing" for name in sorted(wanted - given)] + [
        f"Depends: no program needs {name}" for name in sorted(given - wanted)]


def machine(program: Path) -> int:
    """e_machine of an ELF file, 0 of another file."""
    head = program.read_bytes()[:20]
    return struct.unpack_from("<H", head, 18)[0] if head[:4] == b"\x7fELF" and len(head) == 20 else 0


def libraries(program: Path) -> list[str]:
    return re.findall(r"\(NEEDED\).*\[(.+)\]", stages._run(["readelf", "--dynamic", str(program)]).stdout)
