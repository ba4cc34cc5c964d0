# SPDX-License-Identifier: BSD-3-Clause
"""lean_document.py, written from the document alone, at the other end of the lean link.

Random messages go to our codec, which reads them and encodes them again, and come back the same.
"""

import os
import random
import re
import struct
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from lean_document import FORMATS, ROOT, TABLE, framed, schema, unframed  # noqa: E402

BUILD = Path(os.environ.get("ROSFLIGHT_BUILD", ROOT / "build" / "release"))


def random_payload(rng, number):
    payload = b""
    for field in TABLE[number][2].split():
        name, kind, count = re.fullmatch(r"(\w+):(\w+)(?:\[(\d+)\])?", field).groups()
        count = int(count or 1)
        if name == "schema":
            payload += struct.pack("<I", schema())
        elif kind == "c8":
            longest = count if count == 16 else count - 1
            text = bytes(rng.randrange(1, 256) for _ in range(rng.randrange(longest + 1)))
            payload += text.ljust(count, b"\0")
        elif kind == "b8":
            payload += bytes([rng.randrange(2)])
        else:
            size = struct.calcsize(FORMATS[kind]) * count
            dense = rng.randrange(3) == 0  # sometimes nearly all FF
            payload += bytes(0xFF if dense and rng.randrange(8) else rng.randrange(256)
                             for _ in range(size))
    return payload


@pytest.fixture(scope="module")
def exchange():
    rng = random.Random(1)
    sent = [(number, random_payload(rng, number)) for _ in range(40) for number in TABLE]
    frames = [framed(number, k % 256, payload).hex() for k, (number, payload) in enumerate(sent)]
    done = subprocess.run([BUILD / "link" / "test" / "link_codec_peer", "lean"], text=True,
                          input="\n".join(frames) + "\n", capture_output=True, check=True, timeout=60)
    answers = [line.split(" | ") for line in done.stdout.splitlines()]
    assert len(answers) == len(sent)
    return list(zip(sent, answers))


def test_the_table_is_whole():
    assert sorted(TABLE) == list(range(1, 32))
    for _, size, fields in TABLE.values():
        kinds = re.findall(r":(\w+)(?:\[(\d+)\])?", fields)
        assert size == sum(struct.calcsize(FORMATS[kind]) * int(count or 1) for kind, count in kinds)


def test_the_schema_is_the_one_the_document_names():
    assert f"`{schema():08X}`" in (ROOT / "docs" / "link.md").read_text()


def test_our_codec_reads_each_as_the_message_of_its_id(exchange):
    for (number, _), (ours, _) in exchange:
        assert ours.split()[0] == str(number)


def test_what_our_codec_wrote_is_what_it_read(exchange):
    for k, ((number, payload), (_, again)) in enumerate(exchange):
        assert unframed(bytes.fromhex(again)) == (number, k % 256, payload), TABLE[number][0]


def test_a_frame_with_another_schema_fails_the_checksum():
    frame = bytearray(framed(11, 0, b"\x0a\x01"))
    frame[-1] ^= 1
    assert unframed(bytes(frame)) is None
