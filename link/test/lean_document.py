# SPDX-License-Identifier: BSD-3-Clause
"""The lean link as someone would write it who has nothing but docs/link.md.

The fields come from the document's table; checksum, stuffing and schema from its words.
"""

import re
import struct
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FORMATS = {"u8": "B", "u16": "H", "u32": "I", "u64": "Q", "i16": "h", "i32": "i", "i64": "q",
           "f32": "f", "f64": "d", "b8": "B", "c8": "s"}


def read_table():
    """id -> (name, payload bytes, fields as written)."""
    rows = re.findall(r"^\| (\d+) \| `(\w+)` \| (\d+) \| `([^`]+)` \|$",
                      (ROOT / "docs" / "link.md").read_text(), re.M)
    return {int(number): (name, int(size), fields) for number, name, size, fields in rows}


TABLE = read_table()


def schema():
    text = "".join(f"{number} {TABLE[number][0]} {TABLE[number][2]}\n" for number in range(2, 32))
    value = 2166136261
    for byte in text.encode():
        value = (value ^ byte) * 16777619 % 2**32
    return value


def checksum(content):
    crc = 0
    for byte in content:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x8408 if crc & 1 else 0)
    seed = 0 if content[0] == 1 else (schema() ^ schema() >> 16) & 0xFFFF
    return struct.pack("<H", crc ^ seed)


def framed(number, sequence, payload):
    content = bytes([number, sequence]) + payload
    rest = bytearray([0xFF]) + content + checksum(content)  # an FF in the place of the code
    places = [at for at, byte in enumerate(rest) if byte == 0xFF] + [len(rest)]
    for at, following in zip(places, places[1:]):
        rest[at] = 255 - (following - at)
    return b"\xff" + bytes(rest)


def unframed(frame):
    """Id, sequence and payload; None if the checksum is wrong."""
    assert frame[0] == 0xFF and 0xFF not in frame[1:]
    rest = bytearray(frame[1:])
    at = 0
    while at < len(rest):
        distance = 255 - rest[at]
        rest[at] = 0xFF
        at += distance
    assert at == len(rest)
    content = bytes(rest[1:-2])
    return (content[0], content[1], content[2:]) if checksum(content) == rest[-2:] else None
