# SPDX-License-Identifier: BSD-3-Clause
"""Usage: ./rosflight ros demo rtt [--rate HZ] [--count N] [--out DIR] [--json]
       ./rosflight ros demo passthrough [--seconds S] [--out DIR] [--json]

rtt: round trip of an offboard command to the firmware and back, through ROS and on the bare companion link, over a pty
and over UDP (neither has a baud rate), idle and with parameters and all streams running; and how many a second there
can be. Leaves a table, a histogram and the round trips as CSV.

passthrough: attitude loops in a ROS node close over the link at 400 Hz, in pass-through mode through a custom mixer of
./rosflight mixer, and follow a triangle wave of roll. Leaves a plot with lag and error.

The paper (on its hardware): 0.416 ms mean, 2.334 ms largest at 400 Hz, 1360 Hz. --json prints the table as JSON.
"""

import argparse
import sys
from pathlib import Path

import ros_demo_passthrough
import ros_demo_rtt


class Parser(argparse.ArgumentParser):
    def error(self, message):
        print(f"rosflight: ros demo: {message}", file=sys.stderr)
        sys.exit(2)


def positive(text: str) -> float:
    value = float(text)
    if not 0.0 < value < 1e7:
        raise argparse.ArgumentTypeError(f"found {text}, allowed a number above 0")
    return value


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = Parser(prog="./rosflight ros demo")
    demos = parser.add_subparsers(dest="demo", required=True, parser_class=Parser)
    rtt = demos.add_parser("rtt")
    rtt.add_argument("--rate", type=positive, default=400.0)
    rtt.add_argument("--count", type=lambda text: int(positive(text)), default=100_000)
    passthrough = demos.add_parser("passthrough")
    passthrough.add_argument("--seconds", type=positive, default=20.0)
    for demo in (rtt, passthrough):
        demo.add_argument("--out", type=Path, default=Path("demo"))
        demo.add_argument("--json", action="store_true")
    return parser.parse_args(arguments)


def main(arguments: list[str]) -> int:
    if not arguments or {"-h", "--help"} & set(arguments):
        print(__doc__)
        return 0 if arguments else 2
    options = parse(arguments)
    try:
        options.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        print(f"rosflight: --out: {error}", file=sys.stderr)
        return 2
    run = ros_demo_rtt.run if options.demo == "rtt" else ros_demo_passthrough.run
    return run(options)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
