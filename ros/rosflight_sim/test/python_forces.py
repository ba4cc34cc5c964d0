#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A forces-and-moments node in Python: a module of the simulator that somebody else wrote.

Body axes forward, right, down; wrench without gravity and ground. Four rotors in an X, thrust as the square of the
command, a little drag: enough to fly the multirotor's firmware set."""

import math

import rclpy
from geometry_msgs.msg import Vector3Stamped, WrenchStamped
from rclpy.node import Node
from rosflight_msgs.msg import PwmOutput, SimState

FULL_THRUST_N = 30.0
TORQUE_PER_THRUST_M = 0.019
ARM_M = 0.25
AZIMUTHS_DEG = (45.0, 135.0, 225.0, 315.0)  # from the nose to the right
YAW_SIGNS = (1.0, -1.0, 1.0, -1.0)  # torque about down: 1 turns the nose right
DRAG_N_S_M = 0.4
ROTATION_DRAG_NM_S = 0.02


class PythonForces(Node):
    def __init__(self):
        super().__init__("multirotor_forces_and_moments")
        self.state = SimState()
        self.wrench = self.create_publisher(WrenchStamped, "sim/forces_and_moments", 1)
        self.create_subscription(SimState, "sim/truth_state", self.on_truth, 1)
        self.create_subscription(Vector3Stamped, "sim/truth_wind", lambda _: None, 1)
        self.create_subscription(PwmOutput, "sim/pwm_output", self.on_pulses, 1)

    def on_truth(self, message):
        self.state = message

    def on_pulses(self, pulses):
        thrusts = [FULL_THRUST_N * (max(0, min(1000, pulses.values[i] - 1000)) / 1000.0)**2 for i in range(4)]
        answer = WrenchStamped()
        answer.header.stamp = pulses.header.stamp  # the step's own
        answer.header.frame_id = "aircraft_body"
        v, w = self.state.twist.linear, self.state.twist.angular
        force, torque = answer.wrench.force, answer.wrench.torque
        force.x, force.y, force.z = -DRAG_N_S_M * v.x, -DRAG_N_S_M * v.y, -DRAG_N_S_M * v.z - sum(thrusts)
        torque.x, torque.y, torque.z = (-ROTATION_DRAG_NM_S * rate for rate in (w.x, w.y, w.z))
        for thrust, azimuth, sign in zip(thrusts, AZIMUTHS_DEG, YAW_SIGNS):
            torque.x -= thrust * ARM_M * math.sin(math.radians(azimuth))
            torque.y += thrust * ARM_M * math.cos(math.radians(azimuth))
            torque.z += sign * TORQUE_PER_THRUST_M * thrust
        self.wrench.publish(answer)


def main():
    rclpy.init()
    node = PythonForces()
    node.get_logger().info("ready")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
