# SPDX-License-Identifier: BSD-3-Clause
"""A flight of roscopter in the launched simulator, from arming to the end, and what an observer sees of it."""

import math

from ros_rig import free_udp_port
from rosflight_msgs.msg import SimState, Status
from roscopter_msgs.msg import ControllerCommand, State, TrajectoryCommand
from sim_rig import LATCHED, SimPeer, last_s, launch
from std_msgs.msg import String
from std_srvs.srv import Trigger

FASTEST = "10.0"  # more than any machine holds: as fast as it can, and time waits for the world
OVERRIDE = Status.OVERRIDE_ATT_SWITCH | Status.OVERRIDE_THR_SWITCH


class Flight:
    """The world with the stack, and an observer. Use it in a with statement."""

    def __init__(self, package, file, folder, **arguments):
        self.peer = SimPeer("judge")
        ports = {"simulation_port": free_udp_port(), "ROS_port": free_udp_port()}
        self.process = launch(package, file, use_sim_time="true", real_time_multiplier=FASTEST, viz="false",
                              memory_folder=folder, wait_for="sim/RC command judge", **ports, **arguments)
        self.truth = self.peer.listen(SimState, "sim/truth_state", progress="judge")
        self.status = self.peer.listen(Status, "status")
        self.states = self.peer.listen(State, "estimated_state")
        self.commands = self.peer.listen(ControllerCommand, "high_level_command")
        self.setpoints = self.peer.listen(TrajectoryCommand, "trajectory_command")
        self.phases = self.peer.listen(String, "flight_phase", LATCHED)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.stop()
        self.peer.close()

    def phase(self):
        return self.phases[-1].data if self.phases else ""

    def until(self, condition, what):
        try:
            self.peer.wait_simulated(condition, what, lambda: last_s(self.truth))
        except AssertionError as why:
            raise AssertionError(f"{why}; phases {[p.data for p in self.phases]}\n{self.process.text()[-4000:]}") from None

    def until_phase(self, *names):
        self.until(lambda: self.phase() in names, f"phase {' or '.join(names)}")

    def set_up(self):
        """Firmware parameters are in, the IMU is calibrated, the estimate flows."""
        self.process.until("all stored")
        self.until(lambda: self.states and self.status and self.status[-1].error_code == 0, "a state and no error")

    def pilot(self, service, condition, what):
        """Flips a switch of the pilot and waits until the autopilot has followed."""
        assert self.peer.call(Trigger, service).success
        self.until(condition, what)

    def take_off(self):
        self.pilot("toggle_arm", lambda: self.status[-1].armed, "being armed")
        self.pilot("toggle_override", lambda: not self.status[-1].rc_override & OVERRIDE, "the override to end")
        self.until_phase("takeoff", "position_hold", "offboard")

    def place(self):
        p = self.truth[-1].pose.position
        return p.x, p.y, p.z

    def nearest_to(self, place):
        """How close the vehicle, by the truth, has come to a place."""
        return min(math.dist(place, (m.pose.position.x, m.pose.position.y, m.pose.position.z)) for m in list(self.truth))
