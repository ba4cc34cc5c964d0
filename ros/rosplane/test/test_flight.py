# SPDX-License-Identifier: BSD-3-Clause
"""The launched simulator and stack fly a shipped mission on the estimate: take-off, waypoints, landing. Where the aircraft
was is judged from outside, by the truth; on the way a gain is changed and takes effect."""

import math

from flight_rig import OVERRIDE
from plane_flight import Flight
from ros_rig import ROOT
from rosplane_msgs.msg import ControllerInternals, FlightPhase
from sim_rig import set_parameters, stamp_ns

WAYPOINTS = [(300.0, -150.0, -40.0), (-150.0, -150.0, -40.0)]  # missions/circuit.yaml
RADIUS = 50.0  # limits.turn_radius_m of vehicles/anaconda.yaml


def test_a_mission_from_take_off_to_landing(tmp_path):
    with Flight("rosplane", "fly.launch.xml", tmp_path, mission_file=ROOT / "missions/circuit.yaml") as flight:
        flight.set_up()
        flight.arm()
        assert flight.phases[-1].idle or flight.phases[-1].phase == FlightPhase.TAKEOFF  # the pilot holds it
        flight.let_go()
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
        flight.disarm()

        # A fillet of a turn passes at R (1/cos(turn/2) - 1): 130 degrees, as the climb ends beyond 150 m; the last is flown over.
        for waypoint, cut in zip(WAYPOINTS, (RADIUS * (1 / math.cos(math.radians(65.0)) - 1), 0.0)):
            assert flight.nearest_to(waypoint) < cut + 5.0
        speeds = flight.speeds(aloft, cruised)
        assert 11.5 < min(speeds) and max(speeds) < 19.0
        seen = {m.phase for m in flight.phases}
        assert {FlightPhase.TAKEOFF, FlightPhase.CLIMB, FlightPhase.MISSION, FlightPhase.APPROACH, FlightPhase.FLARE,
                FlightPhase.ROLLOUT, FlightPhase.LANDED} <= seen
        assert not seen & {FlightPhase.LOITER, FlightPhase.GLIDE}, flight.process.text()[-4000:]
        # It came down where it was meant to, softly.
        flare = next(stamp_ns(m) for m in flight.phases if m.phase == FlightPhase.FLARE)
        down = next(m for m in flight.truth if stamp_ns(m) > flare and m.pose.position.z > -0.25)
        assert math.hypot(down.pose.position.x, down.pose.position.y) < 15.0
        assert down.twist.linear.z < 1.5
        assert not any(m.failsafe for m in flight.status)
        flight.judge_errors()
        flight.judge_steps()
        assert any(m.offboard and not m.rc_override & OVERRIDE for m in flight.status)
        assert any(m.alt_zone == ControllerInternals.ZONE_DESEND for m in flight.inner)
