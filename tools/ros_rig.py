# SPDX-License-Identifier: BSD-3-Clause
"""The real firmware in real time, the I/O node at its link, and rclpy as the peer, for tests and demonstrations under
ros/. Runs inside the ROS environment. Every wait is bounded and far longer than a loaded machine needs."""

import csv
import os
import random
import select
import signal
import socket
import subprocess
import threading
import time
from pathlib import Path

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile
from pytest_files import ROS_LANES
from ros_client import ask

ROOT = Path(__file__).resolve().parents[1]
PROGRAM = Path(os.environ.get("ROSFLIGHT_BUILD", ROOT / "build" / "release")) / "apps" / "rosflight"
SIL_TOOLS = PROGRAM.parent / "measure"  # sil_echo, sil_link_rtt, sil_cable
PREFIXES = [Path(prefix) for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(":")]


def program(package, name):
    """Where the program of a package is installed; None if nowhere."""
    return next((place for prefix in PREFIXES if (place := prefix / "lib" / package / name).exists()), None)


NODE = program("rosflight_io", "rosflight_io")
TIMEOUT_S = 120.0  # for what takes a second: one core that others use too, or a machine that stands still for a while


def table():
    """Parameters of the firmware, a dictionary each: the 333 of ROSflight 2.x and ours behind them."""
    with (ROOT / "firmware" / "core" / "parameters.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def table_size():
    return len(table())


_given = set()  # ports; who asks binds them later


def free_udp_port():
    """Below the range of which sockets without a wish get theirs, so that none takes it meanwhile, and not one of DDS, whose domain D
    uses the first ports from 7400 + 250 D. Never one twice, and with the remainder of the domain: tools/ros_test.py gives the tests
    that run beside these a domain with another."""
    while True:
        port = random.SystemRandom().randrange(20_000, 32_000)
        if (port - 7400) % 250 < 125 or port in _given or (port - int(os.environ.get("ROS_DOMAIN_ID", "0"))) % ROS_LANES:
            continue
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
            _given.add(port)
            return port


def write_parameters(file, values):
    """Parameters by name as a file of rosflight_io. Integers are those of the table, not floats."""
    lines = [f"- {{name: {name}, type: {6 if isinstance(value, int) else 9}, value: {value}}}\n"
             for name, value in values.items()]
    Path(file).write_text("".join(lines))


def stop(process, how=signal.SIGINT):
    if process.poll() is None:
        process.send_signal(how)
        try:
            process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
    return process.returncode


def start_ready(command, word, folder=None):
    """A program that prints a line with `word` first once it can be used. @returns process and line."""
    process = subprocess.Popen([str(part) for part in command], stdout=subprocess.PIPE, text=True,
                               stderr=subprocess.DEVNULL, cwd=folder)
    ready, _, _ = select.select([process.stdout], [], [], TIMEOUT_S)
    line = process.stdout.readline() if ready else ""
    assert line.startswith(word), f"{command[0]}: {line!r}"
    return process, line


class Sil:
    """The firmware and its vehicle as a process. `link` holds the options of its serial port."""

    def __init__(self, folder, link, *options, program=PROGRAM):
        self.command = [program, "sil", "--nvm", folder / "memory", *link, *options]
        self.folder = folder
        self.start()

    def start(self):
        self.process, line = start_ready(self.command, "sil ready ", self.folder)
        self.where = line.split()[2]  # link=pty:/dev/pts/3
        self.start_us = int(line.split("start_us=")[1].split()[0])  # of the steady clock: the first sample

    def stop(self, how=signal.SIGTERM):
        return stop(self.process, how)


class Cable:
    """A serial cable with byte times and noise; the companion's end is the pty `where`."""

    def __init__(self, board_port, own_port, *options):
        self.process, line = start_ready([SIL_TOOLS / "sil_cable", "--board", f"udp:localhost:{board_port}",
                                          "--listen", own_port, *options], "cable ready ")
        self.where = line.split()[2].removeprefix("link=pty:")

    def stop(self):
        return stop(self.process)


class Io:
    """The node as a process; its log in `lines`."""

    def __init__(self, *arguments, namespace="", words=()):
        command = [str(NODE), *words, "--ros-args", *arguments]
        if namespace:
            command += ["-r", f"__ns:={namespace}"]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.lines = []
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self):
        for line in self.process.stdout:
            self.lines.append(line.rstrip())

    def wait_line(self, part):
        def found():
            ended = not self.reader.is_alive()
            if any(part in line for line in self.lines):
                return True
            assert not ended, f"the node ended before '{part}': {self.lines[-20:]}"
            return False
        wait_for(found, f"'{part}' in the node's log", lambda: self.lines[-20:])

    def stop(self, how=signal.SIGINT):
        return stop(self.process, how)


def wait_for(condition, what, describe=lambda: "", timeout_s=TIMEOUT_S):
    end = time.monotonic() + timeout_s
    while not condition():
        assert time.monotonic() < end, f"waited {timeout_s} s for {what}: {describe()}"
        time.sleep(0.01)


class Peer:
    """An rclpy node that spins in a thread and keeps what it receives."""

    def __init__(self, namespace=""):
        self.node = rclpy.create_node("peer", namespace=namespace or None)
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.received = {}
        self.thread = threading.Thread(target=self._spin, daemon=True)
        self.running = True
        self.thread.start()

    def _spin(self):
        try:
            while self.running:
                self.executor.spin_once(timeout_sec=0.05)
        except ExternalShutdownException:
            pass

    def listen(self, kind, topic, depth=100, latched=False):
        """A list that grows with (arrival in s, message)."""
        received = self.received.setdefault(topic, [])
        qos = QoSProfile(depth=depth)
        if latched:
            qos.durability = DurabilityPolicy.TRANSIENT_LOCAL
        self.node.create_subscription(kind, topic, lambda m: received.append((time.time(), m)), qos)
        return received

    def call(self, kind, service, /, **fields):
        """The answer to one request."""
        return ask(self.node, kind, service, fields, TIMEOUT_S)

    def close(self):
        self.running = False
        self.thread.join(timeout=5)
        self.executor.shutdown()
        self.node.destroy_node()


class Link:
    """The firmware and its way to a companion: over UDP, a pty, or a cable of 921600 baud."""

    KINDS = ("udp", "pty", "cable")

    def __init__(self, kind, folder, *sil_options, program=PROGRAM, cable_options=()):
        there, here = free_udp_port(), free_udp_port()
        options = ["--link", "pty"] if kind == "pty" else ["--link", f"udp:localhost:{here}", "--listen", str(there)]
        self.sil = Sil(folder, options, *sil_options, program=program)
        self.cable = Cable(there, here, *cable_options) if kind == "cable" else None
        if kind == "udp":
            self.address = f"udp:localhost:{there}:{here}"  # of base/transport/link_address.hpp
            self.node_arguments = ["-p", "udp:=true", "-p", f"remote_port:={there}", "-p", f"bind_port:={here}"]
        else:
            device = self.cable.where if self.cable else self.sil.where.removeprefix("link=pty:")
            self.address = f"serial:{device}"
            self.node_arguments = ["-p", f"port:={device}"]

    def stop(self):
        if self.cable:
            self.cable.stop()
        self.sil.stop()


class Rig:
    """Firmware, node and peer, connected over UDP or as `kind` says, all parameters received."""

    def __init__(self, folder, *sil_options, namespace="", kind="udp", program=PROGRAM, cable_options=(), node_arguments=()):
        self.link = Link(kind, folder, *sil_options, program=program, cable_options=cable_options)
        self.link.node_arguments += node_arguments
        self.sil = self.link.sil
        self.folder = folder
        self.namespace = namespace
        try:
            self.start_io()
        except BaseException:
            self.link.stop()
            raise
        self.peer = Peer(namespace)

    def start_io(self, words=()):
        self.io = Io(*self.link.node_arguments, namespace=self.namespace, words=words)
        try:
            self.io.wait_line("parameters received")
        except BaseException:
            self.io.stop()
            raise

    def close(self):
        self.peer.close()
        self.io.stop()
        self.link.stop()
