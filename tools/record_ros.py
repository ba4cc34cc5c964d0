# SPDX-License-Identifier: BSD-3-Clause
"""Plays the bytes of a logged flight to rosflight_io and writes down what the node publishes, for a comparison by value.

Usage: ./rosflight ros run .venv-ros/bin/python3 tools/record_ros.py LOG OUTPUT

LOG is a flight log of `fly` over MAVLink (the Python environment .venv decodes it); OUTPUT becomes a text file that
tools/compare_logs.py compares line by line: topic, number of the message, field and value, floating-point numbers as
their bits. Stamps are left out: they are times of the computer's clock. One frame is sent after the other, each when
the messages of the one before have arrived, so that a slow machine loses nothing.
"""

import socket
import subprocess
import sys
import time
from pathlib import Path

import rclpy
from rclpy.qos import QoSProfile
from ros_rig import NODE, ROOT, free_udp_port, stop

MAX_FRAMES = 12_000  # of the flight's start: every kind of message and the take-off
WAIT_S = 20.0  # for a message that must come
QUIET_S = 0.002  # after a frame that published nothing when it was first played
STAMPS = {"builtin_interfaces/Time"}
LEFT_OUT = {"/rosout", "/parameter_events", "/diagnostics"}  # texts, and figures of the clock


def frames_of(log: Path) -> list[bytes]:
    command = [ROOT / ".venv/bin/python3", ROOT / "tools/compare_logs.py", "--frames", log]
    lines = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
    return [bytes.fromhex(line) for line in lines[:MAX_FRAMES]]


def flattened(value, path=""):
    """Every field of a message as (path, text) without its stamps."""
    if hasattr(value, "get_fields_and_field_types"):
        for name, kind in value.get_fields_and_field_types().items():
            if kind not in STAMPS:
                yield from flattened(getattr(value, name), f"{path}.{name}")
    elif isinstance(value, (str, bytes, int)):
        yield path, repr(value)
    elif isinstance(value, float):
        yield path, value.hex()
    elif hasattr(value, "__len__"):
        yield f"{path}.size", str(len(value))
        for index, entry in enumerate(value):
            yield from flattened(entry.item() if hasattr(entry, "item") else entry, f"{path}[{index}]")
    else:
        raise TypeError(f"{path}: {type(value)}")


class Recorder:
    """Subscribes to every topic that the node publishes, as soon as it is there."""

    def __init__(self, node):
        self.node = node
        self.messages: dict[str, list] = {}

    def total(self) -> int:
        return sum(map(len, self.messages.values()))

    def spin(self, seconds: float):
        rclpy.spin_once(self.node, timeout_sec=seconds)

    def drain(self):
        """Takes what is on its way, until nothing has come for 0.2 s."""
        last, count = time.monotonic(), self.total()
        while time.monotonic() - last < 0.2:
            self.spin(0.05)
            if self.total() != count:
                last, count = time.monotonic(), self.total()

    def subscribe_new(self) -> bool:
        found = False
        for topic, (kind, *_) in self.node.get_topic_names_and_types():
            if topic in self.messages or topic in LEFT_OUT or not self.node.count_publishers(topic):
                continue
            package, _, name = kind.split("/")
            module = __import__(f"{package}.msg", fromlist=[name])
            self.messages[topic] = []
            self.node.create_subscription(getattr(module, name), topic, self.messages[topic].append,
                                          QoSProfile(depth=1000))
            found = True
        return found

    def lines(self):
        for topic, messages in sorted(self.messages.items()):
            for number, message in enumerate(messages):
                for path, text in flattened(message):
                    yield f"{topic} {number} {path} {text}\n"


def first_of_each_kind(frames: list[bytes]) -> list[bytes]:
    return list({frame[5]: frame for frame in reversed(frames)}.values())


def discover(recorder: Recorder, send, frames: list[bytes]) -> dict[int, int]:
    """Makes the node publish every topic once, and returns how many messages each kind of frame leads to."""
    end = time.monotonic() + WAIT_S
    quiet_rounds = 0
    while quiet_rounds < 5 and time.monotonic() < end:
        for frame in frames:
            send(frame)
        recorder.spin(0.2)
        quiet_rounds = 0 if recorder.subscribe_new() else quiet_rounds + 1
    leads_to = {}
    for frame in frames:
        counts = []
        for _ in range(3):
            recorder.drain()
            before = recorder.total()
            send(frame)
            recorder.drain()
            counts.append(recorder.total() - before)
        leads_to[frame[5]] = sorted(counts)[1]  # a topic may still have been connecting the first time
    return leads_to


def play(recorder: Recorder, send, frames: list[bytes], leads_to: dict[int, int]):
    for frame in frames:
        wanted = recorder.total() + leads_to[frame[5]]
        send(frame)
        end = time.monotonic() + WAIT_S
        while recorder.total() < wanted:
            recorder.spin(0.5)
            if time.monotonic() > end:
                raise TimeoutError(f"message {frame[5]}: expected {leads_to[frame[5]]} messages, got fewer in {WAIT_S} s")
        if not leads_to[frame[5]]:
            recorder.spin(QUIET_S)


def main(log: Path, output: Path):
    frames = frames_of(log)
    fcu, companion = free_udp_port(), free_udp_port()
    options = {"udp": "true", "bind_port": companion, "remote_port": fcu}
    words = [word for name, value in options.items() for word in ("-p", f"{name}:={value}")]
    link = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    link.bind(("127.0.0.1", fcu))
    process = subprocess.Popen([NODE, "--ros-args", *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    rclpy.init()
    try:
        recorder = Recorder(rclpy.create_node("recorder"))
        def send(frame):
            link.sendto(frame, ("127.0.0.1", companion))
        leads_to = discover(recorder, send, first_of_each_kind(frames))
        for messages in recorder.messages.values():
            messages.clear()
        play(recorder, send, frames, leads_to)
        output.write_text("".join(recorder.lines()))
        print(f"{recorder.total()} messages of {len(recorder.messages)} topics from {len(frames)} frames")
    finally:
        stop(process)
        rclpy.shutdown()


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    main(Path(sys.argv[1]), Path(sys.argv[2]))
