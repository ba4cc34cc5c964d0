# SPDX-License-Identifier: BSD-3-Clause
"""The firmware as a process that is set to lean, and a tool written from docs/link.md."""

import struct
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parents[3] / "link" / "test"))
from ground_tool import TIMEOUT_S, Port, Sil  # noqa: E402
from lean_document import TABLE, framed, schema, unframed  # noqa: E402

IDS = {name: number for number, (name, _, _) in TABLE.items()}


class Tool:
    def __init__(self, port):
        self.port = port
        self.sequence = 0
        self.bytes = b""
        self.waiting = []

    def send(self, name, payload):
        self.port.write(framed(IDS[name], self.sequence % 256, payload))
        self.sequence += 1

    def expect(self, name, accept=lambda payload: True):
        """The payload of the next message of that name that is accepted."""
        end = time.monotonic() + TIMEOUT_S
        while time.monotonic() < end:
            while self.waiting:
                number, _, payload = unframed(b"\xff" + self.waiting.pop(0)) or (0, 0, b"")
                if number == IDS[name] and accept(payload):
                    return payload
            self.bytes += self.port.read(1.0)
            *whole, self.bytes = self.bytes.split(b"\xff")
            self.waiting = [frame for frame in whole if frame]
        raise AssertionError(f"no {name}")


def test_a_board_that_speaks_lean_greets_answers_and_sets(tmp_path):
    with Sil(tmp_path, "--link", "tcp:0", "--link-protocol", "lean") as sil:
        port = Port(sil)
        tool = Tool(port)
        greeting = tool.expect("Heartbeat")
        assert struct.unpack("<BI", greeting)[1] == schema()
        tool.send("Heartbeat", struct.pack("<BI", 0, schema()))
        tool.send("CommandRequest", bytes([10]))
        assert tool.expect("Version").rstrip(b"\0")
        assert tool.expect("CommandAck") == bytes([10, 1])
        tool.send("TimeSync", struct.pack("<qq", 0, 123456789))
        assert struct.unpack("<qq", tool.expect("TimeSync"))[1] == 123456789
        name = b"NUM_MOTORS".ljust(16, b"\0")
        tool.send("ParamSet", b"\x01" + name + struct.pack("<i", 6) + b"\x06")
        value = tool.expect("ParamValue", lambda payload: payload[:16] == name)
        assert struct.unpack("<iBHH", value[16:])[:2] == (6, 6)
        port.close()


def test_a_tool_of_another_schema_is_not_answered(tmp_path):
    with Sil(tmp_path, "--link", "tcp:0", "--link-protocol", "lean") as sil:
        port = Port(sil)
        tool = Tool(port)
        tool.send("Heartbeat", struct.pack("<BI", 0, schema() ^ 1))
        tool.send("TimeSync", struct.pack("<qq", 0, 1))
        tool.send("Heartbeat", struct.pack("<BI", 0, schema()))
        tool.send("TimeSync", struct.pack("<qq", 0, 2))
        assert struct.unpack("<qq", tool.expect("TimeSync"))[1] == 2  # the first answer there is
        port.close()
