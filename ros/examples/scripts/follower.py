#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A trajectory follower of your own, in place of roscopter's: a controller to start from.

Wanted acceleration from position and velocity errors and the trajectory's own acceleration; attitude and thrust that
give it; all of it as a roscopter_msgs/ControllerCommand in mode ROLL_PITCH_YAWRATE_THRUST_TO_MIXER. Once per State.

    ./rosflight ros launch rosflight_examples own_follower.launch.xml
"""

import math
import sys

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from roscopter_msgs.msg import ControllerCommand, State, TrajectoryCommand
from std_msgs.msg import String

GRAVITY_M_S2 = 9.81
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def clipped(x, most):
    return max(-most, min(most, x))


def wrapped(angle):
    return math.remainder(angle, 2 * math.pi)


def in_ned(state):
    """Velocity of a State, which has it in body axes."""
    q, x, y, z = state.quat, state.v_x, state.v_y, state.v_z
    tx, ty, tz = 2 * (q.y * z - q.z * y), 2 * (q.z * x - q.x * z), 2 * (q.x * y - q.y * x)
    return (x + q.w * tx + q.y * tz - q.z * ty, y + q.w * ty + q.z * tx - q.x * tz,
            z + q.w * tz + q.x * ty - q.y * tx)


class Follower(Node):
    def __init__(self):
        super().__init__("trajectory_follower")  # its name, too: others look for it
        self.kp = self.declare_parameter("kp", 2.5).value  # [1/s^2]
        self.kd = self.declare_parameter("kd", 2.5).value  # [1/s]
        self.ki = self.declare_parameter("ki", 0.5).value  # [1/s^3]
        self.kp_heading = self.declare_parameter("kp_heading", 1.5).value  # [1/s]
        self.mass = self.declare_parameter("mass", 3.5).value  # [kg]
        self.max_tilt = math.radians(self.declare_parameter("max_tilt_deg", 25.0).value)
        self.timeout = self.declare_parameter("trajectory_timeout_s", 0.5).value
        self.target = self.received = self.last = None
        self.sum = [0.0, 0.0, 0.0]  # of the errors over time
        self.phase = ""
        self.commands = self.create_publisher(ControllerCommand, "high_level_command", 1)
        self.create_subscription(TrajectoryCommand, "trajectory_command", self.on_trajectory, 1)
        self.create_subscription(String, "flight_phase", self.on_phase, LATCHED)
        self.create_subscription(State, "estimated_state", self.on_state, 1)
        self.get_logger().info("ready")

    def on_trajectory(self, message):
        self.target, self.received = message, self.get_clock().now()

    def on_phase(self, message):
        self.phase = message.data

    def on_state(self, state):
        if self.target is None:
            return
        now = state.header.stamp.sec + 1e-9 * state.header.stamp.nanosec
        dt = 0.0 if self.last is None else max(0.0, min(0.1, now - self.last))
        self.last = now
        age = (self.get_clock().now() - self.received).nanoseconds * 1e-9
        command = ControllerCommand(mode=ControllerCommand.MODE_ROLL_PITCH_YAWRATE_THRUST_TO_MIXER)
        command.header.stamp = state.header.stamp
        command.cmd_valid = age < self.timeout  # old setpoints: the controller holds, then lands
        command.cmd1, command.cmd2, command.cmd3, command.cmd4 = self.follow(state, dt)
        self.commands.publish(command)

    def follow(self, state, dt):
        """Roll, pitch [rad], yaw rate [rad/s], thrust [N]."""
        place, speed, to = (state.p_n, state.p_e, state.p_d), in_ned(state), self.target
        # Arrays of a message hold numpy's numbers; a field of a message takes Python's only.
        position, velocity, acceleration = (list(map(float, v)) for v in (to.position, to.velocity, to.acceleration))
        wanted = []
        for axis in range(3):
            error = clipped(position[axis] - place[axis], 2.0)
            self.sum[axis] = clipped(self.sum[axis] + error * dt, 4.0) if self.phase == "offboard" else 0.0
            wanted.append(acceleration[axis] + self.kp * error + self.kd * (velocity[axis] - speed[axis])
                          + self.ki * self.sum[axis])
        north, east, down = wanted
        lift = max(0.4 * GRAVITY_M_S2, GRAVITY_M_S2 - down)  # what carries, per mass
        forward = north * math.cos(state.psi) + east * math.sin(state.psi)
        right = east * math.cos(state.psi) - north * math.sin(state.psi)
        pitch = clipped(math.atan2(-forward, lift), self.max_tilt)
        roll = clipped(math.atan2(right, math.hypot(lift, forward)), self.max_tilt)
        yaw_rate = clipped(to.psi_dot + self.kp_heading * wrapped(to.psi - state.psi), 1.0)
        return roll, pitch, yaw_rate, self.mass * lift / (math.cos(state.phi) * math.cos(state.theta))


def main():
    rclpy.init()
    try:
        rclpy.spin(Follower())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
