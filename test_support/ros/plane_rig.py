# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of rosplane share: states as an estimator would send them, parameters, contracts of the nodes."""

import math
import time

from ros_rig import ROOT
from rosflight_msgs.msg import Airspeed, Barometer, BatteryStatus, Command, Fence, GNSS, RCRaw, SimState, Status
from rosgraph_msgs.msg import Clock
from rosplane_msgs.msg import (ControllerCommands, ControllerInternals, CurrentPath, FlightPhase, MissionSettings, State,
                               Waypoint)
from sensor_msgs.msg import Imu, MagneticField, Range
from sim_contract import TRIGGER, Module, Out
from sim_rig import ALL_BEST_EFFORT, NEWEST, node, stamp
from visualization_msgs.msg import Marker

VEHICLE = ROOT / "vehicles/anaconda.yaml"
ADD = "rosplane_msgs/srv/AddWaypoint"
SIGNALS = ("toggle_step_signal", "reset_signal", "pause_signal", "start_continuous_signal", "start_single_period_signal")
MODES = ("set_path_follower_mode", "set_altitude_course_airspeed_control_mode", "set_angle_control_mode",
         "set_rc_passthrough_mode")
# Topics, types and services of rosplane 2.0.0; flight_phase, mission_settings and inputs beside ROSflight 2.x's are ours.
NODES = {
    "estimator": Module("estimator", {"estimated_state": Out(State)},
                        {"imu/data": Imu, "gnss": GNSS, "baro": Barometer, "airspeed": Airspeed,
                         "magnetometer": MagneticField, "status": Status}),
    "path_planner": Module("path_planner", {"waypoint_path": Out(Waypoint, latched=True),
                                            "mission_settings": Out(MissionSettings, latched=True),
                                            "mission/fence": Out(Fence, latched=True)},
                           {"estimated_state": State},
                           {"add_waypoint": ADD, "clear_waypoints": TRIGGER, "print_waypoints": TRIGGER,
                            "publish_next_waypoint": TRIGGER, "load_mission_from_file": "rosflight_msgs/srv/ParamFile"}),
    "path_manager": Module("path_manager", {"current_path": Out(CurrentPath), "flight_phase": Out(FlightPhase)},
                           {"estimated_state": State, "waypoint_path": Waypoint, "mission_settings": MissionSettings,
                            "status": Status, "range": Range, "command": Command,
                            "controller_command": ControllerCommands, "battery": BatteryStatus, "mission/fence": Fence},
                           {"land": TRIGGER, "return_to_base": TRIGGER}),
    "path_follower": Module("path_follower", {"controller_command": Out(ControllerCommands)},
                            {"estimated_state": State, "current_path": CurrentPath}),
    "controller": Module("controller", {"command": Out(Command), "controller_internals": Out(ControllerInternals)},
                         {"estimated_state": State, "controller_command": ControllerCommands,
                          "flight_phase": FlightPhase, "status": Status}),
    "rviz_waypoint_publisher": Module("rviz_waypoint_publisher", {"rviz/waypoint": Out(Marker, latched=True)},
                                      {"waypoint_path": Waypoint}),
    "sim_state_transcriber": Module("rosplane_truth", {"sim/rosplane/state": Out(State)}, {"sim/truth_state": SimState}),
    "signal_generator": Module("signal_generator", {"controller_command": Out(ControllerCommands)}, {},
                               dict.fromkeys(SIGNALS, TRIGGER)),
    "input_mapper": Module("input_mapper", {"mapped_controller_command": Out(ControllerCommands), "mapped_command": Out(Command)},
                           {"input_controller_command": ControllerCommands, "input_command": Command, "rc_raw": RCRaw,
                            "estimated_state": State},
                           {f"input_mapper/{mode}": TRIGGER for mode in MODES}),
}
WITHOUT_VEHICLE = {"signal_generator", "input_mapper", "rviz_waypoint_publisher"}


def start(name, **parameters):
    """A node of rosplane by itself, with the vehicle file where it takes one."""
    if name not in WITHOUT_VEHICLE:
        parameters.setdefault("vehicle_file", VEHICLE)
    return node(name, package="rosplane", **parameters)


def state(ns, north=0.0, east=0.0, height=60.0, course=0.0, airspeed=15.0, roll=0.0, climb=0.0):
    """Flight with a level nose in still air, nose on the course."""
    message = stamp(State(), ns)
    message.p_n, message.p_e, message.p_d = north, east, -height
    message.v_x, message.v_z = airspeed, -climb
    message.phi, message.psi, message.chi, message.va = roll, course, course, airspeed
    cr, sr, cy, sy = math.cos(roll / 2), math.sin(roll / 2), math.cos(course / 2), math.sin(course / 2)
    q = message.quat
    q.w, q.x, q.y, q.z = cr * cy, sr * cy, sr * sy, cr * sy
    return message


def now_ns():
    return time.time_ns()


def falls_silent(received, feed):
    """Feeds a node until it has not answered 40 times in a row; what was on its way still comes. False: it never ends."""
    for _ in range(20):
        count = len(received)
        for _ in range(40):
            feed()
            time.sleep(0.005)
        if len(received) == count:
            return True
    return False


class World:
    """path_manager on simulated time: clock, state and status, tick by tick."""

    def __init__(self, peer):
        self.peer, self.t_s = peer, 100.0
        self.clock = peer.publisher(Clock, "/clock", ALL_BEST_EFFORT)
        self.states = peer.publisher(State, "estimated_state")
        self.status = peer.publisher(Status, "status", NEWEST)
        self.command = peer.publisher(Command, "command", NEWEST)
        self.phases, self.paths = peer.listen(FlightPhase, "flight_phase"), peer.listen(CurrentPath, "current_path")
        self.battery = peer.publisher(BatteryStatus, "battery", NEWEST)
        self.armed = self.failsafe = False
        self.throttle = self.voltage = None

    def tick(self, dt_s=0.02, **fields):
        self.t_s += dt_s
        ns = round(self.t_s * 1e9)
        clock = Clock()
        clock.clock.sec, clock.clock.nanosec = divmod(ns, 1_000_000_000)
        self.clock.publish(clock)
        self.status.publish(stamp(Status(armed=self.armed, failsafe=self.failsafe), ns))
        if self.throttle is not None:
            self.command.publish(stamp(Command(u=[self.throttle] + 9 * [0.0]), ns))
        if self.voltage is not None:
            self.battery.publish(stamp(BatteryStatus(voltage=self.voltage, current=1.0), ns))
        self.states.publish(state(ns, **fields))

    def until_phase(self, number, **fields):
        first = len(self.phases)

        def there():
            self.tick(**fields)
            return any(m.phase == number for m in self.phases[first:])
        self.peer.poll(there, f"phase {number}, last {self.phases[-1:]}")

    def until_path(self, condition, what, **fields):
        first = len(self.paths)
        try:
            self.peer.poll(lambda: self.tick(**fields) or any(condition(m) for m in self.paths[first:]), what)
        except AssertionError as why:
            raise AssertionError(f"{why}: {self.phases[-1:]} {self.paths[-1:]}") from None
        return next(m for m in self.paths[first:] if condition(m))


def waypoint(*w, **more):
    return Waypoint(w=[float(x) for x in w], va_d=15.0, **more)
