# SPDX-License-Identifier: BSD-3-Clause
"""The tuning launch in flight, on the truth, with successive loops: it takes off by altitude zones, and a square wave on the
roll is followed. Nothing of guidance runs."""

import math

from plane_rig import VEHICLE
from ros_rig import free_udp_port
from rosflight_msgs.msg import Status
from rosplane_msgs.msg import ControllerInternals, State
from sim_rig import Process, SimPeer, executable, last_s, launch, set_parameters, stamp_ns
from std_srvs.srv import Trigger

UP, DOWN = 0.25, -0.25  # default_phi_c and signal_magnitude of the launch file [rad]
PERIOD_S = 4.0


def ends_of_halves(inner):
    """The last message with the whole roll of each half period that was seen from turn to turn. The command ramps in between."""
    turns = [k for k in range(1, len(inner)) if inner[k].phi_c * inner[k - 1].phi_c < 0.0]
    halves = [inner[a:b] for a, b in zip(turns, turns[1:]) if stamp_ns(inner[b]) - stamp_ns(inner[a]) > 0.45e9 * PERIOD_S]
    return [[message for message in half if abs(message.phi_c) > 0.999 * UP][-1] for half in halves]


def test_a_signal_on_the_roll_is_flown(tmp_path):
    ports = {"simulation_port": free_udp_port(), "ROS_port": free_udp_port()}
    with SimPeer("tuner") as peer, \
            launch("rosflight_sim", "fixedwing_standalone.launch.xml", use_sim_time="true", viz="false",
                   real_time_multiplier="10.0", memory_folder=tmp_path, **ports) as world, \
            launch("rosplane", "sim_tuning.launch.xml", use_sim_time="true", control_type="successive_loop",
                   state_topic_remap="sim/rosplane/state", frequency_hz=str(1.0 / PERIOD_S)) as stack:
        world.until("ready: ")
        with Process(executable("rosflight_sim", "init_firmware"), "--vehicle", VEHICLE) as init:
            assert init.end() == 0, init.text()
        stack.until("ready: ")
        states, status = peer.listen(State, "sim/rosplane/state"), peer.listen(Status, "status")
        inner = peer.listen(ControllerInternals, "controller_internals")
        peer.wait(lambda: states and status, "the world")

        def until(condition, what):
            try:
                peer.wait_simulated(condition, what, lambda: last_s(states))
            except AssertionError as why:
                raise AssertionError(f"{why}: {states[-1]}\n{stack.text()[-2000:]}") from None
        assert peer.call(Trigger, "toggle_arm").success
        until(lambda: status[-1].armed, "being armed")
        assert peer.call(Trigger, "toggle_override").success
        until(lambda: inner and inner[-1].alt_zone == ControllerInternals.ZONE_CLIMB, "the climb")
        until(lambda: inner[-1].alt_zone == ControllerInternals.ZONE_ALTITUDE_HOLD, "the height")
        assert set_parameters(peer, "controller", roll_command_override=True)[0].successful
        assert peer.call(Trigger, "start_continuous_signal").success
        start_s = last_s(inner)
        until(lambda: last_s(inner) > start_s + 4 * PERIOD_S, "four periods")
        # On a busy machine the states, sent more often, are read later than the commands, and ever later.
        ends, end_s = ends_of_halves(inner), last_s(inner)
        until(lambda: last_s(states) > end_s, "the states of four periods")
        assert {round(end.phi_c, 2) for end in ends} == {UP, DOWN} and len(ends) >= 6
        # A fixed wing that follows is there at the end of the half period of 2 s.
        rolls = {stamp_ns(state): state.phi for state in states}
        for end in ends:
            at_ns = min(rolls, key=lambda ns, e=end: abs(ns - stamp_ns(e)))
            assert abs(at_ns - stamp_ns(end)) < 0.1e9 and abs(rolls[at_ns] - end.phi_c) < 0.06
        until(lambda: abs(states[-1].p_d + 60.0) < 6.0, "the height of the launch file")
        assert 12.0 < states[-1].va < 18.0 and math.isfinite(states[-1].beta)
