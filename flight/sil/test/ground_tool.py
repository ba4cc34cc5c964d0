# SPDX-License-Identifier: BSD-3-Clause
"""The program's command sil as a process, and a ground tool made of pymavlink and our dialect.

Every wait is bounded and far longer than a loaded machine needs.
"""

import importlib.util
import os
import select
import signal
import socket
import struct
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
BUILD = Path(os.environ.get("ROSFLIGHT_BUILD", ROOT / "build" / "release")).resolve()
PROGRAM = BUILD / "apps" / "rosflight"
TIMEOUT_S = 30.0
INT32, REAL32 = 6, 9  # MAV_PARAM_TYPE


def load_dialect():
    path = BUILD / "link" / "mavlink" / "mavlink_python" / "rosflight.py"
    spec = importlib.util.spec_from_file_location("rosflight_dialect_sil", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


DIALECT = load_dialect()


class Sil:
    """The program; ends with the test."""

    def __init__(self, folder, *options):
        command = [PROGRAM, "sil", "--nvm", folder / "memory", *options]
        self.process = subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True, cwd=folder)
        ready, _, _ = select.select([self.process.stdout], [], [], TIMEOUT_S)
        self.line = self.process.stdout.readline() if ready else ""
        assert self.line.startswith("sil ready "), self.process.communicate(timeout=TIMEOUT_S)
        self.words = dict(word.split("=", 1) for word in self.line.split()[2:])

    def end(self, how=signal.SIGTERM):
        self.process.send_signal(how)
        self.process.communicate(timeout=TIMEOUT_S)
        return self.process.returncode

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            assert self.end() == 0


class Port:
    """Bytes to and from the link of a Sil, whatever it is."""

    def __init__(self, sil, bound=None):
        kind, address = sil.words["link"].split(":", 1)
        self.socket = bound
        if kind == "udp":
            host, port = sil.words["listen"].rsplit(":", 1)
            bound.connect((host, int(port)))
        elif kind == "tcp":
            host, port = address.rsplit(":", 1)
            self.socket = socket.create_connection((host, int(port)), timeout=TIMEOUT_S)
        else:
            self.fd = os.open(address, os.O_RDWR | os.O_NOCTTY)
        if self.socket:
            self.fd = self.socket.fileno()
        os.set_blocking(self.fd, False)

    def write(self, data):
        for at in range(0, len(data), 1000):  # datagrams of usual size
            piece = data[at:at + 1000]
            while piece:
                _, ready, _ = select.select([], [self.fd], [], TIMEOUT_S)
                assert ready, "the firmware does not read"
                piece = piece[os.write(self.fd, piece):]

    def read(self, timeout_s):
        ready, _, _ = select.select([self.fd], [], [], timeout_s)
        return os.read(self.fd, 65536) if ready else b""

    def close(self):
        if self.socket:
            self.socket.close()
        else:
            os.close(self.fd)


class Ground:
    """A ground tool: pymavlink's encoder and parser on a port."""

    def __init__(self, port, system=255):
        self.port = port
        self.mav = DIALECT.MAVLink(self, srcSystem=system, srcComponent=190)
        self.mav.robust_parsing = True
        self.waiting = []

    def write(self, data):  # called by pymavlink's ..._send()
        self.port.write(data)

    def receive(self, timeout_s=0.1):
        data = self.port.read(timeout_s)
        self.waiting += self.mav.parse_buffer(data) or [] if data else []

    def expect(self, kind, accept=lambda message: True, timeout_s=TIMEOUT_S):
        """The next message of a kind that is acceptable, or None."""
        end = time.monotonic() + timeout_s
        while True:
            while self.waiting:
                message = self.waiting.pop(0)
                if message.get_type() == kind and accept(message):
                    return message
            if time.monotonic() > end:
                return None
            self.receive()

    def value(self, name):
        self.mav.param_request_read_send(1, 1, name.encode(), -1)
        answer = self.expect("PARAM_VALUE", lambda m: m.param_id == name)
        assert answer is not None, name
        return decoded(answer)

    def set(self, name, value, kind=INT32, system=1):
        self.mav.param_set_send(system, 1, name.encode(), encoded(value, kind), kind)

    def command(self, number):
        self.mav.rosflight_cmd_send(number)
        answer = self.expect("ROSFLIGHT_CMD_ACK", lambda m: m.command == number)
        assert answer is not None
        return answer.success == 1


def encoded(value, kind):
    """Integers travel as their bits in the place of a float."""
    return struct.unpack("<f", struct.pack("<i", value))[0] if kind == INT32 else value


def decoded(message):
    if message.param_type == INT32:
        return struct.unpack("<i", struct.pack("<f", message.param_value))[0]
    return message.param_value


def udp_socket():
    bound = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    bound.bind(("127.0.0.1", 0))
    return bound


class Connected:
    """A running firmware and a ground tool connected to it."""

    def __init__(self, kind, folder, *options):
        self.bound = udp_socket() if kind == "udp" else None
        link = {"pty": "pty", "tcp": "tcp:0"}.get(kind) or f"udp:127.0.0.1:{self.bound.getsockname()[1]}"
        self.sil = Sil(folder, "--link", link, *options)

    def __enter__(self):
        self.ground = Ground(Port(self.sil, self.bound))
        self.ground.sil = self.sil
        return self.ground

    def __exit__(self, *_):
        self.ground.port.close()
        self.sil.__exit__()
