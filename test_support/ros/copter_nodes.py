# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of roscopter's nodes share: starting one by itself, and messages for it."""

import math
import time

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from roscopter_msgs.msg import State, TrajectoryCommand, Waypoint
from sim_rig import LATCHED, VEHICLE, node, stamp, stamp_ns

START_NS = 100_000_000_000
LATCHED_ALL = type(LATCHED)(depth=2000, durability=LATCHED.durability)
WITHOUT_VEHICLE = ("ext_att_transcriber", "rviz_waypoint_publisher", "sim_state_transcriber", "signal_generator")


def copter(name, **parameters):
    if name not in WITHOUT_VEHICLE:
        parameters.setdefault("vehicle_file", VEHICLE)
    if name == "controller":  # there is no flight controller
        parameters.setdefault("use_firmware_parameters", "false")
    return node(name, package="roscopter", **parameters)


def set_values(peer, name, **values):
    """The results, one for all: of doubles and switches."""
    def typed(value):
        if isinstance(value, bool):
            return ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=value)
        return ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=value)
    given = [Parameter(name=key, value=typed(value)) for key, value in values.items()]
    return peer.call(SetParameters, f"{name}/set_parameters", parameters=given).results


def state(ns, place=(0.0, 0.0, 0.0), psi=0.0):
    message = stamp(State(), ns)
    message.p_n, message.p_e, message.p_d = (float(x) for x in place)
    message.psi = psi
    message.quat.w, message.quat.z = math.cos(psi / 2), math.sin(psi / 2)
    return message


def going(north, height=5.0, **more):
    return Waypoint(type=Waypoint.TYPE_GOTO, w=[float(north), 0.0, -height], **more)


class Path:
    """A vehicle in front of the path manager that is always where the setpoint is."""

    def __init__(self, peer, place):
        self.peer, self.ns, self.place = peer, START_NS, place
        self.received = peer.listen(TrajectoryCommand, "trajectory_command")
        self.states = peer.publisher(State, "estimated_state")
        self.waypoints = peer.publisher(Waypoint, "waypoints", LATCHED)
        peer.poll(lambda: self.waypoints.get_subscription_count() and self.states.get_subscription_count()
                  and peer.node.count_publishers("trajectory_command"), "both ends of the topics")

    def step(self, seconds=0.05):
        """The setpoint that answers a State."""
        self.ns += round(seconds * 1e9)
        self.states.publish(state(self.ns, self.place))
        self.peer.wait(lambda: self.received and stamp_ns(self.received[-1]) == self.ns, "a setpoint")
        self.place = tuple(float(x) for x in self.received[-1].position)
        return self.received[-1]

    def silent(self):
        """No answer to some States."""
        count = len(self.received)
        for _ in range(5):
            self.ns += 50_000_000
            self.states.publish(state(self.ns, self.place))
            time.sleep(0.05)
        return len(self.received) == count
