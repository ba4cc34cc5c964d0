# SPDX-License-Identifier: BSD-3-Clause
"""The ratio of simulated time to wall time of the launched simulator and stack, and how often their threads wake up for each step of the
world; ros_demo.py documents its use."""

import contextlib
import json
import os
import re
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import rclpy
from ros_rig import ROOT, TIMEOUT_S, Peer, free_udp_port, stop, wait_for
from rosflight_msgs.msg import Status

FASTEST = 100.0  # more than any machine holds
SETTLE_S = 5.0  # simulated, after the firmware has its parameters
STEP_S = 0.0025  # of the world: the IMU's period


@contextlib.contextmanager
def launched(composed: bool, folder: Path):
    """roscopter's fly.launch.py as a user starts it, as fast as it can; waits until the firmware has its parameters."""
    arguments = {"use_sim_time": "true", "real_time_multiplier": FASTEST, "composed": str(composed).lower(),
                 "memory_folder": folder, "simulation_port": free_udp_port(), "ROS_port": free_udp_port()}
    process = subprocess.Popen(
        [sys.executable, str(ROOT / "ros_standin/ros_launch"), "roscopter", "fly.launch.py",
         *(f"{name}:={value}" for name, value in arguments.items())],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env={**os.environ, "ROSFLIGHT_GUI": "false"})
    lines: list[str] = []

    def read():
        for line in process.stdout:
            lines.append(line.rstrip())
    threading.Thread(target=read, daemon=True).start()
    try:
        wait_for(lambda: any("all stored" in line for line in lines) or process.poll() is not None,
                 "the firmware's parameters", lambda: "\n".join(lines[-10:]), 3 * TIMEOUT_S)
        if process.poll() is not None:
            raise RuntimeError(lines[-1] if lines else "the launch ended")
        yield process.pid
    finally:
        stop(process)


def descendants(pid: int) -> set[int]:
    """Processes that run below another one."""
    parents = {}
    for entry in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):  # it has ended
            parents[int(entry.parent.name)] = int(entry.read_text().rpartition(")")[2].split()[1])
    found = {pid}
    while new := {child for child, parent in parents.items() if parent in found} - found:
        found |= new
    return found - {pid}


def waits(pids: set[int]) -> int:
    """How often threads of these processes have waited for something so far; each ends with a wake-up."""
    total = 0
    for pid in pids:
        for status in Path(f"/proc/{pid}/task").glob("*/status"):
            with contextlib.suppress(OSError):
                total += int(re.search(r"^voluntary_ctxt_switches:\s+(\d+)", status.read_text(), re.MULTILINE)[1])
    return total


def measure(composed: bool, seconds: float) -> dict:
    """Simulated over wall time in `seconds` of wall time, by the stamps of a topic with few messages; wake-ups of all threads below the
    launch for each step of the world."""
    peer = Peer()
    try:
        with tempfile.TemporaryDirectory() as scratch, launched(composed, Path(scratch)) as launch:
            status = peer.listen(Status, "status")

            def simulated(message):
                return message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec
            wait_for(lambda: status and simulated(status[-1][1]) > simulated(status[0][1]) + SETTLE_S, "the world to move")
            nodes = descendants(launch)
            first, before = status[-1], waits(nodes)
            time.sleep(seconds)
            last, after = status[-1], waits(nodes)
    finally:
        peer.close()
    wall = last[0] - first[0]
    if wall < 0.5 * seconds:
        raise RuntimeError(f"the world stood still after {wall:.1f} s of {seconds:.0f}")
    world_s = simulated(last[1]) - simulated(first[1])
    return {"composed": composed, "wall_s": wall, "factor": world_s / wall, "wakeups_per_step": (after - before) / (world_s / STEP_S)}


def run(options) -> int:
    rclpy.init()
    try:
        rows = [measure(composed, options.seconds) for composed in (True, False)]
    except (RuntimeError, AssertionError) as error:
        print(f"rosflight: {error}", file=sys.stderr)
        return 1
    finally:
        rclpy.try_shutdown()
    (options.out / "factor.json").write_text(json.dumps(rows, indent=2) + "\n")
    if options.json:
        print(json.dumps(rows, indent=2))
    else:
        for row in rows:
            name = "one process" if row["composed"] else "a process for each node"
            print(f"{name}: {row['factor']:.2f} simulated seconds a second, {row['wakeups_per_step']:.1f} wake-ups for each step of the world")
    return 0
