# SPDX-License-Identifier: BSD-3-Clause
"""Usage: ./rosflight ros demo rtt [--rate HZ] [--count N] [--out DIR] [--json]
                               [--link udp|pty|cable ...]
       ./rosflight ros demo passthrough [--seconds S] [--out DIR] [--json]
       ./rosflight ros demo load [--seconds S] [--out DIR] [--json]
       ./rosflight ros demo factor [--seconds S] [--out DIR] [--json]

rtt: round trip of an offboard command to the firmware and back, through ROS and on the bare companion link; over a pty
and over UDP (neither has a baud rate) and over a modelled cable of 921600 baud; with all streams running, and with
parameters being read or set as well; and how many a second there can be; beside them the same messages from node to node
on bare DDS, to compare machines by the ratio. Leaves a table, a histogram and the round trips as CSV. The default count
takes about an hour.

passthrough: attitude loops in a ROS node close over the link at 400 Hz, in pass-through mode through a custom mixer of
./rosflight mixer, and follow a triangle wave of roll. Leaves a plot with lag and error.

load: offboard commands at 100 Hz while every stream is received: what is lost on the link and in ROS, and whether the
node's memory grows.

factor: how many times as fast as the wall simulator and roscopter run in simulated time, composed and with a process for each
node.

A row whose rate was not held is marked and the exit code is 1: its figures are those of another rate.

The paper (on its hardware): 0.416 ms mean, 2.334 ms largest at 400 Hz, 1360 Hz. --json prints the table as JSON.
"""

import argparse
import sys
from pathlib import Path

import ros_demo_factor
import ros_demo_load
import ros_demo_passthrough
import ros_demo_rtt
import ros_rig


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
    rtt.add_argument("--link", action="append", choices=ros_rig.Link.KINDS)
    passthrough = demos.add_parser("passthrough")
    passthrough.add_argument("--seconds", type=positive, default=20.0)
    load = demos.add_parser("load")
    load.add_argument("--seconds", type=positive, default=600.0)
    factor = demos.add_parser("factor")
    factor.add_argument("--seconds", type=positive, default=20.0)
    for demo in (rtt, passthrough, load, factor):
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
    demos = {"rtt": ros_demo_rtt, "passthrough": ros_demo_passthrough, "load": ros_demo_load, "factor": ros_demo_factor}
    return demos[options.demo].run(options)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
