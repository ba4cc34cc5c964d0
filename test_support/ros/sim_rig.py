# SPDX-License-Identifier: BSD-3-Clause
"""Launch files and single nodes of the simulator as processes, and an rclpy peer that answers them message by message.

Nothing here waits for a time: conditions only, with a timeout far beyond what a loaded machine needs."""

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time

import rclpy
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy, qos_profile_services_default
from ros_client import ask
from ros_rig import TIMEOUT_S, PREFIXES, ROOT, stop, wait_for
from rosflight_msgs.msg import SimState
from std_msgs.msg import Header

NEWEST = QoSProfile(depth=1)
ALL = QoSProfile(depth=5000)
BEST_EFFORT = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
ALL_BEST_EFFORT = QoSProfile(depth=5000, reliability=ReliabilityPolicy.BEST_EFFORT)
LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
VEHICLE = ROOT / "vehicles/multirotor.yaml"
LONG_S = 200.0  # simulated; for what takes tens of them


def executable(package, name):
    return next(place for prefix in PREFIXES if (place := prefix / "lib" / package / name).exists())


class Process:
    """A program and its output."""

    def __init__(self, *command, **options):
        self.lines = []
        self.changed = threading.Condition()
        self.process = subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, stdin=subprocess.DEVNULL,
                                        stderr=subprocess.STDOUT, text=True, **options)
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self):
        for line in self.process.stdout:
            with self.changed:
                self.lines.append(line.rstrip())
                self.changed.notify_all()
        with self.changed:
            self.changed.notify_all()

    def until(self, part, times=1):
        """The first line with `part` in it, or the one that makes it so many `times`."""
        def found():
            return next(iter([line for line in self.lines if part in line][times - 1:]), None)
        with self.changed:
            self.changed.wait_for(lambda: found() or not self.reader.is_alive(), TIMEOUT_S)
        assert found(), f"no line with {part!r} in:\n" + "\n".join(self.lines[-40:])
        return found()

    def says(self, part, times=1):
        """Waits for the lines with `part`, which are so many: what a node does may be seen before the line that reports it."""
        self.until(part, times)
        assert sum(part in line for line in self.lines) == times, self.text()

    def end(self):
        """Exit code of a program that ends by itself."""
        try:
            self.process.wait(2 * TIMEOUT_S)
        except subprocess.TimeoutExpired:
            self.stop()
            raise AssertionError("still runs:\n" + "\n".join(self.lines[-40:])) from None
        self.reader.join(TIMEOUT_S)
        return self.process.returncode

    def text(self):
        return "\n".join(self.lines)

    def stop(self, how=signal.SIGINT):
        return stop(self.process, how)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()


def node(name, package="rosflight_sim", at_launch=None, namespace=None, **parameters):
    """A node by itself, up. Parameters are given as on the command line."""
    words = [word for key, value in parameters.items() for word in ("-p", f"{key}:={value}")]
    words += ["-r", f"__node:={at_launch}"] if at_launch else []
    words += ["-r", f"__ns:={namespace}"] if namespace else []
    process = Process(executable(package, name), *(["--ros-args", *words] if words else []))
    try:
        process.until("ready")
    except AssertionError:
        process.stop()
        raise
    return process


def launch(*words, environment=None, **arguments):
    """./rosflight ros launch, inside the environment that the tests run in, changed by `environment`."""
    return Process(sys.executable, ROOT / "ros_standin/ros_launch", *words, *(f"{k}:={v}" for k, v in arguments.items()),
                   env={**os.environ, "ROSFLIGHT_GUI": "false", **(environment or {})})


def pid_of(world, program, argument=""):
    """Process of a node of this launch, among its children, with a text in its arguments. `ready` may be the
    graph's word for a node of this name that an earlier launch has left there."""
    def found():
        listed = subprocess.run(["ps", "-ww", "--ppid", str(world.process.pid), "-o", "pid=,args="], capture_output=True, text=True,
                                check=False)  # -ww: else ps may cut the path of a program at 80 columns
        words = (line.split() for line in listed.stdout.splitlines() if argument in line)
        return next((int(pid) for pid, file, *_ in words if file.endswith("/" + program)), None)
    wait_for(found, f"a process {program}", world.text)
    return found()


class SimPeer:
    """An rclpy node in a thread. It keeps all it receives, and wakes threads that wait."""

    def __init__(self, name="peer", namespace=None):
        self.node = rclpy.create_node(name, namespace=namespace)
        self.changed = threading.Condition()
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.running = True
        self.thread = threading.Thread(target=self._spin, daemon=True)
        self.thread.start()

    def _spin(self):
        while self.running:
            self.executor.spin_once(timeout_sec=0.05)

    def listen(self, kind, topic, qos=ALL, progress=None):
        """A list that grows with the messages. On `progress` it publishes how far: simulated time can wait for that (wait_for)."""
        received = []
        told = progress and self.publisher(Header, progress)

        def receive(message):
            with self.changed:
                received.append(message)
                self.changed.notify_all()
            if told:
                told.publish(message.header)
        self.node.create_subscription(kind, topic, receive, qos)
        return received

    @contextlib.contextmanager
    def reads(self, kind, topic, qos=ALL_BEST_EFFORT):
        """A subscription meanwhile. It is ended in the thread that spins, which rclpy does not let others do while it waits."""
        subscription = self.node.create_subscription(kind, topic, lambda message: None, qos)
        yield
        ended = self.executor.create_task(self.node.destroy_subscription, subscription)
        self.poll(ended.done, f"the end of a subscription of {topic}")

    def publisher(self, kind, topic, qos=NEWEST):
        return self.node.create_publisher(kind, topic, qos)

    def wait(self, condition, what, timeout_s=TIMEOUT_S):
        with self.changed:
            assert self.changed.wait_for(condition, timeout_s), f"waited {timeout_s} s for {what}"

    def wait_simulated(self, condition, what, now_s, limit_s=LONG_S):
        """As wait, but the limit counts simulated seconds, by now_s(): a slow machine has all the wall time that it needs. Fails
        too when that time stands still for TIMEOUT_S."""
        start = seen = now_s()
        moved = time.monotonic()
        with self.changed:
            while not condition():
                if now_s() != seen:
                    seen, moved = now_s(), time.monotonic()
                assert seen - start < limit_s, f"waited {limit_s:g} simulated s for {what}"
                assert time.monotonic() - moved < TIMEOUT_S, f"the world stood still for {TIMEOUT_S:g} s, waiting for {what}"
                self.changed.wait(0.2)

    def poll(self, condition, what):
        """As wait, for conditions that no message reports."""
        end = time.monotonic() + TIMEOUT_S
        while not condition():
            assert time.monotonic() < end, f"waited {TIMEOUT_S} s for {what}"
            time.sleep(0.01)

    def introduce(self, publish, received, what):
        """Publishes until an answer comes: after that the two know each other. Late answers are waited out."""
        end = time.monotonic() + TIMEOUT_S
        while not received:
            assert time.monotonic() < end, f"no answer on {what}"
            publish()
            with self.changed:
                self.changed.wait_for(lambda: received, 0.1)
        count = -1
        while count != len(received):
            assert time.monotonic() < end, f"{what} never falls silent"
            count = len(received)
            time.sleep(0.2)
        received.clear()

    def call(self, kind, service, /, **fields):
        return ask(self.node, kind, service, fields, TIMEOUT_S, qos_profile=qos_profile_services_default)

    def close(self):
        self.running = False
        self.thread.join(5)
        self.executor.shutdown()
        self.node.destroy_node()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def stamp(message, nanoseconds):
    """Sets the stamp of a header."""
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(nanoseconds, 1_000_000_000)
    return message


def stamp_ns(message):
    return message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec


def last_s(messages):
    """Time of the last of them [s]; 0 while there is none."""
    return stamp_ns(messages[-1]) * 1e-9 if messages else 0.0


def sim_state(ns, z=0.0):
    """Level, at rest, `z` [m] below the origin."""
    message = stamp(SimState(), ns)
    message.header.frame_id = "NED"
    message.pose.orientation.w = 1.0
    message.pose.position.z = z
    return message


def set_parameters(peer, name, **values):
    """Results of setting parameters of a node; numbers as doubles."""
    def value(given):
        if isinstance(given, bool):
            return ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=given)
        if isinstance(given, str):
            return ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=given)
        if isinstance(given, int):
            return ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=given)
        return ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=given)
    new = [Parameter(name=key, value=value(given)) for key, given in values.items()]
    return peer.call(SetParameters, f"{name}/set_parameters", parameters=new).results


def parameter(peer, name, key):
    return peer.call(GetParameters, f"{name}/get_parameters", names=[key]).values[0]
