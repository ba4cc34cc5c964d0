# SPDX-License-Identifier: BSD-3-Clause
"""What ./rosflight fly --board says, and its exit code, when the board, its image or its emulator is not right."""

import os
import signal
import subprocess
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROGRAM = ROOT / "build/release/apps/rosflight"
IMAGES = ROOT / "build/cortex-m7/firmware/boards"
TIMEOUT_S = 120.0
BOARDS = ["pixracer_pro", "varmint"]


@pytest.fixture
def data(tmp_path) -> Path:
    """A folder that the program takes for the project's: its data and emulator, and no image."""
    folder = tmp_path / "data"
    emulator = Path("build/release/firmware/boards/stm32h7/emulator/h7_emulator")
    for name in (Path("vehicles"), Path("missions"), emulator):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).symlink_to(ROOT / name)
    return folder


def put_image(data: Path, board: str, content: bytes):
    folder = data / "build/cortex-m7/firmware/boards" / board
    folder.mkdir(parents=True)
    (folder / f"firmware_{board}.elf").write_bytes(content)


def image_of(board: str) -> bytes:
    return (IMAGES / board / f"firmware_{board}.elf").read_bytes()


def start(data: Path, board: str) -> subprocess.Popen:
    return subprocess.Popen([PROGRAM, "fly", "--board", board, "--log", "none", "--out", data / "flight"], text=True,
                            env={**os.environ, "ROSFLIGHT_DATA_DIR": str(data)}, stdin=subprocess.DEVNULL,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def refused(data: Path, board: str) -> str:
    """The one line with which a flight does not begin."""
    out, said = (flight := start(data, board)).communicate(timeout=TIMEOUT_S)
    assert flight.returncode == 2
    assert out == "" and said.startswith("rosflight: ") and said.count("\n") == 1
    assert not (data / "flight").exists()
    return said


def test_an_unknown_board_is_refused(data):
    assert refused(data, "pixhawk") == (
        "rosflight: --board: found pixhawk, allowed in_process, qemu_m7, pixracer_pro, varmint, varmint_10x\n")


@pytest.mark.parametrize("board, other", [BOARDS, BOARDS[::-1]])
def test_the_image_of_another_board_is_refused(data, board, other):
    put_image(data, board, image_of(other))
    assert f"image: found one for {other}, allowed one for {board}" in refused(data, board)


@pytest.mark.parametrize("board", BOARDS)
def test_an_image_without_its_vector_table_is_refused(data, board):
    put_image(data, board, image_of("qemu_m7"))
    assert "no vector table at 0x08000000" in refused(data, board)


@pytest.mark.parametrize("board", BOARDS)
def test_a_file_that_is_no_image_is_refused(data, board):
    put_image(data, board, b"no image" * 50)
    assert f"firmware_{board}.elf: is no ELF file for Arm" in refused(data, board)


@pytest.mark.parametrize("board", BOARDS)
def test_an_image_that_is_not_built_is_named_with_what_builds_it(data, board):
    assert f"is not built: ./rosflight firmware build {board} makes it" in refused(data, board)


def emulator_of(flight: subprocess.Popen) -> int:
    """The process that the flight started. Waits for it."""
    end = time.monotonic() + TIMEOUT_S
    while time.monotonic() < end and flight.poll() is None:
        started = " ".join(path.read_text() for path in Path(f"/proc/{flight.pid}/task").glob("*/children")).split()
        if started:
            return int(started[0])
        time.sleep(0.01)
    raise AssertionError("no emulator was started")


@pytest.mark.parametrize("board", BOARDS)
def test_an_emulator_that_dies_in_flight_ends_it_with_one_line(data, board):
    put_image(data, board, image_of(board))
    flight = start(data, board)
    try:
        emulator = emulator_of(flight)
        said = []
        for line in flight.stderr:  # the notes of the flight
            said.append(line)
            if "phase takeoff" in line:
                os.kill(emulator, signal.SIGKILL)
        assert flight.wait(TIMEOUT_S) == 1
    finally:
        flight.kill()
    assert any("phase takeoff" in line for line in said)
    (last,) = [line for line in said if line.startswith("rosflight: ")]
    assert last == said[-1] and last.endswith("s: emulated board: its program was ended by signal 9; it printed nothing\n")
