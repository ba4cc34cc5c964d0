# SPDX-License-Identifier: BSD-3-Clause
"""A flight of roscopter in the launched simulator, from arming to the end, and what an observer sees of it."""

from flight_rig import FlightRig
from roscopter_msgs.msg import ControllerCommand, State, TrajectoryCommand
from sim_rig import LATCHED
from std_msgs.msg import String


class Flight(FlightRig):
    def __init__(self, package, file, folder, wait_for="sim/RC command", **arguments):
        super().__init__(State, package, file, folder, wait_for, **arguments)
        self.commands = self.peer.listen(ControllerCommand, "high_level_command")
        self.setpoints = self.peer.listen(TrajectoryCommand, "trajectory_command")
        self.phases = self.peer.listen(String, "flight_phase", LATCHED)

    def seen(self):
        return f"phases {[p.data for p in self.phases]}"

    def phase(self):
        return self.phases[-1].data if self.phases else ""

    def until_phase(self, *names):
        self.until(lambda: self.phase() in names, f"phase {' or '.join(names)}")

    def take_off(self):
        """Not before this observer has found the controller: the phases before that are lost to it."""
        self.until(lambda: self.phases, "a phase of the controller")
        self.arm()
        self.let_go()
        self.until(lambda: self.phase() != "disarmed", "a phase in the air")
