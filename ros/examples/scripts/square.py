#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Arms, lets go of the pilot's override, takes off, flies a square, lands and disarms.

Angles (roll, pitch), a yaw rate and a throttle go out on `command`; the position comes from the simulator's
`sim/truth_state`: north, east, down [m], attitude body -> NED, velocity in body axes (forward, right, down).
src/square.cpp does the same in C++.
"""

import math
import sys

import rclpy
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.time import Time
from rosflight_msgs.msg import Command, SimState, Status
from std_srvs.srv import Trigger

GRAVITY_M_S2 = 9.81
PERIOD_S = 0.01
TIMEOUT_S = 60.0  # of node time, for each step of the flight
PILOT_HOLDS = Status.OVERRIDE_ATT_SWITCH | Status.OVERRIDE_THR_SWITCH


def rotated(q, v):
    """v rotated by the attitude: body -> NED."""
    tx, ty, tz = (2 * (q.y * v.z - q.z * v.y), 2 * (q.z * v.x - q.x * v.z), 2 * (q.x * v.y - q.y * v.x))
    return (v.x + q.w * tx + q.y * tz - q.z * ty, v.y + q.w * ty + q.z * tx - q.x * tz,
            v.z + q.w * tz + q.x * ty - q.y * tx)


def clipped(x, most):
    return max(-most, min(most, x))


class Done(Exception):
    """The flight is over; the argument is the exit code."""


class Square(Node):
    def __init__(self):
        super().__init__("square")
        side = self.number("side_m", 3.0)
        height = self.number("height_m", 2.0)
        self.corners = [(0, 0, -height), (side, 0, -height), (side, side, -height), (0, side, -height),
                        (0, 0, -height)]
        self.corner = 0
        self.sinking_to = 0.0
        self.hover = 0.5  # throttle that carries the vehicle, learnt on the way
        self.state = self.status = None
        self.command = self.create_publisher(Command, "command", 1)
        self.create_subscription(SimState, "sim/truth_state", self.on_state, 1)
        self.create_subscription(Status, "status", self.on_status, 1)
        self.arm = self.create_client(Trigger, "toggle_arm")
        self.override = self.create_client(Trigger, "toggle_override")
        self.asked, self.answered = False, self.get_clock().now()  # asked: and not answered yet
        self.since = None
        self.begin(self.wait, "waiting for the simulator and for an autopilot without errors")
        self.create_timer(PERIOD_S, self.step)

    def on_state(self, message):
        self.state = message

    def on_status(self, message):
        self.status = message

    def number(self, name, value):
        """A parameter; `side_m:=5` is an integer for ROS, and good for a number all the same."""
        given = self.declare_parameter(name, value, ParameterDescriptor(dynamic_typing=True)).value
        if type(given) not in (int, float):
            raise ValueError(f"parameter {name}: found {given!r}, allowed a number")
        return float(given)

    def begin(self, phase, text):
        self.phase, self.since = phase, None  # its time begins with its first step: simulated time may come later
        self.get_logger().info(text)

    def seconds_since(self, time):
        return (self.get_clock().now() - time).nanoseconds * 1e-9

    def step(self):
        if self.since is None:
            self.since = self.get_clock().now()
        if self.seconds_since(self.since) > TIMEOUT_S:
            self.end(1, "gave up: nothing moves on")
        if self.state is None or self.status is None:
            return
        if self.phase in (self.fly, self.land) and not self.status.armed:
            self.end(1, "disarmed in flight")
        self.phase()

    def end(self, code, text):
        self.get_logger().info(text)
        raise Done(code)

    # ---- the flight -----------------------------------------------------------------------------

    def wait(self):
        if self.status.error_code == 0 and not self.status.armed:
            self.begin(self.arming, "arming")

    def arming(self):
        if self.toggled(self.arm, self.status.armed, True):
            self.begin(self.releasing, "releasing the override")

    def releasing(self):
        self.publish(0.0, 0.0, 0.0, 0.0)  # the computer's setpoints must flow before they are let through
        if self.toggled(self.override, self.pilot_holds(), False):
            self.begin(self.fly, "taking off")

    def fly(self):
        place = self.corners[self.corner]
        self.fly_to(place)
        p = self.state.pose.position
        if math.dist(place, (p.x, p.y, p.z)) > 0.25:
            return
        self.corner += 1
        if self.corner < len(self.corners):
            self.begin(self.fly, f"corner {self.corner} of 4")
        else:
            self.sinking_to = place[2]
            self.begin(self.land, "landing")

    def land(self):
        self.sinking_to += 0.5 * PERIOD_S  # down, slowly, into the ground
        self.fly_to((*self.corners[-1][:2], self.sinking_to))
        if self.sinking_to - self.state.pose.position.z > 0.7:
            self.begin(self.giving_back, "landed, giving back")

    def giving_back(self):
        self.publish(0.0, 0.0, 0.0, 0.0)
        if self.toggled(self.override, self.pilot_holds(), True):
            self.begin(self.disarming, "disarming")

    def disarming(self):
        if self.toggled(self.arm, self.status.armed, False):
            self.end(0, "done")

    # ---- parts ----------------------------------------------------------------------------------

    def pilot_holds(self):
        return bool(self.status.rc_override & PILOT_HOLDS)

    def toggled(self, client, is_on, wanted):
        """The service flips a switch of the pilot, so it is asked again only if it has answered and the autopilot has not followed a
        second later, by the time of its own status."""
        if is_on == wanted:
            return True
        status_at = Time.from_msg(self.status.header.stamp, self.answered.clock_type)
        if not self.asked and client.service_is_ready() and (status_at - self.answered).nanoseconds > 1e9:
            self.asked = True
            client.call_async(Trigger.Request()).add_done_callback(self.on_answer)
        return False

    def on_answer(self, _):
        self.asked, self.answered = False, self.get_clock().now()

    def fly_to(self, place):
        """Position error -> velocity -> acceleration -> angles and throttle."""
        q, p = self.state.pose.orientation, self.state.pose.position
        v = rotated(q, self.state.twist.linear)
        north = 2.0 * (clipped(0.9 * (place[0] - p.x), 2.0) - v[0])
        east = 2.0 * (clipped(0.9 * (place[1] - p.y), 2.0) - v[1])
        down = 2.5 * (clipped(1.0 * (place[2] - p.z), 1.0) - v[2])
        self.hover = max(0.1, min(0.9, self.hover - 0.04 * down * PERIOD_S))
        yaw = math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))
        forward = north * math.cos(yaw) + east * math.sin(yaw)
        right = east * math.cos(yaw) - north * math.sin(yaw)
        self.publish(clipped(right / GRAVITY_M_S2, 0.35), clipped(-forward / GRAVITY_M_S2, 0.35), clipped(-yaw, 0.5),
                     max(0.05, min(0.95, self.hover * (1 - down / GRAVITY_M_S2))))

    def publish(self, roll_rad, pitch_rad, yaw_rate_rad_s, throttle):
        command = Command(mode=Command.MODE_ROLL_PITCH_YAWRATE_THROTTLE)
        command.header.stamp = self.get_clock().now().to_msg()
        command.u[2], command.u[3], command.u[4], command.u[5] = throttle, roll_rad, pitch_rad, yaw_rate_rad_s
        self.command.publish(command)


def main():
    rclpy.init()
    try:
        rclpy.spin(Square())
    except Done as done:
        return done.args[0]
    except ValueError as why:
        print(f"square.py: {why}", file=sys.stderr)
        return 2
    except (KeyboardInterrupt, ExternalShutdownException):
        return 1
    finally:
        rclpy.try_shutdown()
    return 1


if __name__ == "__main__":
    sys.exit(main())
