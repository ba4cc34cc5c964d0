# SPDX-License-Identifier: BSD-3-Clause
"""What is measured on the images of the boards with an STM32H7: sizes, default flights, and round trips."""

import functools
import json
import resource
import statistics
import subprocess
import tempfile
from pathlib import Path

import project

BOARD = "pixracer_pro"
BOARDS = (BOARD, "varmint")
# Sections by what they occupy: flash and RAM. Initial values of variables lie in both.
FLASH = (".text", ".ARM.exidx", ".ARM.extab", ".data")
# The autopilot's memory. Not the flight record (.record): 20 s at 100 Hz alone are 256 000 bytes, in the AXI SRAM, which nothing
# else uses; record_bytes() is a figure of its own.
RAM = (".stack", ".data", ".bss", ".dma")
RECORD = (".record",)
# Those of board_rtt that there are only with a GNSS receiver, a receiver and a battery.
STREAMS = ("gnss_hz", "receiver_hz", "battery_hz")


@functools.cache
def sections(board: str = BOARD) -> dict[str, int]:
    image = project.ROOT / f"build/cortex-m7/firmware/boards/{board}/firmware_{board}.elf"
    if not image.is_file():
        raise RuntimeError(f"{image.name} does not build, see build/cortex-m7/build.log")
    said = subprocess.run(["arm-none-eabi-size", "-A", str(image)], capture_output=True, text=True, check=True).stdout
    return sizes_of(said)


def sizes_of(said: str) -> dict[str, int]:
    """Section sizes from what size -A prints."""
    rows = (line.split() for line in said.splitlines())
    return {row[0]: int(row[1]) for row in rows if len(row) == 3 and row[0].startswith(".")}


def text_bytes(board: str = BOARD) -> float:
    return float(sum(sections(board).get(name, 0) for name in FLASH))


def ram_bytes(board: str = BOARD) -> float:
    return float(sum(sections(board).get(name, 0) for name in RAM))


def record_bytes(board: str = BOARD) -> float:
    return float(sum(sections(board).get(name, 0) for name in RECORD))


def bench_program(name: str, *words: str) -> dict:
    """What a program of bench/ prints about a board, as JSON."""
    done = subprocess.run([str(project.ROOT / "build/release/bench" / name), *words], capture_output=True, text=True,
                          timeout=3600, stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        raise RuntimeError((done.stderr.strip().splitlines() or [f"{name} printed nothing"])[-1])
    return json.loads(done.stdout)


def measure_round_trips(board: str, link: str, *options: str) -> dict:
    """Offboard commands to the emulated board and back, in its own time. Some minutes of the host's."""
    project.build("cortex-m7", f"firmware_{board}_echo.elf", keep_going=True)
    found = bench_program("board_rtt", board, link, *options)
    if found["lost"] != 0:
        raise RuntimeError(f"{found['lost']} commands were lost")
    if missing := [stream for stream in STREAMS if not found[stream] > 0]:
        raise RuntimeError(f"not all streams were on: {', '.join(missing)} is 0")
    return found


@functools.cache
def round_trips(board: str, link: str) -> dict:
    """45 s of them at 400 Hz, and then as fast as they are answered."""
    return measure_round_trips(board, link)


@functools.cache
def passthrough(board: str, attitude: str = "companion") -> dict:
    """A triangle wave of roll by attitude loops of the companion, in pass-through at 400 Hz, over the UART.

    @param attitude  what corrects the attitude that the firmware sends: the companion's, or nothing but the firmware's filter.
    """
    return bench_program("board_passthrough", board, *(["--attitude", "firmware"] if attitude == "firmware" else []))


def fly(board: str = BOARD, link: str = "cable") -> dict:
    """Summary of the default flight of a board, with the processor time of simulation and emulator.

    @param link  "cable" is the UART of the companion, "usb" its virtual serial port.
    """
    program = project.ROOT / "build/release/apps/rosflight"
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with tempfile.TemporaryDirectory() as scratch:
        done = subprocess.run([str(program), "fly", "--board", board, "--link", link, "--json", "--out", f"{scratch}/flight", "--log", "none"],
                              cwd=project.ROOT, capture_output=True, text=True, timeout=600, stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        raise RuntimeError((done.stderr.strip().splitlines() or ["the default flight did not succeed"])[-1])
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {**json.loads(done.stdout), "cpu_s": cpu_s}


flight = functools.cache(fly)


def realtime_factor(board: str = BOARD) -> float:
    """Simulated time over the processor time of simulation and emulator: the median of three flights.

    One flight alone says little on a shared machine: the same programs read 4.9 to 5.7 within ten minutes.
    """
    first = flight(board)
    times_s = [first["cpu_s"], *(fly(board)["cpu_s"] for _ in range(2))]
    return first["sim_time_s"] / statistics.median(times_s)
