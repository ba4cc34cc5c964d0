# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of roscopter's nodes share: starting one by itself, and messages for it."""

import math

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from roscopter_msgs.msg import State, Waypoint
from sim_rig import LATCHED, VEHICLE, node, stamp

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
