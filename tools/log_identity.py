# SPDX-License-Identifier: BSD-3-Clause
"""Prints the identity of a flight log, which `fly --json` calls log_sha256: the SHA-256 over its contents, which
knows neither compression nor chunks (log/README.md says what exactly is hashed).

usage: log_identity.py LOG...
"""
import hashlib
import struct
import sys
from collections.abc import Iterator
from pathlib import Path

import zstandard

MAGIC = b"\x89MCAP0\r\n"
CHUNK, ATTACHMENT, METADATA, DATA_END = 0x06, 0x09, 0x0C, 0x0F


def contents(log: bytes) -> Iterator[bytes]:
    """The records of the data section, uncompressed, without chunks and their indexes."""
    at = len(MAGIC)
    if log[:at] != MAGIC:
        raise ValueError("not an MCAP file")
    while log[at] != DATA_END:
        opcode, length = struct.unpack_from("<BQ", log, at)
        record = log[at:at + 9 + length]
        if opcode == CHUNK:
            name = struct.unpack_from("<I", record, 9 + 28)[0]
            compression = record[41:41 + name].decode()
            packed = record[41 + name + 8:]
            yield zstandard.ZstdDecompressor().decompress(packed) if compression == "zstd" else packed
        elif opcode in (ATTACHMENT, METADATA):
            yield record
        at += len(record)


def identity(path: Path) -> str:
    digest = hashlib.sha256()
    for part in contents(path.read_bytes()):
        digest.update(part)
    return digest.hexdigest()


def main(paths: list[str]) -> int:
    if not paths:
        print(__doc__.split("\n\n")[-1].strip(), file=sys.stderr)
        return 2
    for path in paths:
        try:
            print(f"{identity(Path(path))}  {path}")
        except (OSError, ValueError, IndexError, struct.error) as error:
            print(f"{path}: cannot read: {error}", file=sys.stderr)
            return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
