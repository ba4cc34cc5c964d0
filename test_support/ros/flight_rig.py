# SPDX-License-Identifier: BSD-3-Clause
"""A flight in the launched simulator, as fast as the machine can, and what an observer sees of any vehicle."""

import math

from ros_rig import free_udp_port
from rosflight_msgs.msg import SimState, Status
from sim_rig import SimPeer, last_s, launch, stamp_ns
from std_srvs.srv import Trigger

FASTEST = "10.0"  # more than any machine holds: as fast as it can, and time waits for the world
STEP_NS = 2_500_000  # default_pub_rate_us of the time manager
OVERRIDE = Status.OVERRIDE_ATT_SWITCH | Status.OVERRIDE_THR_SWITCH


class FlightRig:
    """The world with a stack, and an observer. Use it in a with statement."""

    def __init__(self, state, package, file, folder, wait_for, shows=True, **arguments):
        """`state`: the message on `estimated_state`, None without a stack; `wait_for`: what simulated time waits for beside the observer;
        `shows`: the launch file has nodes for RViz, which are left out."""
        self.peer = SimPeer("judge")
        arguments |= {"viz": "false"} if shows else {}
        ports = {"simulation_port": free_udp_port(), "ROS_port": free_udp_port()}
        self.process = launch(package, file, use_sim_time="true", real_time_multiplier=FASTEST, memory_folder=folder,
                              wait_for=f"{wait_for} judge", **ports, **arguments)
        self.truth = self.peer.listen(SimState, "sim/truth_state", progress="judge")
        self.status = self.peer.listen(Status, "status")
        self.states = self.peer.listen(state, "estimated_state") if state else []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.stop()
        self.peer.close()

    def seen(self):
        """What a failure shows beside the log."""
        return ""

    def until(self, condition, what):
        try:
            self.peer.wait_simulated(condition, what, lambda: last_s(self.truth))
        except AssertionError as why:
            raise AssertionError(f"{why}; {self.seen()}\n{self.process.text()[-4000:]}") from None

    def set_up(self):
        """Firmware parameters are in, the IMU is calibrated, the estimate flows."""
        self.process.until("all stored")
        self.until(lambda: self.states and self.status and self.status[-1].error_code == 0, "a state and no error")

    def pilot(self, service, condition, what):
        """Flips a switch of the pilot and waits until the autopilot has followed."""
        assert self.peer.call(Trigger, service).success
        self.until(condition, what)

    def arm(self):
        self.pilot("toggle_arm", lambda: self.status[-1].armed, "being armed")

    def disarm(self):
        self.pilot("toggle_arm", lambda: not self.status[-1].armed, "being disarmed")

    def let_go(self):
        self.pilot("toggle_override", lambda: not self.status[-1].rc_override & OVERRIDE, "the override to end")

    def judge_errors(self):
        """None in the air, however brisk the climb."""
        assert not [m for m in list(self.status) if m.armed and m.error_code], self.process.text()[-4000:]

    def judge_steps(self):
        """From arming on none of the world's steps is missing, unless this observer was given up as too slow. Before, the nodes are
        still finding each other."""
        if "no /judge for 2 s" in self.process.text():
            return
        armed = stamp_ns(next(m for m in self.status if m.armed))
        stamps = [s for m in list(self.truth) if (s := stamp_ns(m)) >= armed]
        gaps = [b - a for a, b in zip(stamps, stamps[1:]) if b - a not in (0, STEP_NS)]  # 0: said again
        assert len(stamps) > 1000 and not gaps, gaps[:10]

    def place(self):
        p = self.truth[-1].pose.position
        return p.x, p.y, p.z

    def nearest_to(self, place):
        """How close the vehicle, by the truth, has come to a place."""
        return min(math.dist(place, (m.pose.position.x, m.pose.position.y, m.pose.position.z)) for m in list(self.truth))
