# SPDX-License-Identifier: BSD-3-Clause
"""What tests under ros/ share: starting nodes as processes, and an rclpy node that talks to them.

Waiting is always for a condition, never for a time; the limits only end a test that has failed.
"""

import os
import signal
import subprocess
import tempfile
import threading
import time
from pathlib import Path

import rclpy
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from ros_client import ask

LIMIT_S = 120.0  # see TIMEOUT_S of ros_rig


def executable(package: str, name: str) -> str:
    """Path of a program that a package has installed."""
    for prefix in os.environ["AMENT_PREFIX_PATH"].split(":"):
        path = Path(prefix) / "lib" / package / name
        if path.exists():
            return str(path)
    raise FileNotFoundError(f"no program {name} of package {package} in AMENT_PREFIX_PATH")


def lite_program(name: str, *words: str) -> list[str]:
    """Command of a test program of rclcpp_lite."""
    return [executable("rclcpp", f"rclcpp_lite_{name}"), *words]


def until(condition, what: str, limit_s: float = LIMIT_S):
    """Waits until condition() is true and returns what it returned; fails with `what` otherwise."""
    end = time.monotonic() + limit_s
    while time.monotonic() < end:
        result = condition()
        if result:
            return result
        time.sleep(0.005)
    raise AssertionError(f"after {limit_s:g} s still not: {what}")


def best_effort(depth: int = 10) -> QoSProfile:
    return QoSProfile(depth=depth, reliability=ReliabilityPolicy.BEST_EFFORT)


def latched(depth: int = 1) -> QoSProfile:
    return QoSProfile(depth=depth, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Process:
    """A node as a process; what it writes goes to a file. Use it in a with statement."""

    def __init__(self, command: list[str], **variables: str):
        self.output = tempfile.NamedTemporaryFile("w+", suffix=".log")
        self.process = subprocess.Popen(command, env={**os.environ, **variables},
                                        stdin=subprocess.DEVNULL, stdout=self.output,
                                        stderr=subprocess.STDOUT)

    def __enter__(self):
        return self

    def __exit__(self, *error):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
            try:
                self.process.wait(LIMIT_S)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
                raise AssertionError("did not end after SIGINT; said: " + self.said()) from None
        # Also when all was well: a sanitizer that found something says so by the exit code.
        assert error[0] is not None or self.process.returncode == 0, self.said()

    def said(self) -> str:
        return Path(self.output.name).read_text(errors="replace")

    def end(self, number: int = signal.SIGINT) -> int:
        """Sends a signal and returns the exit code."""
        self.process.send_signal(number)
        return self.process.wait(LIMIT_S)


def run(command: list[str], **variables: str) -> subprocess.CompletedProcess:
    """Runs a program to its end; stdout and stderr are in .stdout."""
    return subprocess.run(command, env={**os.environ, **variables}, text=True, timeout=LIMIT_S,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT)


class Tester:
    """An rclpy node that spins in a thread of its own. Use it in a with statement."""

    __test__ = False  # pytest would take the name for one of a test

    def __init__(self, name: str = "tester", **options):
        self.context = rclpy.Context()
        rclpy.init(context=self.context)
        self.node = rclpy.create_node(name, context=self.context, **options)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.publishers_matched: dict[str, int] = {}
        self.thread = threading.Thread(target=self._spin)
        self.thread.start()

    def _spin(self):
        try:
            self.executor.spin()
        except ExternalShutdownException:
            pass

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.executor.shutdown()
        rclpy.shutdown(context=self.context)
        self.thread.join()
        self.node.destroy_node()

    def subscribe(self, kind, topic: str, qos=10) -> list:
        """Messages of the topic, in a list that grows."""
        received: list = []

        def matched(event):
            self.publishers_matched[topic] = event.current_count
        self.publishers_matched[topic] = 0
        self.node.create_subscription(kind, topic, received.append, qos,
                                      event_callbacks=SubscriptionEventCallbacks(matched=matched))
        return received

    def publisher(self, kind, topic: str, qos=10, subscribers: int = 1):
        """A publisher that somebody listens to."""
        publisher = self.node.create_publisher(kind, topic, qos)
        until(lambda: publisher.get_subscription_count() >= subscribers, f"{topic} has a subscriber")
        return publisher

    def matched(self, topic: str, publishers: int = 1):
        """Waits until so many publishers have matched the newest subscription to the topic, or are seen without one.

        The publisher may know of the subscription a moment later: what must not be missed is asked for again, or kept.
        """
        def count():
            known = self.publishers_matched
            return known[topic] if topic in known else self.node.count_publishers(topic)
        until(lambda: count() >= publishers, f"{topic} is published")

    def call(self, kind, service: str, limit_s: float = LIMIT_S, **request):
        """The response of a service, called with these fields."""
        return ask(self.node, kind, service, request, limit_s)
