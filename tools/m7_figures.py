# SPDX-License-Identifier: BSD-3-Clause
"""What is measured on the emulated Cortex-M7 (bench/m7/README.md): sizes, instructions per pass and
per module, flights."""

import bisect
import functools
import json
import os
import re
import subprocess
import tempfile
from pathlib import Path

import project

BUILD = project.ROOT / "build" / "cortex-m7"
IMAGES = BUILD / "bench" / "m7"
EMULATOR = ["qemu-system-arm", "-M", "mps2-an500", "-display", "none", "-monitor", "none",
            "-semihosting-config", "enable=on,target=native", "-icount", "shift=0,sleep=off"]
# What the load figure assumes of a real part.
CYCLES_PER_INSTRUCTION, CLOCK_HZ, PASSES_HZ = 1.5, 400e6, 400.0
MODULES = ("sensors", "estimator", "command", "controller", "mixer", "rc", "telemetry", "loop", "link",
           "library")
# Files of the core that belong to a module of another name; all others of the core are the loop.
MODULE_OF = {"sensors": "sensors", "calibration": "sensors", "estimator": "estimator", "elementary": "estimator",
             "command": "command", "controller": "controller", "mixer": "mixer", "rc": "rc",
             "telemetry": "telemetry", "mavlink_codec": "link"}
# Flights whose stack counts: by cable and, last, over the UART.
FLIGHTS = ([], ["--fault", "rc_silence@20:2"], ["--fault", "imu@20"], ["--fault", "link_cut@20:3"],
           ["--fault", "crash@20"], ["--fault", "hang@20"])
UART_FLIGHT = ["--link", "uart", "--mission", "hop"]


def image(name: str) -> Path:
    path = IMAGES / f"m7_{name}.elf"
    if not path.is_file() or not project.is_up_to_date("cortex-m7", f"bench/m7/{path.name}"):
        raise RuntimeError(f"bench/m7/{path.name} does not build, see build/cortex-m7/build.log")
    return path


def text_bytes(name: str = "text_size") -> float:
    """Code and constants, as the column text of size has them."""
    said = subprocess.run(["arm-none-eabi-size", str(image(name))],
                          capture_output=True, text=True, check=True).stdout
    return float(said.splitlines()[1].split()[0])


@functools.cache
def passes(name: str = "firmware_pass") -> dict:
    done = subprocess.run([*EMULATOR, "-kernel", str(image(name))], capture_output=True,
                          text=True, timeout=60, stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        raise RuntimeError(f"the image ended with {done.returncode}: {done.stderr.strip()[-200:]}")
    return json.loads(done.stdout)


def policy_passes() -> dict:
    """With a policy of two layers of 64 that is inferred in each pass."""
    found = passes("firmware_pass_policy")
    if not found["policy_flies"]:
        raise RuntimeError("the policy did not fly")
    return found


def policy_text_bytes() -> float:
    return text_bytes("text_size_policy") - text_bytes()


def policy_ram_bytes() -> float:
    """The object that keeps its state, and the stack that it needs more."""
    return policy_passes()["policy_bytes"] + policy_passes()["stack_bytes"] - passes()["stack_bytes"]


def load_percent(instructions: float | None = None) -> float:
    return 100 * (instructions or passes()["instructions"]) * CYCLES_PER_INSTRUCTION * PASSES_HZ / CLOCK_HZ


# ---- instructions by module ---------------------------------------------------------------------


def placed_code(linker_map: str) -> list[tuple[int, int, str]]:
    """First address, size and source file (without suffix) of each piece of code, by address."""
    begin = linker_map.index("Linker script and memory map")
    piece = re.compile(r"^ \.text\S*\s+0x([0-9a-f]+)\s+0x([0-9a-f]+)\s+(\S.*)$", re.M)
    found = []
    for match in piece.finditer(linker_map, begin):
        name = re.search(r"([\w+-]+)[\w.]*?\.(?:cpp\.obj|o|obj)\)?$", match[3])
        if int(match[2], 16):
            found.append((int(match[1], 16), int(match[2], 16), name[1] if name else match[3]))
    return sorted(found)


def module_of(source: str, ours: set[str]) -> str | None:
    """None for what belongs to the bench itself."""
    if source in MODULE_OF:
        return MODULE_OF[source]
    if source in ours:
        return "loop"
    return None if source in ("firmware_pass_main", "startup", "no_heap") else "library"


@functools.cache
def by_module() -> dict[str, float]:
    """Instructions of a mean pass, by module: the address of each one executed is logged."""
    elf = image("firmware_pass")
    pieces = placed_code((IMAGES / "m7_firmware_pass.map").read_text())
    starts = [piece[0] for piece in pieces]
    symbols = dict(reversed(line.split()[::2]) for line in subprocess.run(
        ["arm-none-eabi-nm", str(elf)], capture_output=True, text=True, check=True).stdout.splitlines()
        if len(line.split()) == 3)
    begin, end = (int(symbols[f"bench_mean_{which}"], 16) for which in ("begins", "ends"))
    counts = _count_addresses(elf, begin, end)
    ours = {path.stem for path in (project.ROOT / "firmware/core").glob("*.cpp")}
    found = dict.fromkeys(MODULES, 0)
    for address, count in counts.items():
        first, size, source = pieces[bisect.bisect_right(starts, address) - 1]
        module = module_of(source, ours) if address < first + size else None
        if module:
            found[module] += count
    return {name: count / passes()["passes"] for name, count in found.items()}


def _count_addresses(elf: Path, begin: int, end: int) -> dict[int, int]:
    """How often each address was executed between the calls at begin and end."""
    with tempfile.TemporaryDirectory() as scratch:
        nameless = Path(scratch) / "image.elf"  # names would make the log three times as long
        subprocess.run(["arm-none-eabi-objcopy", "--strip-all", str(elf), str(nameless)], check=True)
        reading, writing = os.pipe()
        process = subprocess.Popen(
            [*EMULATOR, "-singlestep", "-d", "exec,nochain", "-D", f"/proc/self/fd/{writing}",
             "-kernel", str(nameless)], pass_fds=[writing], stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(writing)
        counts: dict[bytes, int] = {}
        counting = False
        marks = {b"%08x" % begin: True, b"%08x" % end: False}
        with os.fdopen(reading, "rb") as log:
            for line in log:
                address = line.split(b"/", 2)[1] if line.startswith(b"Trace") else b""
                counting = marks.get(address, counting)
                if counting:
                    counts[address] = counts.get(address, 0) + 1
        if process.wait() != 0:
            raise RuntimeError(f"the image ended with {process.returncode} while it was traced")
    return {int(address, 16): count for address, count in counts.items() if address}


# ---- flights ------------------------------------------------------------------------------------


def fly(*options: str) -> dict:
    """Summary of a flight with the emulated board; one that fails its mission has one too."""
    program = project.ROOT / "build/release/apps/rosflight"
    with tempfile.TemporaryDirectory() as scratch:
        done = subprocess.run(
            [str(program), "fly", "--board", "qemu_m7", "--json", "--out", f"{scratch}/flight", *options],
            cwd=project.ROOT, capture_output=True, text=True, timeout=600, stdin=subprocess.DEVNULL)
    if done.returncode not in (0, 1):
        raise RuntimeError((done.stderr.strip().splitlines() or ["the flight printed nothing"])[-1])
    return json.loads(done.stdout)


@functools.cache
def flights() -> list[dict]:
    flown = [fly(*options) for options in FLIGHTS]
    if flown[0]["success"] is not True:
        raise RuntimeError("the default flight did not succeed")
    return flown


@functools.cache
def uart_flight() -> dict:
    """In real time, so a busy machine may spoil one: the better of two."""
    flown = fly(*UART_FLIGHT)
    return flown if flown["success"] else fly(*UART_FLIGHT)


def stack_bytes() -> float:
    return max(flight["stack_bytes"] for flight in [*flights(), uart_flight()])
