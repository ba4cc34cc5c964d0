# SPDX-License-Identifier: BSD-3-Clause
import os
import struct
import zlib
from pathlib import Path

import firmware_files
import pytest

IMAGE = bytes(range(256)) * 3


def test_dfu_file_has_the_image_at_its_address_and_a_right_checksum():
    """Read by the offsets of UM0391, not by what wrote it."""
    file = firmware_files.dfu(IMAGE, 0x08020000)
    assert file[:6] == b"DfuSe\x01"
    assert struct.unpack_from("<I", file, 6)[0] == len(file) - 16
    assert file[11:17] == b"Target"
    target_size, elements = struct.unpack_from("<II", file, 11 + 266)
    assert (target_size, elements) == (8 + len(IMAGE), 1)
    address, size = struct.unpack_from("<II", file, 11 + 274)
    assert (address, size) == (0x08020000, len(IMAGE))
    assert file[11 + 282:-16] == IMAGE
    assert struct.unpack_from("<HHH", file, len(file) - 14) == (0xDF11, 0x0483, 0x011A)
    assert file[-8:-4] == b"UFD\x10"
    # CRC-32 without the last inversion: that of the whole file with its checksum is then all ones.
    assert zlib.crc32(file) ^ 0xFFFFFFFF == 0


@pytest.mark.parametrize("arguments, said", [
    ([], "found 'nothing', allowed build, flash"),
    (["build"], "found 'nothing', allowed pixracer_pro, varmint, varmint_10x"),
    (["build", "varmint_99"], "found 'varmint_99', allowed pixracer_pro, varmint, varmint_10x"),
    (["build", "varmint", "now"], "found 'now' after the board"),
    (["build", "varmint", "--swd"], "found '--swd', allowed --keep-bootloader"),
    (["flash", "varmint", "--fast"], "found '--fast', allowed --keep-bootloader, --swd"),
])
def test_wrong_words_are_one_line_and_exit_code_2(arguments, said, capsys):
    assert firmware_files.main(arguments) == 2
    text = capsys.readouterr().err
    assert said in text
    assert text.count("\n") == 1


def test_target_of_the_build(capsys):
    assert firmware_files.main(["--target", "flash", "--keep-bootloader", "pixracer_pro"]) == 0
    assert capsys.readouterr().out.strip() == "firmware_pixracer_pro_behind_bootloader.elf"


def test_a_missing_tool_is_named_with_what_installs_it(monkeypatch):
    monkeypatch.setattr(firmware_files.shutil, "which", lambda name: None)
    with pytest.raises(firmware_files.FirmwareError, match="dfu-util is not installed: apt install dfu-util"):
        firmware_files.flash(Path("a.elf"), swd=False)


def test_a_failed_write_is_an_error(monkeypatch):
    monkeypatch.setattr(firmware_files.shutil, "which", lambda name: name)
    monkeypatch.setattr(firmware_files.subprocess, "run", lambda command, check: type("Done", (), {"returncode": 1})())
    with pytest.raises(firmware_files.FirmwareError, match="openocd has not written"):
        firmware_files.flash(Path("a.elf"), swd=True)


@pytest.mark.parametrize("swd, tool, named", [
    (False, "dfu-util", ["USB", "boot pin is held high", "BOOT0", "Pixracer Pro"]), (True, "openocd", ["ST-Link", "SWDIO", "SWCLK", "ground", "power"])])
def test_what_to_connect_is_printed_before_the_tool_writes(tmp_path, monkeypatch, capfd, swd, tool, named):
    program = tmp_path / tool
    program.write_text('#!/bin/sh\necho "writes: $*"\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    assert firmware_files.flash(Path("firmware.elf"), swd) == 0
    connect, command, written = [line.strip() for line in capfd.readouterr().out.splitlines()]
    assert connect.startswith("Connect ") and all(word in connect for word in named)
    assert written.startswith("writes: ") and command == f"{tool} {written.removeprefix('writes: ')}"
    assert ("firmware.elf" in command) if swd else ("0483:df11" in command and "firmware.dfu" in command)
