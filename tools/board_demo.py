# SPDX-License-Identifier: BSD-3-Clause
"""./rosflight bench --boards, and bench rtt --board: the paper's measurements on the emulated boards; bench.py documents their use."""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import bench_programs
import h7_figures
import project

LINKS = {"USB": "usb", "UART 921600": "921600", "UART 3000000": "3000000"}
RESULTS = "boards.json"
ENVIRONMENT = ".venv-plot"
ROUND_TRIP = [("mean", "mean_ms"), ("median", "median_ms"), ("99.9 %", "p999_ms"), ("max", "max_ms"),
              ("fastest Hz", "fastest_hz"), ("idle", "idle_fraction")]
ROLL = [("rms deg", "roll_rms_deg"), ("max deg", "roll_max_deg"), ("lag ms", "lag_ms"),
        ("estimate deg", "roll_estimated_rms_deg"), ("Hz", "commands_hz")]


class Parser(argparse.ArgumentParser):
    """Its name is the command as it is typed, less ./rosflight; errors are one line."""

    def error(self, message):
        print(f"rosflight: {self.prog}: {message}", file=sys.stderr)
        sys.exit(2)


def between(low: int, high: int):
    def checked(text: str) -> int:
        if not text.isdecimal() or not low <= int(text) <= high:
            raise argparse.ArgumentTypeError(f"found {text}, allowed {low} to {high}")
        return int(text)
    return checked


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = Parser(prog="bench --boards", add_help=False)
    parser.add_argument("folder", type=Path, metavar="DIR")
    parser.add_argument("--board", action="append", choices=h7_figures.BOARDS)
    parser.add_argument("--count", type=between(100, 1_000_000), default=18_000)
    parser.add_argument("--seconds", type=between(1, 300), default=20)
    return parser.parse_args(arguments)


def parse_rtt(arguments: list[str]) -> argparse.Namespace:
    parser = Parser(prog="bench rtt", add_help=False)
    parser.add_argument("--board", action="append", choices=h7_figures.BOARDS, required=True)
    parser.add_argument("--count", type=between(100, 1_000_000), default=18_000)
    return parser.parse_args(arguments)


def build(boards: list[str], programs=("bench/board_rtt", "bench/board_passthrough"), kinds=("", "_echo")):
    images = [f"firmware_{board}{kind}.elf" for board in boards for kind in kinds]
    for preset, targets in (("release", [*programs, "h7_emulator"]), ("cortex-m7", images)):
        if not project.build(preset, *targets):
            raise RuntimeError(f"{', '.join(targets)} do not build, see build/{preset}/build.log")


def measure_trips(board: str, count: int, folder: Path) -> list[dict]:
    """A row for each link; each round trip is in a CSV file of the folder."""
    rows = []
    for name, link in LINKS.items():
        print(f"rosflight: {board}: round trips over {name}", file=sys.stderr)
        csv = f"rtt_{board}_{link}.csv"
        found = h7_figures.measure_round_trips(board, link, "--count", str(count), "--csv", str(folder / csv))
        rows.append({**found, "name": name, "csv": csv})
    return rows


def measure(options: argparse.Namespace) -> dict[str, list[dict]]:
    """Rows of both tables; what was measured one by one is in CSV files of the folder."""
    trips, rolls = [], []
    for board in options.board:
        for attitude in ("companion", "firmware"):
            print(f"rosflight: {board}: roll triangle, attitude corrected by the {attitude}", file=sys.stderr)
            csv = f"passthrough_{board}_{attitude}.csv"
            words = ["--seconds", str(options.seconds), "--csv", str(options.folder / csv)]
            if attitude == "firmware":
                words += ["--attitude", "firmware"]
            rolls.append({**h7_figures.bench_program("board_passthrough", board, *words), "attitude": attitude, "csv": csv})
        trips += measure_trips(board, options.count, options.folder)
    return {"round_trips": trips, "roll": rolls}


def table(rows: list[dict], columns: list[tuple[str, str]], names: tuple[str, str]) -> str:
    """Board, one more name, and numbers."""
    lines = ["board".ljust(16) + names[1].ljust(14) + "".join(f"{title:>13}" for title, _ in columns)]
    for row in rows:
        cells = [f"{row[key]:>13.0f}" if abs(row[key]) >= 100 else f"{row[key]:>13.3f}" for _, key in columns]
        lines.append(row["board"].ljust(16) + row[names[0]].ljust(14) + "".join(cells))
    return "\n".join(lines)


def print_trips(rows: list[dict]):
    print("Round trips of offboard commands at 400 Hz [ms], how many a second as fast as they are answered, and the share of time slept\n")
    print(table(rows, ROUND_TRIP, ("name", "link")))


def round_trips_main(arguments: list[str]) -> int:
    """./rosflight bench rtt --board BOARD: the table alone."""
    options = parse_rtt(arguments)
    boards = list(dict.fromkeys(options.board))
    try:
        build(boards, ["bench/board_rtt"], ["_echo"])
        with tempfile.TemporaryDirectory() as scratch:
            rows = [row for board in boards for row in measure_trips(board, options.count, Path(scratch))]
    except (RuntimeError, OSError, subprocess.SubprocessError) as error:
        print(f"rosflight: bench rtt: {error}", file=sys.stderr)
        return 1
    print_trips(rows)
    return 0


def draw(folder: Path):
    """By matplotlib, in an environment of its own."""
    bench_programs.environment(ENVIRONMENT, "tools/requirements-plot.txt")
    python = project.ROOT / ENVIRONMENT / "bin/python3"
    subprocess.run([str(python), str(project.ROOT / "tools/board_plots.py"), str(folder)], check=True)


def main(arguments: list[str]) -> int:
    options = parse(arguments)
    try:
        options.folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        print(f"rosflight: bench --boards: {options.folder}: {error.strerror}", file=sys.stderr)
        return 2
    options.folder = options.folder.absolute()
    options.board = options.board or list(h7_figures.BOARDS)
    try:
        build(options.board)
        measured = measure(options)
        (options.folder / RESULTS).write_text(json.dumps(measured, indent=2) + "\n")
        draw(options.folder)
    except (RuntimeError, OSError, subprocess.SubprocessError) as error:
        print(f"rosflight: bench --boards: {error}", file=sys.stderr)
        return 1
    print_trips(measured["round_trips"])
    print("\nTriangle wave of roll in pass-through: error of the true roll, and of the firmware's estimate\n")
    print(table(measured["roll"], ROLL, ("attitude", "attitude")))
    print(f"\npictures, CSV and {RESULTS} are in {options.folder}")
    return 0
