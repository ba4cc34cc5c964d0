# SPDX-License-Identifier: BSD-3-Clause
"""The round-trip demonstration; ros_demo.py documents its use."""

import csv
import json
import math
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib
import rclpy

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402
from ros_demo_rate import exit_code, held  # noqa: E402
from ros_rig import SIL_TOOLS, Link, Rig, program, stop  # noqa: E402
from rosflight_msgs.srv import ParamSet  # noqa: E402

PEER = program("rosflight_demos", "rtt_peer")
ECHO = program("rosflight_demos", "rtt_echo")
SHARES = {"median": 0.5, "99 %": 0.99, "99.9 %": 0.999}
COLUMNS = ["path", "link", "load", "rate_hz", "sent", "lost", "min", "mean", "std", *SHARES, "max"]


def figures(file: Path) -> dict[str, float]:
    """Figures of the round trips in a CSV file, in ms."""
    with file.open() as lines:
        ms = sorted(float(row["round_trip_us"]) / 1000.0 for row in csv.DictReader(lines))
    if not ms:
        return {}
    found = {"min": ms[0], "mean": statistics.fmean(ms), "std": statistics.pstdev(ms), "max": ms[-1]}
    return found | {name: ms[int(share * (len(ms) - 1))] for name, share in SHARES.items()}


def run_program(command: list) -> dict:
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError((done.stderr.strip().splitlines() or [f"{command[0]} failed"])[-1])
    return json.loads(done.stdout.strip().splitlines()[-1])


def bare(kind: str, loaded: bool, rate: float, count: int, file: Path) -> dict:
    """On the companion link without ROS. Rate 0: as fast as they come back."""
    with tempfile.TemporaryDirectory() as scratch:
        link = Link(kind, Path(scratch), program=SIL_TOOLS / "sil_echo")
        try:
            pace = ["--rate", rate] if rate > 0 else ["--window", 1]
            return run_program([SIL_TOOLS / "sil_link_rtt", link.address, "--count", count, *pace, "--csv", file,
                                *(["--parameters"] if loaded else [])])
        finally:
            link.stop()


def through_ros(kind: str, loaded: bool, rate: float, count: int, file: Path) -> dict:
    """Publisher, rosflight_io, link, firmware and back. Load: parameters are set over and over."""
    with tempfile.TemporaryDirectory() as scratch:
        rig = Rig(Path(scratch), kind=kind, program=SIL_TOOLS / "sil_echo")
        try:
            command = [str(PEER), str(rate), str(count), str(file)]
            peer = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            value = 0.0
            while loaded and peer.poll() is None:
                value = 0.1 if value != 0.1 else 0.2
                rig.peer.call(ParamSet, "param_set", name="PID_ROLL_RATE_P", value=value)
            out, err = peer.communicate()
            if peer.returncode != 0:
                raise RuntimeError(err.strip())
            return json.loads(out.strip().splitlines()[-1])
        finally:
            rig.close()


def over_dds(_kind: str, _loaded: bool, rate: float, count: int, file: Path) -> dict:
    """From node to node and back: no rosflight_io, link and firmware."""
    with subprocess.Popen([str(ECHO)], stderr=subprocess.DEVNULL) as echo:
        try:
            return run_program([PEER, rate, count, file])
        finally:
            stop(echo)


def measure(options) -> list[dict]:
    rows = []
    links = options.link or Link.KINDS
    for path, measure_one, kinds in (("bare link", bare, links), ("bare DDS", over_dds, ["none"]), ("ROS", through_ros, links)):
        for kind in kinds:
            loads = [("idle", options.rate), ("idle", 0.0)]
            if measure_one is not over_dds:
                loads.insert(1, ("parameters", options.rate))
            for load, rate in loads:
                name = f"{path} {kind} {load} {'fastest' if rate == 0 else f'{rate:g} Hz'}"
                print(f"rosflight: measuring {name}", file=sys.stderr)
                file = options.out / (name.replace(" ", "_") + ".csv")
                count = options.count if rate > 0 else max(options.count // 2, 1000)
                told = measure_one(kind, load != "idle", rate, count, file)
                rows.append({"path": path, "link": kind, "load": load, "rate_hz": told["achieved_Hz"], "wanted_hz": rate or None,
                             "held": held(told["achieved_Hz"], rate), "sent": told["sent"], "lost": told["lost"],
                             **figures(file), "csv": file.name})
    return rows


def print_table(title: str, rows: list[dict]):
    print(f"{title}, round trips in ms\n")
    print("".join(f"{column:>11}" for column in COLUMNS))
    for row in rows:
        cells = [row.get(column, "-") for column in COLUMNS]
        print("".join(f"{cell:>11.3f}" if isinstance(cell, float) and column not in ("rate_hz",) else
                      f"{cell:>11.0f}" if isinstance(cell, float) else f"{cell:>11}"
                      for column, cell in zip(COLUMNS, cells)) + ("" if row["held"] else "  rate not held"))
    print()


def draw(rows: list[dict], folder: Path, file: Path):
    figure, axes = pyplot.subplots(figsize=(12, 5), layout="constrained")
    lowest = math.log10(min(row["min"] for row in rows))
    count = math.ceil(40 * (math.log10(max(row["max"] for row in rows)) - lowest)) + 1
    bins = [10 ** (lowest + k / 40) for k in range(count + 1)]  # the same width on a log scale
    colours: dict[tuple, str] = {}
    for row in rows:
        colour = colours.setdefault((row["path"], row["link"]), f"C{len(colours)}")
        with (folder / row["csv"]).open() as lines:
            ms = [float(line["round_trip_us"]) / 1000.0 for line in csv.DictReader(lines)]
        axes.hist(ms, bins=bins, histtype="step", color=colour, linestyle="-" if row["load"] == "idle" else ":",
                  label=f"{row['path']}, {row['link']}, {row['load']}: {row['mean']:.3f} ms")
    axes.set(title=f"Round trip of an offboard command at {rows[0]['wanted_hz']:g} Hz", xlabel="round trip [ms]",
             ylabel="commands", xscale="log", yscale="log")
    axes.legend(title="path, link, load: mean", loc="center left", bbox_to_anchor=(1.0, 0.5))
    axes.grid(alpha=0.3)
    figure.savefig(file, dpi=120)
    pyplot.close(figure)


def run(options) -> int:
    rclpy.init()
    try:
        rows = measure(options)
    except (RuntimeError, AssertionError) as error:
        print(f"rosflight: {error}", file=sys.stderr)
        return 1
    finally:
        rclpy.try_shutdown()
    steady = [row for row in rows if row["wanted_hz"]]
    draw([row for row in steady if "min" in row], options.out, options.out / "rtt.png")
    (options.out / "rtt.json").write_text(json.dumps(rows, indent=2) + "\n")
    if options.json:
        print(json.dumps(rows, indent=2))
    else:
        print_table(f"At {options.rate:g} Hz", steady)
        print_table("As fast as they come back, one at a time", [row for row in rows if not row["wanted_hz"]])
        print(f"histogram, CSV and JSON are in {options.out}")
    return exit_code([(f"{row['path']} {row['link']} {row['load']}", row["rate_hz"], row["wanted_hz"]) for row in steady])
