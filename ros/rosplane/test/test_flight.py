# SPDX-License-Identifier: BSD-3-Clause
"""The launched simulator and stack fly a shipped mission on the estimate: take-off, waypoints, landing. Where the aircraft
was is judged from outside, by the truth; on the way a gain is changed and takes effect."""

import math

from ros_rig import ROOT, free_udp_port
from rosflight_msgs.msg import Command, SimState, Status
from rosplane_msgs.msg import ControllerInternals, FlightPhase, State
from sim_rig import SimPeer, last_s, launch, set_parameters, stamp_ns
from std_srvs.srv import Trigger

FASTEST = "10.0"  # more than this machine holds: as fast as it can, and time waits for the world
OVERRIDE = Status.OVERRIDE_ATT_SWITCH | Status.OVERRIDE_THR_SWITCH
WAYPOINTS = [(300.0, -150.0, -40.0), (-150.0, -150.0, -40.0)]  # missions/circuit.yaml
RADIUS = 50.0  # limits.turn_radius_m of vehicles/anaconda.yaml


class Flight:
    """The world with the stack, and an observer."""

    def __init__(self, folder, mission):
        ports = {"simulation_port": free_udp_port(), "ROS_port": free_udp_port()}
        self.peer = SimPeer("judge")
        self.world = launch("rosplane", "fly.launch.xml", use_sim_time="true", real_time_multiplier=FASTEST, viz="false", wait_for="sim/RC flight_phase command judge",
                            memory_folder=folder, mission_file=mission, **ports)
        listen = self.peer.listen
        self.truth, self.status = listen(SimState, "sim/truth_state", progress="judge"), listen(Status, "status")
        self.states, self.phases = listen(State, "estimated_state"), listen(FlightPhase, "flight_phase")
        self.commands, self.inner = listen(Command, "command"), listen(ControllerInternals, "controller_internals")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.world.stop()
        self.peer.close()

    def until(self, condition, what):
        try:
            self.peer.wait_simulated(condition, what, lambda: last_s(self.truth))
        except AssertionError as why:
            raise AssertionError(f"{why}; phase {self.phases[-1:]}\n{self.world.text()[-4000:]}") from None

    def until_phase(self, *numbers):
        self.until(lambda: self.phases and self.phases[-1].phase in numbers, f"phase {numbers}")

    def time_s(self):
        return stamp_ns(self.truth[-1]) * 1e-9

    def speeds(self, first, last):
        """Airspeed by the truth (there is no wind) between two times."""
        return [math.hypot(v.x, v.y, v.z) for m in list(self.truth) for v in [m.twist.linear] if first < stamp_ns(m) * 1e-9 < last]


def test_a_mission_from_take_off_to_landing(tmp_path):
    with Flight(tmp_path, ROOT / "missions/circuit.yaml") as flight:
        flight.world.until("all stored")
        flight.until(lambda: flight.states and flight.status and flight.status[-1].error_code == 0, "a state and no error")
        assert flight.peer.call(Trigger, "toggle_arm").success
        flight.until(lambda: flight.status[-1].armed, "being armed")
        assert flight.phases[-1].idle or flight.phases[-1].phase == FlightPhase.TAKEOFF  # the pilot holds it
        assert flight.peer.call(Trigger, "toggle_override").success
        flight.until(lambda: not flight.status[-1].rc_override & OVERRIDE, "the pilot's hands off")
        flight.until_phase(FlightPhase.MISSION)
        aloft = flight.time_s()

        # A gain in flight: without any on the roll axis the ailerons rest; the old ones fly on.
        assert all(r.successful for r in set_parameters(flight.peer, "controller", r_kp=0.0, r_ki=0.0, r_kd=0.0))
        flight.until(lambda: flight.commands[-1].u[3] == 0.0, "ailerons at rest")
        assert all(r.successful for r in set_parameters(flight.peer, "controller", r_kp=1.1, r_ki=0.3, r_kd=0.06))
        flight.until(lambda: flight.commands[-1].u[3] != 0.0, "ailerons at work")
        refused = set_parameters(flight.peer, "path_manager", R_min=900.0)[0]
        assert not refused.successful and "waypoint" in refused.reason

        flight.until(lambda: flight.phases[-1].mission_done, "the end of the mission")
        cruised = flight.time_s()
        flight.until_phase(FlightPhase.LANDED)
        assert flight.peer.call(Trigger, "toggle_arm").success
        flight.until(lambda: not flight.status[-1].armed, "being disarmed")

        places = [(m.pose.position.x, m.pose.position.y, m.pose.position.z) for m in flight.truth]
        # A fillet of a turn passes at R (1/cos(turn/2) - 1): 130 degrees, as the climb ends beyond 150 m; the last is flown over.
        for waypoint, cut in zip(WAYPOINTS, (RADIUS * (1 / math.cos(math.radians(65.0)) - 1), 0.0)):
            assert min(math.dist(waypoint, place) for place in places) < cut + 5.0
        speeds = flight.speeds(aloft, cruised)
        assert 11.5 < min(speeds) and max(speeds) < 19.0
        seen = {m.phase for m in flight.phases}
        assert {FlightPhase.TAKEOFF, FlightPhase.CLIMB, FlightPhase.MISSION, FlightPhase.APPROACH, FlightPhase.FLARE,
                FlightPhase.ROLLOUT, FlightPhase.LANDED} <= seen
        assert not seen & {FlightPhase.LOITER, FlightPhase.GLIDE}, flight.world.text()[-4000:]
        # It came down where it was meant to, softly.
        flare = next(stamp_ns(m) for m in flight.phases if m.phase == FlightPhase.FLARE)
        down = next(m for m in flight.truth if stamp_ns(m) > flare and m.pose.position.z > -0.25)
        assert math.hypot(down.pose.position.x, down.pose.position.y) < 15.0
        assert down.twist.linear.z < 1.5
        assert not any(m.failsafe for m in flight.status)
        assert any(m.offboard and not m.rc_override & OVERRIDE for m in flight.status)
        assert any(m.alt_zone == ControllerInternals.ZONE_DESEND for m in flight.inner)
