# SPDX-License-Identifier: BSD-3-Clause
"""Files of a board's image, and how they come onto the board.

Usage: ./rosflight firmware build BOARD [--keep-bootloader]
       ./rosflight firmware flash BOARD [--keep-bootloader] [--swd]

BOARD is pixracer_pro, varmint (revision 11X) or varmint_10x. build makes ELF, BIN, HEX and DFU files and prints what the image
occupies. flash builds and then writes the image, over USB with dfu-util or, with --swd, through an ST-Link with openocd; it says
what to connect.
--keep-bootloader links the image at 0x08020000, behind the 128 KiB of a bootloader of PX4 or ArduPilot.

Nothing of this has been tried on a physical board: read docs/hardware.md first.
"""

import shutil
import struct
import subprocess
import sys
import zlib
from pathlib import Path

import project

FLASH, BEHIND_BOOTLOADER = 0x08000000, 0x08020000
BOARDS = ("pixracer_pro", "varmint", "varmint_10x")
# The bootloader in the chip's own ROM (ST application note AN2606 and UM0391, which also describes the file).
ROM_VENDOR, ROM_PRODUCT = 0x0483, 0xDF11


class FirmwareError(Exception):
    """One line: what was found, what is allowed or what to do."""


def dfu(image: bytes, address: int) -> bytes:
    """The image as one element of one target, in the format DfuSe."""
    element = struct.pack("<II", address, len(image)) + image
    target = struct.pack("<6sBI255sII", b"Target", 0, 1, b"internal flash", len(element), 1) + element
    body = struct.pack("<5sBIB", b"DfuSe", 1, 11 + len(target), 1) + target
    body += struct.pack("<HHHH3sB", 0xFFFF, ROM_PRODUCT, ROM_VENDOR, 0x011A, b"UFD", 16)
    return body + struct.pack("<I", zlib.crc32(body) ^ 0xFFFFFFFF)


def flash_command(elf: Path, swd: bool) -> list[str]:
    if swd:
        return ["openocd", "-f", "interface/stlink.cfg", "-f", "target/stm32h7x.cfg", "-c", f"program {elf} verify reset exit"]
    return ["dfu-util", "-a", "0", "-d", f"{ROM_VENDOR:04x}:{ROM_PRODUCT:04x}", "-D", str(elf.with_suffix(".dfu"))]


CONNECT = {
    False: "Connect the board's USB while its boot pin is held high (BOOT0; on a Pixracer Pro a pad), so that the chip's own bootloader runs.",
    True: "Connect an ST-Link to SWDIO, SWCLK and ground of the board, and power the board.",
}


def parse(arguments: list[str]) -> tuple[str, str, bool, bool]:
    """Action, board, whether a bootloader stays, whether by SWD."""
    flags = [a for a in arguments if a.startswith("-")]
    words = [a for a in arguments if not a.startswith("-")]
    action, board = (words + ["nothing", "nothing"])[:2]
    if action not in ("build", "flash"):
        raise FirmwareError(f"firmware: found '{action}', allowed build, flash")
    if board not in BOARDS:
        raise FirmwareError(f"firmware {action}: found '{board}', allowed {', '.join(BOARDS)}")
    if len(words) > 2:
        raise FirmwareError(f"firmware {action}: found '{words[2]}' after the board, allowed nothing")
    allowed = ["--keep-bootloader"] + (["--swd"] if action == "flash" else [])
    for flag in flags:
        if flag not in allowed:
            raise FirmwareError(f"firmware {action}: found '{flag}', allowed {', '.join(allowed)}")
    return action, board, "--keep-bootloader" in flags, "--swd" in flags


def name_of(board: str, keep_bootloader: bool) -> str:
    return f"firmware_{board}" + ("_behind_bootloader" if keep_bootloader else "")


def write_files(board: str, keep_bootloader: bool) -> Path:
    """Adds the DFU file to those of the build, and prints what there is. @returns the ELF file."""
    elf = project.ROOT / f"build/cortex-m7/firmware/boards/{board}/{name_of(board, keep_bootloader)}.elf"
    address = BEHIND_BOOTLOADER if keep_bootloader else FLASH
    elf.with_suffix(".dfu").write_bytes(dfu(elf.with_suffix(".bin").read_bytes(), address))
    subprocess.run(["arm-none-eabi-size", str(elf)], check=True)
    print(f"at {address:#010x}:")
    for suffix in (".elf", ".bin", ".hex", ".dfu"):
        print(elf.with_suffix(suffix))
    return elf


def flash(elf: Path, swd: bool) -> int:
    command = flash_command(elf, swd)
    if shutil.which(command[0]) is None:
        raise FirmwareError(f"{command[0]} is not installed: apt install {command[0]}")
    print(CONNECT[swd], "\n" + " ".join(command), flush=True)
    if subprocess.run(command, check=False).returncode != 0:
        raise FirmwareError(f"{command[0]} has not written the image; its text above says why")
    return 0


def main(arguments: list[str]) -> int:
    """With --target first: prints what must be built for these arguments."""
    try:
        only_target = arguments[:1] == ["--target"]
        action, board, keep_bootloader, swd = parse(arguments[1:] if only_target else arguments)
        if only_target:
            print(name_of(board, keep_bootloader) + ".elf")
            return 0
        elf = write_files(board, keep_bootloader)
        return flash(elf, swd) if action == "flash" else 0
    except FirmwareError as error:
        print(f"rosflight: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
