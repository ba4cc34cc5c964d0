# SPDX-License-Identifier: BSD-3-Clause
"""The tuning launch in flight, on the truth, with successive loops: it takes off by altitude zones, and a square wave on the
roll is followed. Nothing of guidance runs."""

import math

from plane_rig import VEHICLE
from ros_rig import free_udp_port
from rosflight_msgs.msg import Status
from rosplane_msgs.msg import ControllerInternals, State
from sim_rig import Process, SimPeer, executable, last_s, launch, set_parameters
from std_srvs.srv import Trigger

UP, DOWN = 0.25, -0.25  # default_phi_c and signal_magnitude of the launch file [rad]


def test_a_signal_on_the_roll_is_flown(tmp_path):
    ports = {"simulation_port": free_udp_port(), "ROS_port": free_udp_port()}
    with SimPeer("tuner") as peer, \
            launch("rosflight_sim", "fixedwing_standalone.launch.xml", use_sim_time="true", viz="false",
                   real_time_multiplier="10.0", memory_folder=tmp_path, **ports) as world, \
            launch("rosplane", "sim_tuning.launch.xml", use_sim_time="true", control_type="successive_loop",
                   state_topic_remap="sim/rosplane/state", frequency_hz="0.25") as stack:
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
        for wanted in (UP, DOWN, UP):
            until(lambda w=wanted: abs(inner[-1].phi_c - w) < 0.01, f"a command of {wanted}")
            # A wing that follows is there within the half period of 2 s.
            until(lambda w=wanted: abs(states[-1].phi - w) < 0.06 or abs(inner[-1].phi_c - w) > 0.4, f"a roll of {wanted}")
            assert abs(states[-1].phi - wanted) < 0.06
        until(lambda: abs(states[-1].p_d + 60.0) < 6.0, "the height of the launch file")
        assert 12.0 < states[-1].va < 18.0 and math.isfinite(states[-1].beta)
