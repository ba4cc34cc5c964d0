# SPDX-License-Identifier: BSD-3-Clause
"""A flight of rosplane in the launched simulator, and what an observer sees of it."""

import math

from flight_rig import FlightRig
from rosflight_msgs.msg import Command
from rosplane_msgs.msg import ControllerInternals, FlightPhase, State
from sim_rig import stamp_ns


class Flight(FlightRig):
    def __init__(self, package, file, folder, wait_for="sim/RC flight_phase command", **arguments):
        super().__init__(State, package, file, folder, wait_for, **arguments)
        self.phases = self.peer.listen(FlightPhase, "flight_phase")
        self.commands = self.peer.listen(Command, "command")
        self.inner = self.peer.listen(ControllerInternals, "controller_internals")

    def seen(self):
        return f"phase {self.phases[-1:]}"

    def until_phase(self, *numbers):
        self.until(lambda: self.phases and self.phases[-1].phase in numbers, f"phase {numbers}")

    def time_s(self):
        return stamp_ns(self.truth[-1]) * 1e-9

    def speeds(self, first, last):
        """Airspeed by the truth (there is no wind) between two times."""
        return [math.hypot(v.x, v.y, v.z) for m in list(self.truth) for v in [m.twist.linear] if first < stamp_ns(m) * 1e-9 < last]
