# SPDX-License-Identifier: BSD-3-Clause
"""Each module by itself, fed message by message by an rclpy peer: the contract of sim_contract.py, and that what comes out
is physics. The forces and moments are checked twice: ours, and a node in Python."""

import math
import sys
import time
from pathlib import Path

import pytest
from body_rig import START_NS, TICK_NS, Body
from sim_contract import MODULES, check_headers, check_module
from geometry_msgs.msg import Vector3Stamped, WrenchStamped
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from rosflight_msgs.msg import PwmOutput, SimState
from rosflight_msgs.srv import SetSimState
from sim_rig import ALL, LATCHED, VEHICLE, Process, SimPeer, node, parameter, set_parameters, sim_state, stamp, stamp_ns
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker

GRAVITY = 9.80665  # of vehicles/multirotor.yaml


# ---- forces and moments --------------------------------------------------------------------------


def ours(**more):
    return node("multirotor_forces_and_moments", at_launch="multirotor_forces_and_moments", vehicle_file=VEHICLE, **more)


def python(**_):
    process = Process(sys.executable, Path(__file__).with_name("python_forces.py"))
    process.until("ready")
    return process


class Wrenches:
    """Pulses in, wrenches out, one for one."""

    def __init__(self, peer):
        self.peer, self.ns = peer, START_NS
        self.received = peer.listen(WrenchStamped, "sim/forces_and_moments")
        self.pulses = peer.publisher(PwmOutput, "sim/pwm_output")
        self.truth = peer.publisher(SimState, "sim/truth_state")
        peer.introduce(lambda: self._send([1000] * 4), self.received, "sim/pwm_output")

    def _send(self, pulses):
        self.ns += TICK_NS
        self.pulses.publish(stamp(PwmOutput(values=[*pulses, *[1000] * 10]), self.ns))

    def step(self, *pulses):
        count = len(self.received)
        self._send(pulses)
        self.peer.wait(lambda: len(self.received) > count, "a wrench")
        return self.received[-1]

    def settle(self, *pulses):
        """After 1.25 s: rotors have their speed."""
        for _ in range(500):
            last = self.step(*pulses)
        return last.wrench


@pytest.mark.parametrize("make", [ours, python])
def test_forces(peer, make):
    with make():
        check_module(peer, "forces")
        world = Wrenches(peer)
        for _ in range(100):
            assert stamp_ns(world.step(1000, 1000, 1000, 1000)) == world.ns  # the stamp of the step
        check_headers(world.received, MODULES["forces"].outputs["sim/forces_and_moments"])
        assert len(world.received) == 100  # one wrench for one message of pulses
        rest = world.settle(1000, 1000, 1000, 1000)
        assert abs(rest.force.z) < 0.05
        up = world.settle(1500, 1500, 1500, 1500)
        assert up.force.z < -10 and abs(up.torque.x) < 1e-6 and abs(up.torque.y) < 1e-6
        # rotors: front right, rear right, rear left, front left; 0 and 2 turn so that their drag turns the nose right
        assert world.settle(1400, 1400, 1600, 1600).torque.x > 0.5  # left side up: right wing down
        assert world.settle(1600, 1400, 1400, 1600).torque.y > 0.5  # front up: nose up
        assert world.settle(1600, 1400, 1600, 1400).torque.z > 0.05  # nose right
        falling = sim_state(world.ns)
        falling.twist.linear.x = 10.0
        world.truth.publish(falling)
        peer.poll(lambda: world.step(1000, 1000, 1000, 1000).wrench.force.x < -0.5, "drag at 10 m/s")


# Static thrust of one rotor of ROSflight 2.x's multirotor, with its parameters under its names.
@pytest.mark.parametrize("throttle, thrust_N", [(0.3, 3.3831), (0.5, 9.3057), (0.7, 17.9953)])
def test_forces_have_the_thrust_of_the_reference(peer, throttle, thrust_N):
    reference = {"rho": 1.225, "V_max": 24.0, "D_prop": 0.381, "CT_0": 0.08729101, "CQ_0": 0.00428594, "R_motor": 0.042,
                 "I_0": 1.5, "KQ": 0.028937, "num_rotors": 4, "rotor_dists": "[0.25, 0.25, 0.25, 0.25]"}
    with ours(vehicle_overrides='["aero.ground_effect=none", "rotors.motor.current_limit_A=1000"]', **reference):
        world = Wrenches(peer)
        pulse = round(1000 + 1000 * throttle)
        assert world.settle(pulse, pulse, pulse, pulse).force.z == pytest.approx(-4 * thrust_N, rel=1e-3)
        if throttle == 0.5:
            assert set_parameters(peer, "multirotor_forces_and_moments", rho=2.45)[0].successful  # live
            assert world.settle(pulse, pulse, pulse, pulse).force.z < -1.3 * 4 * thrust_N
            assert not set_parameters(peer, "multirotor_forces_and_moments", CT_0=-0.5)[0].successful
            assert not set_parameters(peer, "multirotor_forces_and_moments", rho=-1.0)[0].successful
            nan = set_parameters(peer, "multirotor_forces_and_moments", rho=math.nan)[0]
            assert not nan.successful and nan.reason == "parameter rho: found nan or infinity, allowed a finite number"
            # What was refused is forgotten.
            assert set_parameters(peer, "multirotor_forces_and_moments", rho=1.225)[0].successful
            assert world.settle(pulse, pulse, pulse, pulse).force.z == pytest.approx(-4 * thrust_N, rel=1e-3)


def test_forces_refuse_a_truth_that_is_none(peer):
    with ours() as forces:
        world = Wrenches(peer)
        bad = sim_state(world.ns)
        bad.twist.linear.x = math.nan
        peer.poll(lambda: world.truth.publish(bad) or "not finite" in forces.text(), "a warning")
        assert math.isfinite(world.step(1500, 1500, 1500, 1500).wrench.force.x)


# ---- dynamics ------------------------------------------------------------------------------------


@pytest.fixture
def body(peer):
    with node("standalone_dynamics", at_launch="standalone_dynamics", vehicle_file=VEHICLE) as process:
        body = Body(peer)
        body.process = process
        yield body


def test_dynamics(peer, body):
    check_module(peer, "dynamics")
    outputs = MODULES["dynamics"].outputs
    for _ in range(100):
        assert stamp_ns(body.step()) == body.ns  # the stamp of the wrench
    check_headers(body.truth, outputs["sim/truth_state"])
    check_headers(body.wind, outputs["sim/truth_wind"])
    at_rest = body.step()
    assert at_rest.pose.orientation.w == pytest.approx(1, abs=1e-6)
    assert math.hypot(at_rest.twist.linear.x, at_rest.twist.linear.z) < 1e-3


def test_a_body_falls_and_turns_as_newton_says(body):
    assert body.put(sim_state(0, z=-100.0)).success
    first = body.step().pose.position.z
    for _ in range(400):
        last = body.step(roll_Nm=0.08)  # inertia 0.08 kg m^2: 1 rad/s^2
    assert last.twist.angular.x == pytest.approx(1.0, abs=1e-6)
    assert last.acceleration.linear.z == pytest.approx(GRAVITY * math.cos(0.5), rel=1e-5)  # body axes, rolled 0.5 rad
    assert last.acceleration.linear.y == pytest.approx(GRAVITY * math.sin(0.5), rel=1e-5)
    # s = v0 t + g t^2/2 with v0 = g T after the first step
    assert last.pose.position.z - first == pytest.approx(GRAVITY * (0.0025 + 0.5), rel=1e-6)


def test_a_hovering_body_stays(body):
    assert body.put(sim_state(0, z=-10.0)).success
    for _ in range(100):
        last = body.step(up_N=3.5 * GRAVITY)
    assert last.pose.position.z == pytest.approx(-10.0, abs=1e-9)


def test_mass_and_wind_change_live_and_nonsense_is_refused(peer, body):
    def put(name, value):
        return set_parameters(peer, "standalone_dynamics", **{name: value})[0]
    assert body.put(sim_state(0, z=-100.0)).success
    assert put("mass", 7.0).successful
    body.step()
    start = body.step().twist.linear.z
    for _ in range(40):
        last = body.step(up_N=3.5 * GRAVITY)  # half of what would carry it
    assert last.twist.linear.z - start == pytest.approx(0.5 * GRAVITY * 0.1, rel=1e-6)
    refused = put("Jxx", 5.0)  # more than the other two moments together
    assert not refused.successful and "inertia" in refused.reason
    assert not put("mass", -1.0).successful
    assert parameter(peer, "standalone_dynamics", "mass").double_value == 7.0

    def wind(**values):
        kinds = {bool: "bool_value", list: "double_array_value"}
        types = {bool: ParameterType.PARAMETER_BOOL, list: ParameterType.PARAMETER_DOUBLE_ARRAY}
        new = [Parameter(name=name, value=ParameterValue(type=types[type(value)], **{kinds[type(value)]: value}))
               for name, value in values.items()]
        return peer.call(SetParameters, "standalone_dynamics/set_parameters", parameters=new).results
    assert all(r.successful for r in wind(steady_state_wind=[3.0, -2.0, 0.0], use_random_wind=False, sim_has_wind=True))
    body.wind.clear()
    body.step()
    peer.wait(lambda: body.wind and (body.wind[-1].vector.x, body.wind[-1].vector.y) == (3.0, -2.0), "the wind")
    assert all(r.successful for r in wind(use_random_wind=True, random_wind_mean=[9.0, 0.0, 0.0]))
    body.step()
    peer.wait(lambda: 5.0 < body.wind[-1].vector.x < 13.0 and body.wind[-1].vector.x != 9.0, "a drawn wind")
    assert all(r.successful for r in wind(sim_has_wind=False, wind_has_gusts=True))
    body.step()
    peer.wait(lambda: abs(body.wind[-1].vector.x) < 1.0, "gusts at most")


@pytest.mark.parametrize("turbulence_m_s, winds", [(0, 10), (5, 100)])
def test_the_wind_is_sent_each_time_while_it_changes_and_each_tenth_time_while_it_stands(peer, turbulence_m_s, winds):
    with node("standalone_dynamics", vehicle_file=VEHICLE,
              vehicle_overrides=f'["environment.wind.turbulence_w20_m_s={turbulence_m_s}"]'):
        body = Body(peer)
        assert body.put(sim_state(0, z=-100.0)).success
        body.step(), body.step()
        body.wind.clear()
        last_ns = [stamp_ns(body.step()) for _ in range(100)][-1]
        peer.wait(lambda: body.wind and stamp_ns(body.wind[-1]) > last_ns - 10 * TICK_NS, "the last wind")
        check_headers(body.wind, MODULES["dynamics"].outputs["sim/truth_wind"])
        assert abs(len(body.wind) - winds) <= 1


def test_states_that_cannot_be_are_refused_and_zeros_mean_the_start(body):
    bad = sim_state(0, z=-10.0)
    bad.twist.linear.x = math.nan
    answer = body.put(bad)
    assert not answer.success and "NaN" in answer.message
    no_rotation = sim_state(0, z=-10.0)
    no_rotation.pose.orientation.w = 0.0
    assert not body.put(no_rotation).success
    assert not body.put(sim_state(0, z=3.0)).success  # under ground
    start = body.step().pose.position.z
    assert body.put(sim_state(0, z=-10.0)).success
    assert body.step().pose.position.z == pytest.approx(-10.0, abs=0.01)
    assert body.put(sim_state(0)).success
    assert body.step().pose.position.z == pytest.approx(start, abs=0.01)
    assert body.put(sim_state(0, z=-10.0)).success
    assert body.peer.call(Trigger, "dynamics/reset").success
    assert body.step().pose.position.z == pytest.approx(start, abs=0.01)


def test_wrenches_that_are_none_are_refused_and_a_gap_is_bounded(peer, body):
    assert body.put(sim_state(0, z=-100.0)).success
    before = body.step()
    bad = stamp(WrenchStamped(), body.ns + 1)
    bad.wrench.force.x = math.inf
    body.wrench.publish(bad)
    peer.poll(lambda: "not finite" in body.process.text(), "a warning")
    body.ns += 10_000_000_000
    assert body.step().pose.position.z - before.pose.position.z < 0.1  # not 490 m
    assert "10.0" in body.process.until("between two wrenches")
    for _ in range(3):  # reported together, five seconds after the first
        body.ns += 1_000_000_000
        body.step()
    assert body.process.text().count("between two wrenches") == 1


# ---- sensors -------------------------------------------------------------------------------------


class Instruments:
    def __init__(self, peer, **more):
        self.peer, self.ns = peer, START_NS
        self.truth = peer.publisher(SimState, "sim/truth_state")
        self.received = {topic: peer.listen(out.kind, topic) for topic, out in MODULES["sensors"].outputs.items()}
        self.imu = self.received["sim/sensors/imu/data"]
        peer.introduce(self._send, self.imu, "sim/truth_state")
        for received in self.received.values():
            received.clear()

    def _send(self, z=0.0):
        self.ns += TICK_NS
        message = sim_state(self.ns, z)
        self.truth.publish(message)

    def step(self, z=0.0):
        count = len(self.imu)
        self._send(z)
        self.peer.wait(lambda: len(self.imu) > count, "a sample")

    def mean(self, topic, value):
        return sum(value(message) for message in self.received[topic]) / len(self.received[topic])


def test_sensors(peer):
    with node("standalone_sensors", at_launch="standalone_sensors", vehicle_file=VEHICLE,
              vehicle_overrides='["sensors={preset: ideal}"]'):
        check_module(peer, "sensors")
        world = Instruments(peer)
        for _ in range(40):  # the instruments begin one after the other, the last after 50 ms
            world.step()
        for received in world.received.values():
            received.clear()
        seconds = 2
        for _ in range(400 * seconds):
            world.step()
        for topic, out in MODULES["sensors"].outputs.items():
            rate_Hz = parameter(peer, "standalone_sensors", out.rate_Hz).double_value / out.every
            assert rate_Hz > 0
            peer.poll(lambda h=world.received[topic], r=rate_Hz: abs(len(h) - r * seconds) <= 1, f"{rate_Hz} Hz of {topic}")
            stamps = check_headers(world.received[topic], out)
            assert world.ns - stamps[-1] <= 1e9 / rate_Hz  # the time of the truth that was measured
        # Without errors: gravity, the field of Provo, and the standard atmosphere at 1387 m.
        assert world.mean("sim/sensors/imu/data", lambda m: m.linear_acceleration.z) == pytest.approx(-GRAVITY, abs=1e-3)
        field_nT = [1e9 * world.mean("sim/sensors/mag", lambda m, a=a: getattr(m.magnetic_field, a)) for a in "xyz"]
        assert field_nT == pytest.approx([20840, 3917, 46071], abs=700)  # model years differ by some hundred nT
        assert world.mean("sim/sensors/baro", lambda m: m.pressure) == pytest.approx(85729, abs=30)
        assert world.mean("sim/sensors/gnss", lambda m: m.lat) == pytest.approx(40.2463724, abs=1e-5)
        assert world.mean("sim/sensors/gnss", lambda m: m.lon) == pytest.approx(-111.6474138, abs=1e-5)


# ROSflight 2.x's rates [Hz], and those that the vehicle file leaves to sim/sensors.
ROSFLIGHT_2_HZ = {"imu": 400, "mag": 50, "baro": 100, "gnss": 10, "range": 20, "diff_pressure": 100, "battery": 200}
VEHICLE_HZ = ROSFLIGHT_2_HZ | {"mag": 100, "baro": 50, "battery": 10}


@pytest.mark.parametrize("given, rates", [
    ({}, ROSFLIGHT_2_HZ),
    ({"sensor_rates": "vehicle"}, VEHICLE_HZ),
    ({"vehicle_overrides": '["sensors.baro.rate_Hz=25"]'}, ROSFLIGHT_2_HZ | {"baro": 25}),
    ({"mag_update_frequency": 40.0}, ROSFLIGHT_2_HZ | {"mag": 40})])
def test_sensor_rates_are_those_of_rosflight_2_unless_the_vehicle_file_or_a_parameter_says_otherwise(peer, given, rates):
    with node("standalone_sensors", at_launch="standalone_sensors", vehicle_file=VEHICLE, **given):
        found = {name: parameter(peer, "standalone_sensors", f"{name}_update_frequency").double_value for name in rates}
    assert found == rates


def test_sensor_readings_follow_their_parameters_live(peer):
    with node("standalone_sensors", at_launch="standalone_sensors", vehicle_file=VEHICLE, gyro_stdev=0.5):
        world = Instruments(peer)
        for _ in range(400):
            world.step()

        def spread():
            rates = [m.angular_velocity.x for m in world.imu]
            mean = sum(rates) / len(rates)
            return math.sqrt(sum((rate - mean)**2 for rate in rates) / len(rates))
        assert spread() == pytest.approx(0.5, rel=0.2)
        assert set_parameters(peer, "standalone_sensors", gyro_stdev=0.01)[0].successful
        assert set_parameters(peer, "standalone_sensors", baro_update_frequency=20.0)[0].successful
        assert not set_parameters(peer, "standalone_sensors", baro_update_frequency=-1.0)[0].successful
        for received in world.received.values():
            received.clear()
        for _ in range(400):
            world.step()
        assert spread() == pytest.approx(0.01, rel=0.3)
        assert len(world.received["sim/sensors/baro"]) == pytest.approx(20, abs=2)


# ---- display -------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind, topic", [(TFMessage, "/tf"), (Marker, "rviz/mesh"), (Marker, "rviz/mesh_path")])
def test_the_display_subscribes_to_the_truth_while_somebody_reads_it(peer, kind, topic):
    truth = peer.publisher(SimState, "sim/truth_state")
    with node("standalone_viz_transcriber"):
        peer.poll(lambda: peer.node.count_publishers(topic) == 1, "the node's topic")
        peer.poll(lambda: truth.get_subscription_count() == 0, "no subscription")
        with peer.reads(kind, topic):
            peer.poll(lambda: truth.get_subscription_count() == 1, "the subscription")
        peer.poll(lambda: truth.get_subscription_count() == 0, "its end")


@pytest.mark.parametrize("namespace, prefix", [(None, ""), ("/air", "air/")])
def test_display(namespace, prefix):
    with SimPeer("peer", namespace) as peer, node("standalone_viz_transcriber", namespace=namespace,
                                                  path_publish_modulo=4):
        check_module(peer, "viz") if namespace is None else None
        fixed, moving = peer.listen(TFMessage, "/tf_static", LATCHED), peer.listen(TFMessage, "/tf")
        mesh, path = peer.listen(Marker, "rviz/mesh"), peer.listen(Marker, "rviz/mesh_path")
        truth = peer.publisher(SimState, "sim/truth_state", ALL)
        ns = START_NS

        def send():
            nonlocal ns
            ns += TICK_NS
            truth.publish(sim_state(ns, z=-5.0))
        peer.introduce(send, moving, "sim/truth_state")
        peer.wait(lambda: fixed, "fixed frames")
        peer.poll(lambda: [send() for _ in range(4)] and (len(moving) >= 5 and len(mesh) >= 2 and len(path) >= 2), "display")
        transform = moving[-1].transforms[0]
        assert (transform.header.frame_id, transform.child_frame_id) == (prefix + "NED", prefix + "aircraft_body")
        assert transform.transform.translation.z == -5.0
        edges = {(t.header.frame_id, t.child_frame_id) for t in fixed[0].transforms}
        assert edges == {(prefix + a, prefix + b) for a, b in (
            ("map", "odom"), ("odom", "world"), ("world", "NED"), ("aircraft_body", "base_link"),
            ("aircraft_body", "stl_frame"))} | ({("map", prefix + "map")} if prefix else set())
        assert mesh[-1].header.frame_id == prefix + "stl_frame" and mesh[-1].mesh_resource.startswith("package://")
        assert path[-1].header.frame_id == prefix + "NED" and path[-1].points[-1].z == -5.0
        assert stamp_ns(transform) in range(START_NS, ns + 1)
