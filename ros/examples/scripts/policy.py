#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A network flies the vehicle: pass-through commands at the rate of the state, 400 Hz.

Inputs from the simulator's `sim/truth_state`, outputs straight to the mixer; the flight controller closes no loop. The weights are
those that train_policy.py made when the package was built, or a file of your own (parameter `weights`). The vehicle is
vehicles/multirotor.yaml, whose mixer takes throttle and torques without units. It flies to `positions`, one after the other.

    ./rosflight ros launch rosflight_examples policy.launch.xml
"""

import math
import os
import sys
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # the matrices are small: more threads only wait for each other, busily
import numpy
import rclpy
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rosflight_msgs.msg import Command, SimState, Status

WEIGHTS = Path(__file__).resolve().parents[2] / "share/rosflight_examples/policy_weights.npz"
MAX_STEP_S = 0.05
DEPTH = 5  # a state that is some steps late is still answered, so every one is, as long as simulated time waits for `command`


class Network:
    """u = B tanh(A x + a) + b, inputs and outputs scaled: train_policy.py (1)."""

    def __init__(self, file):
        with numpy.load(file) as made:
            self.first = made["A"] / made["input_scale"]
            self.second = made["B"] * made["output_scale"][:, None]
            self.offset, self.result = made["a"], made["b"] * made["output_scale"]
            self.reach = made["input_scale"]

    def __call__(self, x):
        x = numpy.clip(x, -self.reach, self.reach)  # farther away it has seen nothing
        return self.second @ numpy.tanh(self.first @ x + self.offset) + self.result


class Policy(Node):
    def __init__(self):
        super().__init__("policy")
        self.network = Network(self.declare_parameter("weights", str(WEIGHTS)).value)
        flat = self.declare_parameter("positions", [0.0, 0.0, -2.0, 2.0, 0.0, -2.0, 2.0, 2.0, -2.5, 0.0, 0.0, -2.0],
                                      ParameterDescriptor(description="positions north, east, down [m] to fly to, one after the other")).value
        if not flat or len(flat) % 3:
            raise ValueError(f"parameter positions: found {len(flat)} numbers, allowed three for each position")
        self.positions = [flat[k:k + 3] for k in range(0, len(flat), 3)]
        self.stay_s = float(self.declare_parameter("stay_s", 4.0, ParameterDescriptor(dynamic_typing=True)).value)
        self.flies = False
        self.flown_s = self.sum_down = self.last = 0.0
        self.commands = self.create_publisher(Command, "command", DEPTH)
        self.create_subscription(Status, "status", self.on_status, 1)
        self.create_subscription(SimState, "sim/truth_state", self.on_state, DEPTH)
        self.get_logger().info("ready")

    def on_status(self, message):
        self.flies = message.armed and not message.rc_override & (Status.OVERRIDE_ATT_SWITCH | Status.OVERRIDE_THR_SWITCH)

    def on_state(self, message):
        now = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec
        dt = max(0.0, min(MAX_STEP_S, now - self.last))
        self.last = now
        command = Command(mode=Command.MODE_PASS_THROUGH)
        command.header.stamp = message.header.stamp
        if self.flies:
            throttle, roll, pitch, yaw = map(float, self.network(self.inputs(message, dt)))
            command.u[2] = -max(0.0, min(0.9, throttle))  # down is positive
            command.u[3], command.u[4], command.u[5] = roll, pitch, yaw
        else:
            self.flown_s = self.sum_down = 0.0
        self.commands.publish(command)

    def position(self, dt):
        self.flown_s += dt
        return self.positions[min(int(self.flown_s / self.stay_s), len(self.positions) - 1)]

    def inputs(self, message, dt):
        """The inputs of train_policy.py: errors and velocity in the heading frame."""
        q, p, v, w = message.pose.orientation, message.pose.position, message.twist.linear, message.twist.angular
        roll = math.atan2(2 * (q.w * q.x + q.y * q.z), 1 - 2 * (q.x * q.x + q.y * q.y))
        pitch = math.asin(max(-1.0, min(1.0, 2 * (q.w * q.y - q.z * q.x))))
        yaw = math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))
        north, east, down = (to - at for to, at in zip(self.position(dt), (p.x, p.y, p.z)))
        self.sum_down = max(-1.0, min(1.0, self.sum_down + max(-0.5, min(0.5, down)) * dt))
        c, s = math.cos(yaw), math.sin(yaw)
        # Velocity from body axes to those of the heading: pitch, then roll, taken back.
        aside = math.cos(roll) * v.y - math.sin(roll) * v.z
        below = math.sin(roll) * v.y + math.cos(roll) * v.z
        ahead, sinks = math.cos(pitch) * v.x + math.sin(pitch) * below, -math.sin(pitch) * v.x + math.cos(pitch) * below
        return numpy.array([c * north + s * east, c * east - s * north, down, ahead, aside, sinks,
                            roll, pitch, -yaw, w.x, w.y, w.z, self.sum_down])


def main():
    rclpy.init()
    try:
        rclpy.spin(Policy())
    except (KeyboardInterrupt, ExternalShutdownException):
        return 0
    except (ValueError, OSError) as why:
        print(f"policy.py: {why}", file=sys.stderr)
        return 2
    finally:
        rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
