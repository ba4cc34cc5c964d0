# SPDX-License-Identifier: BSD-3-Clause
"""The fixed-wing forces node by itself: contract, ROSflight 2.x's numbers under its parameter names, live changes. And a
fixed wing flown in the launched simulator, by a few lines of rclpy."""

import dataclasses
import math

import pytest
from geometry_msgs.msg import WrenchStamped
from rcl_interfaces.srv import DescribeParameters
from ros_rig import ROOT, free_udp_port
from rosflight_msgs.msg import Command, PwmOutput, SimState, Status
from sim_contract import MODULES, check_headers, check_module
from sim_rig import SimPeer, launch, node, set_parameters, stamp, stamp_ns
from std_srvs.srv import Trigger

VEHICLE = ROOT / "vehicles/anaconda.yaml"
NODE = "fixedwing_forces_and_moments"
MODULE = dataclasses.replace(MODULES["forces"], node=NODE)
TICK_NS = 2_500_000
MIDDLE = 1500
IDLE = 1000
# ROSflight 2.x's Anaconda under ROSflight 2.x's names, and its aerodynamics.
REFERENCE = {"vehicle_overrides": '["aero.model=reference", "rotors.motor.current_limit_A=1000"]', "rho": 1.2682, "V_max": 24.0,
             "wing_s": 0.52, "wing_b": 2.08, "wing_c": 0.235, "C_L_O": 0.506, "C_L_alpha": 5.61, "C_D_p": 0.043, "C_m_O": 0.135,
             "C_m_alpha": -2.74, "C_m_delta_e": -0.99, "D_prop": 0.381, "KQ": 0.01705, "R_motor": 0.042, "I_0": 1.5,
             "servo_tau": 0.01}
MASS, GRAVITY = 4.5, 9.81


def forces(**more):
    return node(NODE, at_launch=NODE, vehicle_file=VEHICLE, **more)


class Tunnel:
    """Pulses in, wrenches out, one for one, at a speed through the air."""

    def __init__(self, peer):
        self.peer, self.ns = peer, 100_000_000_000
        self.received = peer.listen(WrenchStamped, "sim/forces_and_moments")
        self.pulses = peer.publisher(PwmOutput, "sim/pwm_output")
        self.truth = peer.publisher(SimState, "sim/truth_state")
        peer.introduce(lambda: self._send(0, 0, 0, 0), self.received, "sim/pwm_output")

    def _send(self, aileron, left, right, throttle):
        """Surfaces from -1 to 1, throttle from 0 to 1. The left and right half of the tail are outputs 1 and 2."""
        self.ns += TICK_NS
        values = [round(MIDDLE + 500 * x) for x in (aileron, left, right)] + [MIDDLE, round(IDLE + 1000 * throttle)]
        self.pulses.publish(stamp(PwmOutput(values=[*values, *[MIDDLE] * 9]), self.ns))

    def step(self, aileron=0.0, left=0.0, right=0.0, throttle=0.0):
        count = len(self.received)
        self._send(aileron, left, right, throttle)
        self.peer.wait(lambda: len(self.received) > count, "a wrench")
        return self.received[-1]

    def settle(self, **outputs):
        """After 1.25 s: servos and propeller have got there."""
        for _ in range(500):
            last = self.step(**outputs)
        return last.wrench

    def fly(self, speed, alpha):
        """Level flight with the nose up by alpha [rad]; returns when the node knows it."""
        state = stamp(SimState(), self.ns)
        state.pose.position.z = -100.0
        state.pose.orientation.w, state.pose.orientation.y = math.cos(alpha / 2), math.sin(alpha / 2)
        state.twist.linear.x, state.twist.linear.z = speed * math.cos(alpha), speed * math.sin(alpha)
        self.truth.publish(state)
        self.peer.poll(lambda: self.step().wrench.force.z < -1.0, "lift")


def test_contract(peer):
    with forces():
        check_module(peer, MODULE)
        tunnel = Tunnel(peer)
        for _ in range(100):
            assert stamp_ns(tunnel.step()) == tunnel.ns  # the stamp of the step
        check_headers(tunnel.received, MODULE.outputs["sim/forces_and_moments"])
        assert len(tunnel.received) == 100  # one wrench for one message of pulses
        tunnel.fly(15.0, 0.02)
        # A positive pulse on the aileron rolls right; both halves of the tail together yaw, apart they pitch.
        assert tunnel.settle(aileron=0.2).torque.x > 1.0 > -1.0 > tunnel.settle(aileron=-0.2).torque.x
        assert tunnel.settle(left=0.2, right=-0.2).torque.y - tunnel.settle(left=-0.2, right=0.2).torque.y > 2.0
        assert tunnel.settle(left=0.2, right=0.2).torque.z < 0.0 < tunnel.settle(left=-0.2, right=-0.2).torque.z


# Steady level flight of ROSflight 2.x's Anaconda at 9.81 m/s^2: airspeed, angle of attack, elevator, throttle.
@pytest.mark.parametrize("speed, alpha_deg, elevator_deg, throttle", [
    (12, 4.36, -4.27, 0.422), (15, 0.77, 5.68, 0.506), (20, -2.04, 13.47, 0.664)])
def test_level_flight_of_the_reference(peer, speed, alpha_deg, elevator_deg, throttle):
    with forces(**REFERENCE):
        tunnel = Tunnel(peer)
        alpha = math.radians(alpha_deg)
        tunnel.fly(speed, alpha)
        half = elevator_deg / 2 / 40  # each half of the tail gives half of it; 40 degrees at full travel
        w = tunnel.settle(left=-half, right=half, throttle=throttle)
        # Forces balance gravity, the pitch moment is none; pulses of 1 us are 0.08 degrees and 0.05 N of thrust.
        assert w.force.x == pytest.approx(MASS * GRAVITY * math.sin(alpha), abs=0.15)
        assert w.force.z == pytest.approx(-MASS * GRAVITY * math.cos(alpha), rel=0.01)
        assert w.torque.y == pytest.approx(0.0, abs=0.05)


def test_parameters_change_live_and_nonsense_is_refused(peer):
    with forces():
        tunnel = Tunnel(peer)
        tunnel.fly(15.0, 0.0)
        before = tunnel.settle().force.z
        assert set_parameters(peer, NODE, C_L_O=1.012)[0].successful  # twice the lift without an angle of attack
        assert tunnel.settle().force.z == pytest.approx(2 * before, rel=0.02)
        assert set_parameters(peer, NODE, C_ell_O=0.01)[0].successful
        assert tunnel.settle().torque.x > 0.5
        refused = set_parameters(peer, NODE, wing_s=-1.0)[0]
        assert not refused.successful and refused.reason
        refused = set_parameters(peer, NODE, servo_tau=0.001)[0]  # in range, but steps are too long for it
        assert not refused.successful and "time_constant_s" in refused.reason
        assert tunnel.settle().force.z == pytest.approx(2 * before, rel=0.02)


class Hands:
    """A pilot of a few lines: wings level, nose on an angle, throttle by airspeed, from the truth."""

    def __init__(self, peer):
        self.peer, self.turn = peer, 0
        self.commands = peer.publisher(Command, "command")
        self.flown = []
        peer.node.create_subscription(SimState, "sim/truth_state", self.look, 10)

    def look(self, truth):
        q, v = truth.pose.orientation, truth.twist.linear
        roll = math.atan2(2 * (q.w * q.x + q.y * q.z), 1 - 2 * (q.x * q.x + q.y * q.y))
        pitch = math.asin(max(-1.0, min(1.0, 2 * (q.w * q.y - q.x * q.z))))
        speed = math.hypot(v.x, v.y, v.z)
        with self.peer.changed:
            self.flown.append((stamp_ns(truth) * 1e-9, -truth.pose.position.z, speed, roll))
            self.peer.changed.notify_all()
        self.turn += 1
        if self.turn % 8:
            return
        command = Command(header=truth.header, mode=Command.MODE_PASS_THROUGH)
        wanted = 0.1 if speed > 11.5 else 0.0
        command.u[0] = max(0.0, min(1.0, 0.6 + 0.2 * (16.0 - speed)))
        command.u[3] = max(-1.0, min(1.0, -0.8 * roll - 0.1 * truth.twist.angular.x))
        command.u[4] = max(-1.0, min(1.0, -0.15 + 1.5 * (wanted - pitch) - 0.2 * truth.twist.angular.y))
        self.commands.publish(command)


def test_a_fixed_wing_flies_in_the_launched_simulator(tmp_path):
    ports = {"simulation_port": free_udp_port(), "ROS_port": free_udp_port()}
    with SimPeer("pilot") as peer, launch("rosflight_sim", "fixedwing_standalone.launch.xml", use_sim_time="true", viz="false",
                                          real_time_multiplier="10.0", wait_for="sim/RC command", memory_folder=tmp_path,
                                          **ports) as world:
        world.until("ready: ")
        with launch("rosflight_sim", "fixedwing_init_firmware.launch.py") as init:
            assert init.end() == 0, init.text() + world.text()
        status, hands = peer.listen(Status, "status"), Hands(peer)
        peer.wait(lambda: status and hands.flown, "the world")
        assert peer.call(Trigger, "toggle_arm").success

        def until(condition, what):
            peer.wait_simulated(condition, what, lambda: hands.flown[-1][0])
        until(lambda: status[-1].armed, "being armed")
        assert hands.flown[-1][2] < 1.0  # still held by the pilot's switch
        assert peer.call(Trigger, "toggle_override").success
        until(lambda: hands.flown[-1][1] > 30.0, "30 m of height")
        start = hands.flown[-1][0]
        until(lambda: hands.flown[-1][0] > start + 10.0, "10 s of flight")
        assert status[-1].armed and status[-1].offboard and not status[-1].failsafe
    aloft = [sample for sample in hands.flown if sample[0] > start]
    assert all(11.0 < speed < 22.0 for _, _, speed, _ in aloft)
    assert all(height > 25.0 for _, height, _, _ in aloft)
    assert all(abs(roll) < 0.5 for _, _, _, roll in aloft)


def test_limits_and_texts_are_those_of_the_vehicle_file(peer):
    """docs/vehicle-keys.md, made from the same rows, has the numbers below."""
    wanted = {"wing_s": (0.0, 1e4, "aero.wing.area_m2 of the vehicle file [m^2]"),
              "wing_epsilon": (0.0, 1.5, "aero.wing.oswald of the vehicle file: efficiency"),
              "wing_alpha0": (0.0, math.pi / 2, "aero.stall.angle_deg of the vehicle file [deg]"),
              "C_ell_p": (-1000.0, 1000.0, "aero.roll.p of the vehicle file: by p b/2V"),
              "D_prop": (0.0, 5.0, "rotors.propeller.diameter_m of the vehicle file [m]")}
    with forces():
        described = peer.call(DescribeParameters, f"{NODE}/describe_parameters", names=list(wanted)).descriptors
        found = {one.name: (one.floating_point_range[0].from_value, pytest.approx(one.floating_point_range[0].to_value),
                            one.description) for one in described}
        assert found == wanted
        refused = set_parameters(peer, NODE, wing_s=0.0)[0]  # the range of ROS has no open end
        assert not refused.successful and "area_m2" in refused.reason
