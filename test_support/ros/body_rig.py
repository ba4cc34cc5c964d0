# SPDX-License-Identifier: BSD-3-Clause
"""A dynamics module by itself, led wrench by wrench: ours, or Gazebo's in its place."""

from geometry_msgs.msg import Vector3Stamped, WrenchStamped
from rosflight_msgs.msg import SimState
from rosflight_msgs.srv import SetSimState
from sim_rig import stamp

TICK_NS = 2_500_000
START_NS = 100_000_000_000


class Body:
    """Wrenches in, truth out, one for one."""

    def __init__(self, peer):
        self.peer, self.ns = peer, START_NS
        self.truth = peer.listen(SimState, "sim/truth_state")
        self.wind = peer.listen(Vector3Stamped, "sim/truth_wind")
        self.wrench = peer.publisher(WrenchStamped, "sim/forces_and_moments")
        peer.introduce(lambda: self._send(0.0), self.truth, "sim/forces_and_moments")
        self.wind.clear()

    def _send(self, up_N, roll_Nm=0.0):
        self.ns += TICK_NS
        message = stamp(WrenchStamped(), self.ns)
        message.wrench.force.z, message.wrench.torque.x = -up_N, roll_Nm
        self.wrench.publish(message)

    def step(self, up_N=0.0, roll_Nm=0.0):
        count = len(self.truth)
        self._send(up_N, roll_Nm)
        self.peer.wait(lambda: len(self.truth) > count, "truth")
        return self.truth[-1]

    def put(self, message):
        return self.peer.call(SetSimState, "dynamics/set_sim_state", state=message)
