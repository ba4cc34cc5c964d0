#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Between a controller and the I/O node: commands are changed on their way, as faults and attacks do.

Reads `command_in`, writes `command`, one for one and under the same stamp. Parameters, all of which can be set in flight; nothing set,
commands pass as they are:

    bias          ten numbers, added to u
    delay_s       what goes out is so old
    replay_s      > 0: the commands of the last replay_s before it was set go out again and again, the present ones do not
    dead_motor    output of the mixer that is held at 0; -1: none. Pass-through commands only: the others name no motor

The dead motor is worked out backwards from the mixer M of the firmware (PRI_MIXER_i_j, asked for when the vehicle is armed: before
that its parameters may be loaded, and some entries would be old ones):

    y = M u,  y[dead] = 0,  u = pinv(M) y                              (1)

    ./rosflight ros launch rosflight_examples policy.launch.xml filter:=true
    ./rosflight ros run ros2 param set /command_filter dead_motor 0          # with a ROS installation
"""

import math
import os
import sys
from bisect import bisect_right
from collections import deque

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # the matrices are small: more threads only wait for each other, busily
import numpy
import rclpy
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rosflight_msgs.msg import Command, Status
from rosflight_msgs.srv import ParamGet

ROWS, MOTORS = range(2, 6), range(4)  # inputs down force and torques; outputs of a quadrotor
ENTRIES = [f"PRI_MIXER_{row}_{motor}" for row in ROWS for motor in MOTORS]
KEPT_S = 10
ASK_EVERY_S = 0.005
DEPTH = 5  # one for one, also when some come at once
DEFAULTS = {"bias": [0.0] * 10, "delay_s": 0.0, "replay_s": 0.0, "dead_motor": -1}


def nanoseconds(seconds):
    return round(seconds * 1e9)


def time_of(message):
    """Its stamp in nanoseconds: seconds as floating-point numbers would take one command in six for an older one."""
    return message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec


class CommandFilter(Node):
    def __init__(self):
        super().__init__("command_filter")
        self.past = deque()  # (time in ns, command as it came)
        self.mixer = None
        self.answers = []  # entries of the mixer, row by row, while they are asked for
        self.asked = None
        self.armed = False
        self.replayed = None  # commands of the replay, and when it began
        self.values = {}
        for name, default in DEFAULTS.items():
            self.values[name] = self.declare_parameter(name, default, ParameterDescriptor(dynamic_typing=name.endswith("_s"))).value
        if why := self.fault(self.values):
            raise ValueError(why)
        self.add_on_set_parameters_callback(self.on_change)
        self.commands = self.create_publisher(Command, "command", DEPTH)
        self.create_subscription(Command, "command_in", self.on_command, DEPTH)
        self.create_subscription(Status, "status", self.on_status, 1)
        self.param_get = self.create_client(ParamGet, "param_get")
        self.timer = self.create_timer(ASK_EVERY_S, self.ask)
        self.timer.cancel()
        self.get_logger().info("ready")

    @staticmethod
    def fault(values):
        """What is wrong with them, in one line; empty if nothing is."""
        if len(values["bias"]) != 10 or not all(map(math.isfinite, values["bias"])):
            return f"parameter bias: found {list(values['bias'])}, allowed ten finite numbers"
        for name in ("delay_s", "replay_s"):
            if type(values[name]) not in (int, float) or not 0 <= values[name] <= KEPT_S:
                return f"parameter {name}: found {values[name]}, allowed 0 to {KEPT_S:g} s"
        if values["dead_motor"] not in (-1, *MOTORS):
            return f"parameter dead_motor: found {values['dead_motor']}, allowed -1 to {MOTORS[-1]}"
        return ""

    def on_change(self, parameters):
        wanted = self.values | {parameter.name: parameter.value for parameter in parameters if parameter.name in DEFAULTS}
        why = self.fault(wanted)
        if not why and wanted["dead_motor"] >= 0 and self.mixer is None:
            why = "parameter dead_motor: the mixer of the flight controller is not known yet"
        if not why:
            if wanted["replay_s"] != self.values["replay_s"]:
                self.replayed = None
            self.values = wanted
            self.get_logger().info(", ".join(f"{name} {value}" for name, value in wanted.items() if value != DEFAULTS[name]) or "passes on")
        return SetParametersResult(successful=not why, reason=why)

    def on_status(self, message):
        if message.armed and not self.armed:
            self.mixer, self.answers, self.asked = None, [], None
            self.timer.reset()
        self.armed = message.armed

    def ask(self):
        """For the entries of the mixer, one after the other."""
        if self.asked is not None and self.asked.done():
            self.answers += [self.asked.result().value] if self.asked.result().exists else []
            self.asked = None
        if len(self.answers) == len(ENTRIES):
            self.mixer = numpy.array(self.answers).reshape(len(ROWS), len(MOTORS))
            self.timer.cancel()
            self.get_logger().info("the mixer is known")
        elif self.asked is None and self.param_get.service_is_ready():
            self.asked = self.param_get.call_async(ParamGet.Request(name=ENTRIES[len(self.answers)]))

    # ---- the commands ---------------------------------------------------------------------------

    def on_command(self, message):
        now = time_of(message)
        if self.past and now < self.past[-1][0]:
            self.past.clear()  # time was set back
        self.past.append((now, message))
        while self.past[0][0] < now - nanoseconds(KEPT_S + self.values["delay_s"]):
            self.past.popleft()
        source = self.replay(now) if self.values["replay_s"] > 0 else self.delayed(now)
        out = Command(mode=source.mode, ignore=source.ignore)
        out.header.stamp = message.header.stamp  # when it is sent
        u = numpy.array(source.u, dtype=float) + self.values["bias"]
        if self.values["dead_motor"] >= 0 and self.mixer is not None and out.mode == Command.MODE_PASS_THROUGH:
            u[ROWS[0]:ROWS[-1] + 1] = self.without_motor(u[ROWS[0]:ROWS[-1] + 1])
        out.u = u.astype(numpy.float32)
        self.commands.publish(out)

    def delayed(self, now):
        """The newest of those that are at least delay_s old; the oldest, if none is."""
        latest = now - nanoseconds(self.values["delay_s"])
        return next((command for time, command in reversed(self.past) if time <= latest), self.past[0][1])

    def replay(self, now):
        length = nanoseconds(self.values["replay_s"])
        if self.replayed is None:
            recorded = [entry for entry in self.past if entry[0] >= now - length]
            self.replayed = now, *map(list, zip(*recorded))
        begun, times, commands = self.replayed
        at = times[0] + (now - begun) % length
        return commands[bisect_right(times, at) - 1]

    def without_motor(self, u):
        y = self.mixer.T @ u
        y[self.values["dead_motor"]] = 0.0
        return numpy.linalg.pinv(self.mixer.T) @ y


def main():
    rclpy.init()
    try:
        rclpy.spin(CommandFilter())
    except (KeyboardInterrupt, ExternalShutdownException):
        return 0
    except ValueError as why:
        print(f"command_filter.py: {why}", file=sys.stderr)
        return 2
    finally:
        rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
