# SPDX-License-Identifier: BSD-3-Clause
"""The launched simulator and stack: outside of a fence the aircraft returns and lands. Judged by the truth."""

import math

from plane_flight import Flight
from ros_rig import ROOT
from rosflight_msgs.msg import Fence
from rosplane_msgs.msg import FlightPhase
from sim_rig import LATCHED, stamp_ns

FENCE_M = 250.0  # the first waypoint of missions/circuit.yaml is 335 m away


def lands_at_the_start(flight):
    flight.until_phase(FlightPhase.RETURN)
    flight.until_phase(FlightPhase.LANDED)
    flight.disarm()
    seen = {m.phase for m in flight.phases}
    assert not any(m.mission_done for m in flight.phases)
    assert not seen & {FlightPhase.GLIDE, FlightPhase.DESCENT}, flight.process.text()[-4000:]
    flare = next(stamp_ns(m) for m in flight.phases if m.phase == FlightPhase.FLARE)
    down = next(m for m in flight.truth if stamp_ns(m) > flare and m.pose.position.z > -0.25)
    assert math.hypot(down.pose.position.x, down.pose.position.y) < 30.0
    assert down.twist.linear.z < 1.5
    flight.judge_errors()


def test_outside_of_a_fence_it_returns_and_lands(tmp_path):
    with Flight("rosplane", "fly.launch.xml", tmp_path, mission_file=ROOT / "missions/circuit.yaml") as flight:
        fence = flight.peer.publisher(Fence, "mission/fence", LATCHED)
        flight.set_up()
        flight.arm()
        flight.let_go()
        flight.until_phase(FlightPhase.MISSION)
        fence.publish(Fence(radius=FENCE_M, height=100.0))
        flight.process.until("fence: 250 m around the start, 100 m high")
        lands_at_the_start(flight)
        assert flight.process.text().count("outside of the fence: returns (250 m around the start, 100 m high)") == 1
        began = next(stamp_ns(m) for m in flight.phases if m.phase == FlightPhase.RETURN)
        at = next(m.pose.position for m in flight.truth if stamp_ns(m) >= began)
        assert FENCE_M < math.hypot(at.x, at.y) < FENCE_M + 20.0, "half a second beyond it, and the error of the estimate"
