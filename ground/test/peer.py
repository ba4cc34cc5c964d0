# SPDX-License-Identifier: BSD-3-Clause
"""Flight control units made of pymavlink, for what the firmware as a process does not do."""

import math
import socket
import sys
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "flight" / "sil" / "test"))
from ground_tool import DIALECT, REAL32, TIMEOUT_S  # noqa: E402


class OldFirmware(threading.Thread):
    """The other end as ROSflight 2.x sends it: heartbeat, status and IMU; no list of checks, no parameters."""

    def __init__(self, kinds):
        super().__init__(daemon=True)
        self.kinds = kinds
        self.ended = threading.Event()
        self.server = socket.create_server(("127.0.0.1", 0))
        self.link = "tcp:127.0.0.1:%d" % self.server.getsockname()[1]
        self.start()

    def run(self):
        self.server.settimeout(TIMEOUT_S)
        client, _ = self.server.accept()
        mav = DIALECT.MAVLink(client.makefile("wb", buffering=0), srcSystem=1, srcComponent=250)
        began = time.monotonic()
        for k in range(100000):
            if self.ended.wait(0.01):
                break
            try:
                if "heartbeat" in self.kinds and k % 50 == 0:
                    mav.heartbeat_send(2, 0, 0, 0, 0)
                if "status" in self.kinds and k % 10 == 0:
                    mav.rosflight_status_send(0, 0, 0, 0, 0x04, 0, 0, 0)  # RC lost
                mav.small_imu_send(int(1e6 * (time.monotonic() - began)), 0.0, 0.0, -9.8, 0.0, 0.0, 0.0, 300.0)
            except OSError:
                break
        client.close()
        self.server.close()


class HandTurned(OldFirmware):
    """In the hands of a person who does what the calibration of the magnetometer asks for: six faces, two circles with each."""

    HARD_IRON_T = (15e-6, -10e-6, 5e-6)
    HOLD_S, TURN_S, CIRCLES = 2.6, 3.0, 2
    STEP_S = 0.0025  # of the hand: a circle has as many samples on any machine
    MAX_STEP_S = 0.2  # a busy machine makes the hand slow; it does not tear it from face to face
    FACES = [(0, 0, 1), (1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0), (0, 0, -1)]  # body axis that points down

    def __init__(self):
        self.values = {name: 0.0 for name in ("MAG_X_BIAS", "MAG_Y_BIAS", "MAG_Z_BIAS")}
        self.values.update({f"MAG_CAL_A{i}{j}": float(i == j) for i in range(3) for j in range(3)})
        self.stored = False
        super().__init__({"heartbeat", "status"})

    def run(self):
        self.server.settimeout(TIMEOUT_S)
        client, _ = self.server.accept()
        client.setblocking(False)
        self.mav = DIALECT.MAVLink(client.makefile("wb", buffering=0), srcSystem=1, srcComponent=250)
        owed_s, last, step = 0.0, time.monotonic(), 0
        while not self.ended.wait(self.STEP_S):
            now = time.monotonic()
            owed_s += min(now - last, self.MAX_STEP_S)
            last = now
            try:
                for message in self.mav.parse_buffer(_received(client)) or []:
                    self.answer(message)
                while owed_s >= self.STEP_S:
                    owed_s -= self.STEP_S
                    if step % 400 == 0:
                        self.mav.heartbeat_send(2, 0, 0, 0, 0)
                    if step % 40 == 0:
                        self.mav.rosflight_status_send(0, 0, 0, 0, 0, 0, 0, 0)
                    self.sample(step * self.STEP_S)
                    step += 1
            except OSError:
                break
        client.close()
        self.server.close()

    def send_value(self, name):
        names = list(self.values)
        self.mav.param_value_send(name.encode(), self.values[name], REAL32, len(names), names.index(name))

    def answer(self, message):
        kind = message.get_type()
        if kind == "PARAM_REQUEST_LIST":
            for name in self.values:
                self.send_value(name)
        elif kind == "PARAM_REQUEST_READ":
            name = list(self.values)[message.param_index] if message.param_index >= 0 else message.param_id
            if name in self.values:
                self.send_value(name)
        elif kind == "PARAM_SET" and message.param_id in self.values:
            self.values[message.param_id] = message.param_value
            self.send_value(message.param_id)
        elif kind == "ROSFLIGHT_CMD":
            self.stored = self.stored or message.command == DIALECT.ROSFLIGHT_CMD_WRITE_PARAMS
            self.mav.rosflight_cmd_ack_send(message.command, 1)

    def sample(self, t_s):
        """Specific force and corrected field of that moment; field of 50 uT, inclined by 60 deg."""
        step, within = divmod(t_s, self.HOLD_S + self.TURN_S)
        down = self.FACES[int(step) % len(self.FACES)]
        heading = 2 * math.pi * self.CIRCLES * max(0.0, within - self.HOLD_S) / self.TURN_S
        north = (down[1], down[2], down[0])  # at right angles to it
        east = tuple(down[(i + 1) % 3] * north[(i + 2) % 3] - down[(i + 2) % 3] * north[(i + 1) % 3] for i in range(3))
        force = [-9.80665 * d for d in down]
        raw = [43.3e-6 * d + 25e-6 * (math.cos(heading) * n - math.sin(heading) * e) + b
               for d, n, e, b in zip(down, north, east, self.HARD_IRON_T)]
        off = [m - self.values[f"MAG_{axis}_BIAS"] for m, axis in zip(raw, "XYZ")]
        field = [sum(self.values[f"MAG_CAL_A{i}{j}"] * off[j] for j in range(3)) for i in range(3)]
        self.mav.small_imu_send(int(1e6 * t_s), *force, 0.0, 0.0, 0.0, 300.0)
        self.mav.small_mag_send(*field)


def _received(client):
    try:
        return client.recv(65536)
    except BlockingIOError:
        return b""


if __name__ == "__main__":  # in the hands of a person, for the tests of the page
    vehicle = HandTurned()
    print(vehicle.link, flush=True)
    vehicle.join()
