#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Stand-in for HoloOcean's engine: its end of the shared-memory protocol over a flat world with one agent.

    standin_engine.py [OPTION...] -- WORLD -HolodeckOn ... --HolodeckUUID=NAME -TicksPerSec=N ...

It follows the public part of the engine's source (UHolodeckServer::Malloc, AHolodeckGameMode and AHolodeckPawnController::Tick,
AHolodeckAgent::SetState, UHolodeckSensor, URGBCamera, the commands' Execute) and what HoloOcean's client writes, and shares no
code with the adapter. Where the engine logs an error and goes on, this ends. The ground is at z = 0. A camera shows column, row
and the number of the tick since SpawnAgent as blue, green and red of a pixel.
"""
import argparse
import ctypes
import json
import math
import mmap
import os
import struct
import sys
import time

LIBC = ctypes.CDLL(None, use_errno=True)
LIBC.sem_open.restype = ctypes.c_void_p
GRAVITY_M_S2 = 9.8
COMMAND_BYTES = 8 * 1_048_576
ACTION_FLOATS = {"UAV": 4, "FixedWing": 8}
SCHEMES = {"UAV": 2, "FixedWing": 3}  # the index is taken modulo this
UAV_KG = 1.375
ARGUMENTS = ["-HolodeckOn", "-LOG", "-ForceRes", "-ResX", "-ResY", "--HolodeckUUID", "-TicksPerSec", "-FramesPerSec",
             *(f"-Env{end}{axis}" for end in ("Min", "Max") for axis in "XYZ"), "-OctreeMin", "-OctreeMax"]
COMMANDS = {"SpawnAgent": (2, 7), "AddSensor": (5, 6), "RenderViewport": (0, 1), "AdjustFPS": (0, 1), "AdjustTPS": (0, 1)}
LIGHT = {"LocationSensor": 12, "RotationSensor": 12, "VelocitySensor": 12, "CollisionSensor": 1}
CAMERAS = ("RGBCamera", "DepthCamera", "SemanticSegmentationCamera")
SETTINGS = {**dict.fromkeys(CAMERAS, {"CaptureWidth", "CaptureHeight", "TicksPerCapture"}), **dict.fromkeys(LIGHT, set()),
            "RangeFinderSensor": {"LaserMaxDistance", "LaserCount", "LaserAngle", "LaserDebug"}}


def fatal(what):
    sys.exit(f"Fatal error: {what}")


class Semaphore:
    def __init__(self, name: str, value: int | None):
        """value: created with it if absent; None: must exist."""
        flags = 0 if value is None else os.O_CREAT
        self.handle = LIBC.sem_open(name.encode(), ctypes.c_int(flags), ctypes.c_uint(0o777), ctypes.c_uint(value or 0))
        if not self.handle:
            sys.exit(f"semaphore {name}: {os.strerror(ctypes.get_errno())}")

    def post(self):
        LIBC.sem_post(ctypes.c_void_p(self.handle))

    def wait(self):
        while LIBC.sem_wait(ctypes.c_void_p(self.handle)) != 0:
            pass


class Memory(dict):
    """The blocks, mapped once for each key and size and kept across levels and clients: one that a client removes from
    /dev/shm is lost to the next."""

    def __init__(self, name: str):
        super().__init__()
        self.name = name

    def block(self, key: str, size: int) -> mmap.mmap:
        if key not in self or len(self[key]) != size:
            file = os.open(f"/dev/shm/HOLODECK_MEM{self.name}_{key}", os.O_RDWR | os.O_CREAT, 0o777)
            os.ftruncate(file, size)
            self[key] = mmap.mmap(file, size)
            os.close(file)
        return self[key]


# ---- rotations: 3 x 3, rows; x forward, y left, z up; roll, pitch, yaw about fixed x, y, z ------------------


def times(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def apply(a, v):
    return [sum(a[i][k] * v[k] for k in range(3)) for i in range(3)]


def about(axis, angle):
    """Rotation about a unit vector."""
    x, y, z = axis
    c, s = math.cos(angle), math.sin(angle)
    return [[c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
            [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
            [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)]]


def from_degrees(roll, pitch, yaw):
    r, p, y = (math.radians(a) for a in (roll, pitch, yaw))
    return times(about((0, 0, 1), y), times(about((0, 1, 0), p), about((1, 0, 0), r)))


def to_degrees(m):
    return [math.degrees(a) for a in (math.atan2(m[2][1], m[2][2]), math.asin(max(-1.0, min(1.0, -m[2][0]))),
                                      math.atan2(m[1][0], m[0][0]))]


# ---- what is in the world ------------------------------------------------------------------------------------


class Sensor:
    def __init__(self, engine, name, kind, configuration, offset, angles):
        self.kind, self.offset, self.turn = kind, offset, from_degrees(*angles)
        self.pixels, self.ticks = None, 0
        settings = json.loads(configuration) if configuration else {}
        if kind not in SETTINGS or not set(settings) <= SETTINGS[kind]:
            fatal(f"sensor {kind} with {list(settings)}")
        self.every = settings.get("TicksPerCapture", 1)
        self.width, self.height = settings.get("CaptureWidth", 256), settings.get("CaptureHeight", 256)
        self.rays, self.elevation = settings.get("LaserCount", 1), math.radians(settings.get("LaserAngle", 0))
        self.max_range = settings.get("LaserMaxDistance", 10)
        size = LIGHT.get(kind) or (4 * self.rays if kind == "RangeFinderSensor" else 4 * self.width * self.height)
        self.block = engine.memory.block(f"{engine.agent.name}_{name}_sensor_data", size)

    def measure(self, agent, tick) -> bool:
        """@returns whether the block is of this tick."""
        if self.kind in CAMERAS:
            self.ticks += 1  # since AddSensor
            if self.ticks == self.every:
                self.ticks = 0
                self.block[:] = self.picture(tick)
            return self.ticks == 0
        values = {"LocationSensor": lambda: agent.position, "RotationSensor": lambda: to_degrees(agent.attitude),
                  "VelocitySensor": lambda: agent.velocity, "RangeFinderSensor": lambda: self.distances(agent),
                  "CollisionSensor": lambda: None}[self.kind]()
        self.block[:] = bytes([agent.position[2] <= 0]) if values is None else struct.pack(f"<{len(values)}f", *values)
        return True

    def picture(self, tick) -> bytes:
        if self.kind == "DepthCamera":  # column c is 10 (c + 1) metres away
            codes = (round(10 * (c + 1) / 1000 * (2 ** 24 - 1)) for c in range(self.width))
            row = b"".join(bytes([code >> 16, code >> 8 & 255, code & 255, 255]) for code in codes)  # blue has the high byte
            return row * self.height
        if self.pixels is None:
            self.pixels = bytearray(b"".join(bytes([c & 255, r & 255, 0, 255]) for r in range(self.height) for c in range(self.width)))
        self.pixels[2::4] = bytes([tick & 255]) * (self.width * self.height)
        return bytes(self.pixels)

    def distances(self, agent):
        start = [p + d for p, d in zip(agent.position, apply(agent.attitude, self.offset), strict=True)]
        frame = times(agent.attitude, self.turn)
        result = []
        for i in range(self.rays):
            around, up = 2 * math.pi * i / self.rays, self.elevation
            ray = [math.cos(up) * math.cos(around), math.cos(up) * math.sin(around), math.sin(up)]
            slope = apply(frame, ray)[2]
            distance = -start[2] / slope if slope < 0 else math.inf
            result.append(distance if distance <= self.max_range else -1.0)
        return result


class Agent:
    def __init__(self, engine, kind, name, position, angles):
        self.kind, self.name, self.position, self.attitude = kind, name, position, from_degrees(*angles)
        self.velocity, self.rate = [0.0] * 3, [0.0] * 3  # both in world axes; rad/s
        self.action = engine.memory.block(name, 4 * ACTION_FLOATS[kind])
        self.scheme = engine.memory.block(f"{name}_control_scheme", 1)
        self.flag = engine.memory.block(f"{name}_teleport_flag", 1)
        self.command = engine.memory.block(f"{name}_teleport_command", 48)

    def take_state(self, record, tick):
        flag = self.flag[0]
        if not flag:
            return
        numbers = struct.unpack("<12f", self.command[:])
        record({"event": "state", "tick": tick, "flag": flag, "numbers": numbers})
        self.flag[0] = 0
        if flag & 5:  # bit 4: all twelve, whatever the others say
            self.position = list(numbers[0:3])
        if flag & 6:
            self.attitude = from_degrees(*numbers[3:6])
        if flag & 4:
            self.position[2] = max(self.position[2], 0.0)  # the sweep ends at the ground
            self.velocity = list(numbers[6:9])
            self.rate = apply(self.attitude, [math.radians(rate) for rate in numbers[9:12]])

    def acceleration(self):
        """Of the control scheme and of gravity."""
        action = struct.unpack(f"<{ACTION_FLOATS[self.kind]}f", self.action[:])
        scheme = self.scheme[0] % SCHEMES[self.kind]
        if (self.kind, scheme) == ("FixedWing", 2):  # accelerations in world axes, without gravity
            torque, force = action[3:], action[:3]
        elif (self.kind, scheme) == ("UAV", 0):  # torques and a thrust
            torque, force = action[:3], apply(self.attitude, [0, 0, action[3] / UAV_KG])
        else:
            torque, force = action, [0, 0, 0]
        if any(torque):
            fatal(f"action {action} of {self.kind} with scheme {scheme}, which the stand-in has no model of")
        return force if (self.kind, scheme) == ("FixedWing", 2) else [force[0], force[1], force[2] - GRAVITY_M_S2]

    def move(self, h):
        self.velocity = [v + a * h for v, a in zip(self.velocity, self.acceleration(), strict=True)]
        self.position = [p + v * h for p, v in zip(self.position, self.velocity, strict=True)]
        if speed := math.sqrt(sum(w * w for w in self.rate)):
            self.attitude = times(about([w / speed for w in self.rate], speed * h), self.attitude)


class Engine:
    def __init__(self, options, words):
        self.options = options
        self.out = open(options.record, "a", buffering=1) if options.record else None
        names = [word.partition("=")[0] for word in words[1:]]
        if not options.attach and names not in (ARGUMENTS, [*ARGUMENTS, "-RenderOffScreen"]):
            fatal(f"arguments {names}")
        flags = dict(w.lstrip("-").split("=", 1) for w in words[1:] if "=" in w)
        self.name, self.step = flags["HolodeckUUID"], 1 / int(flags["TicksPerSec"])
        self.frames_per_s, self.frame_end = int(flags["FramesPerSec"]), time.monotonic()
        self.record({"event": "start", "arguments": words, "process": os.getpid()})
        self.agent, self.sensors, self.tick, self.memory = None, {}, 0, Memory(self.name)

    def record(self, what):
        if self.out:
            self.out.write(json.dumps(what) + "\n")

    def run(self):
        self.server = Semaphore(f"/HOLODECK_SEMAPHORE_SERVER{self.name}", 1)
        self.client = Semaphore(f"/HOLODECK_SEMAPHORE_CLIENT{self.name}", 0)
        if not self.options.attach:
            Semaphore(f"/HOLODECK_LOADING_SEM{self.name}", None).post()
        self.reset = self.memory.block("RESET", 1)
        self.flag, self.buffer = self.memory.block("command_bool", 1), self.memory.block("command_buffer", COMMAND_BYTES)
        frame = 0
        while True:
            if frame:
                self.client.post()
            self.server.wait()
            frame += 1
            self.frame()

    def frame(self):
        if self.options.slow:
            time.sleep(self.options.slow)
        if self.frames_per_s:
            time.sleep(max(0.0, self.frame_end - time.monotonic()))
            self.frame_end = time.monotonic() + 1 / self.frames_per_s
        step = self.step  # AdjustTPS is for the next frame
        if self.flag[0]:
            self.commands()
            self.flag[0] = 0
        if self.reset[0]:
            self.record({"event": "reset", "tick": self.tick})
            self.agent, self.sensors = None, {}
            self.reset[0] = 0
        if not self.agent:
            return
        self.tick += 1
        self.agent.take_state(self.record, self.tick)
        if self.options.die_at == self.tick:
            sys.exit("Fatal error: out of video memory")
        while self.options.hang_at == self.tick:
            time.sleep(1)
        self.agent.move(step)
        for name, sensor in self.sensors.items():
            if sensor.measure(self.agent, self.tick) and self.options.measured:
                self.record({"event": "measured", "tick": self.tick, "sensor": name, "bytes": sensor.block[:].hex()})

    def commands(self):
        raw = self.buffer[:]
        text, end = json.JSONDecoder().raw_decode(raw[:raw.find(b"\0")].decode())
        whole = raw[:end + 1].decode()
        self.record({"event": "commands", "tick": self.tick, "text": whole})
        if not whole.endswith("}0") or list(text) != ["commands"]:
            fatal(f"commands {whole[-20:]!r}")
        for command in text["commands"]:
            if list(command) != ["type", "params"]:
                fatal(f"keys of a command {list(command)}")
            values = [param["value"] for param in command["params"]]
            texts = [v for v in values if isinstance(v, str)]
            numbers = [v for v in values if not isinstance(v, str)]
            self.command(command["type"], texts, numbers)

    def command(self, kind, texts, numbers):
        if COMMANDS.get(kind) != (len(texts), len(numbers)):
            fatal(f"{kind} with {len(texts)} texts and {len(numbers)} numbers")
        if kind == "SpawnAgent":
            if self.agent or texts[0] not in ACTION_FLOATS:
                fatal(f"agent {texts} beside {self.agent and self.agent.name}")
            self.agent = Agent(self, texts[0], texts[1], numbers[0:3], numbers[3:6])
            self.tick = 0
        elif kind == "AddSensor":
            agent, name, sensor, configuration, _socket = texts
            if agent != self.agent.name or name in self.sensors:
                fatal(f"sensor {name} of agent {agent}")
            self.sensors[name] = Sensor(self, name, sensor, configuration, numbers[0:3], numbers[3:6])
        elif kind == "AdjustFPS":
            self.frames_per_s = numbers[0]
        elif kind == "AdjustTPS":
            self.step = 1 / numbers[0]
        else:
            self.record({"event": "viewport", "on": numbers[0] == 1})


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--record", help="file for what the client did, a JSON object per line")
    parser.add_argument("--measured", action="store_true", help="records what the sensors measured, too")
    parser.add_argument("--slow", type=float, default=0, help="seconds that a frame takes")
    parser.add_argument("--die-at", type=int, help="ends in this tick")
    parser.add_argument("--hang-at", type=int, help="stops in this tick")
    parser.add_argument("--silent", action="store_true", help="never says that the world has loaded")
    parser.add_argument("--broken", action="store_true", help="ends at once")
    parser.add_argument("--attach", action="store_true", help="was not started by a client")
    cut = sys.argv.index("--")
    options = parser.parse_args(sys.argv[1:cut])
    if options.broken:
        sys.exit("error while loading shared libraries: libvulkan.so.1")
    engine = Engine(options, sys.argv[cut + 1:])
    while options.silent:
        time.sleep(1)
    engine.run()


if __name__ == "__main__":
    main()
