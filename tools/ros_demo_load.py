# SPDX-License-Identifier: BSD-3-Clause
"""The load demonstration and test; ros_demo.py documents its use."""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from ros_demo_rate import exit_code
from ros_rig import Rig, program, wait_for

WATCH = program("rosflight_demos", "load_watch")
RATE_HZ = 100.0  # of the commands
LINK_COUNTERS = ("frames dropped", "sequence gaps", "send failures")


def memory_kB(pid: int) -> int:
    """Resident, of a process."""
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return int(next(line for line in lines if line.startswith("VmRSS:")).split()[1])


def link_counters(received: list) -> dict[str, int]:
    """Counters of the newest /diagnostics."""
    values = {entry.key: entry.value for status in received[-1][1].status for entry in status.values}
    return {name: int(values[name]) for name in LINK_COUNTERS}


def start_watch(rig: Rig, seconds: float) -> subprocess.Popen:
    """One that counts."""
    watch = subprocess.Popen([str(WATCH), str(seconds), str(rig.sil.start_us)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while (line := watch.stdout.readline()) and line != "watching\n":  # the middleware prints there, too
        pass
    return watch


def end_watch(watch: subprocess.Popen, seconds: float) -> dict:
    """What it found; `missing` is the sum over all topics."""
    out, err = watch.communicate(timeout=seconds + 120.0)
    if watch.returncode != 0:
        raise RuntimeError(err.strip())
    found, _ = json.JSONDecoder().raw_decode(out, out.find("{"))
    return found | {"missing": sum(topic.get("missing", 0) for topic in found["topics"].values())}


def measure(rig: Rig, seconds: float) -> dict:
    """What is lost on the way and how the node's memory grows while everything runs for that time."""
    diagnostics = rig.peer.listen(DiagnosticArray, "/diagnostics")
    watch = start_watch(rig, seconds)
    time.sleep(3.0)  # its subscriptions make buffers grow once
    wait_for(lambda: diagnostics, "diagnostics")
    memory, counters = memory_kB(rig.io.process.pid), link_counters(diagnostics)
    found = end_watch(watch, seconds)
    count = len(diagnostics)
    wait_for(lambda: len(diagnostics) > count, "diagnostics")
    return found | {
        "seconds": seconds,
        "memory_growth_kB": memory_kB(rig.io.process.pid) - memory,
        **{name.replace(" ", "_"): value - counters[name] for name, value in link_counters(diagnostics).items()},
    }


def print_table(told: dict):
    print(f"{told['seconds']:g} s of all streams and {told['commands']} offboard commands\n")
    print(f"{'topic':<18}{'received':>9}{'period [ms]':>13}{'missing':>9}")
    for name, topic in told["topics"].items():
        period = f"{topic['period_ms']:.3f}" if "period_ms" in topic else "-"
        print(f"{name:<18}{topic['received']:>9}{period:>13}{topic.get('missing', '-'):>9}")
    if told["pauses"]:
        print(f"\nthe simulated vehicle paused {told['pauses']} times for over 0.1 s: this machine had no time for it")
    error = told["stamp_error_ms"]
    print(f"\nstamps of the IMU against the true times of its samples: {error['mean']:+.3f} ms mean, "
          f"{error['std']:.3f} ms standard deviation, {error['max']:.3f} ms at most")
    print(f"link: {told['sequence_gaps']} gaps in sequence, {told['frames_dropped']} bad frames, "
          f"{told['send_failures']} commands not sent; memory of rosflight_io grew by {told['memory_growth_kB']} kB")


def run(options) -> int:
    rclpy.init()
    try:
        with tempfile.TemporaryDirectory() as scratch:
            rig = Rig(Path(scratch))
            try:
                told = measure(rig, options.seconds)
            finally:
                rig.close()
    except (RuntimeError, AssertionError, subprocess.SubprocessError) as error:
        print(f"rosflight: {error}", file=sys.stderr)
        return 1
    finally:
        rclpy.try_shutdown()
    (options.out / "load.json").write_text(json.dumps(told, indent=2) + "\n")
    if options.json:
        print(json.dumps(told, indent=2))
    else:
        print_table(told)
        print(f"JSON is in {options.out}")
    return exit_code([("load", told["commands"] / told["seconds"], RATE_HZ)])
