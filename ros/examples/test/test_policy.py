# SPDX-License-Identifier: BSD-3-Clause
"""A network flies in pass-through at 400 Hz; the filter between it and the I/O node changes its commands, which is seen where they
arrive, and the vehicle flies on, or falls. The network's weights against the controller that it was taught by."""

import contextlib
import math
import os
import subprocess
import sys

import numpy
import pytest
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from ros_demo_rate import held
from ros_rig import ROOT, free_udp_port
from rosflight_msgs.msg import Command, PwmOutput, SimState, Status
from sim_rig import Process, SimPeer, executable, last_s, launch, set_parameters, stamp, stamp_ns
from std_srvs.srv import Trigger

sys.path.insert(0, str(ROOT / "ros/examples/scripts"))
import train_policy  # noqa: E402

POSITIONS = [(0, 0, -2), (2, 0, -2), (2, 2, -2.5), (0, 0, -2)]
QUAD_X = numpy.array([[-1, -1, -1, -1], [-0.353557, -0.353557, 0.353557, 0.353557], [0.353557, -0.353557, -0.353557, 0.353557],
                      [0.25, -0.25, 0.25, -0.25]])  # docs/predefined-mixers.md, rows Fz, roll, pitch, yaw


def test_the_network_has_learnt_what_its_teacher_does():
    states = numpy.random.default_rng(99).uniform(-1, 1, (4000, 13)) * train_policy.REACH
    made, wanted = train_policy.train(), train_policy.teacher(states)
    error = numpy.sqrt(((train_policy.network(made, states) - wanted) ** 2).mean(axis=0)) / wanted.std(axis=0)
    assert (error < 0.15).all(), f"of the teacher's spread, on states it was not shown: {error}"


@pytest.mark.parametrize("script", ["policy", "command_filter"])
def test_a_node_with_small_matrices_computes_in_one_thread(script):
    """Threads of numpy's linear algebra waited busily for each other: three times the processor time, and a slower flight."""
    code = f"import os, {script}; print(len(os.listdir('/proc/self/task')))"

    def threads(**more):
        variables = {name: value for name, value in os.environ.items() if name != "OPENBLAS_NUM_THREADS"} | more
        return int(subprocess.check_output([sys.executable, "-c", code], cwd=ROOT / "ros/examples/scripts", env=variables))
    assert threads() == threads(OPENBLAS_NUM_THREADS="1")


STEP_NS = 2_500_000
WITHOUT = "no /command for "  # begin of the line with which time goes on without commands: their nodes had no processor for 2 s


class Seen:
    """A flight of the policy through the filter, and what an observer sees of it."""

    def __init__(self, folder):
        self.peer = SimPeer("judge")
        self.process = launch("rosflight_examples", "policy.launch.xml", filter="true", viz="false", real_time_multiplier="4.0",
                              wait_for="sim/RC command judge", memory_folder=folder, simulation_port=free_udp_port(), ROS_port=free_udp_port())
        self.truth = self.peer.listen(SimState, "sim/truth_state", progress="judge")
        self.status = self.peer.listen(Status, "status")
        self.wanted = self.peer.listen(Command, "command_in")
        self.sent = self.peer.listen(Command, "command")
        self.pulses = self.peer.listen(PwmOutput, "sim/pwm_output")

    def until(self, condition, what):
        try:
            self.peer.wait_simulated(condition, what, lambda: last_s(self.truth))
        except AssertionError as why:
            raise AssertionError(f"{why}\n{self.process.text()[-4000:]}") from None

    def fly_on(self, seconds):
        """That much simulated time."""
        end = stamp_ns(self.truth[-1]) + int(seconds * 1e9)
        self.until(lambda: stamp_ns(self.truth[-1]) >= end, f"{seconds} s of flight")

    def toggle_pause(self):
        answer = self.peer.call(Trigger, "time_manager/toggle_pause")
        assert answer.success, answer.message

    @contextlib.contextmanager
    def paused(self):
        """The world stands still: a service call takes as long as the machine needs."""
        self.toggle_pause()
        yield
        self.toggle_pause()

    def set_filter(self, bias=None, **values):
        results = set_parameters(self.peer, "command_filter", **values) if values else []
        if bias:
            value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE_ARRAY, double_array_value=bias)
            results += self.peer.call(SetParameters, "command_filter/set_parameters", parameters=[Parameter(name="bias", value=value)]).results
        assert all(result.successful for result in results), results

    def position(self, message=None):
        p = (message or self.truth[-1]).pose.position
        return p.x, p.y, p.z

    def pairs(self):
        """What was wanted and what was sent, by stamp."""
        wanted = {stamp_ns(m): numpy.array(m.u) for m in list(self.wanted)}
        return [(wanted[key], numpy.array(m.u)) for m in list(self.sent) if (key := stamp_ns(m)) in wanted]


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    seen = Seen(tmp_path_factory.mktemp("memory"))
    try:
        seen.until(lambda: "\nready: " in seen.process.text(), "arming by itself")
        seen.until(lambda: seen.sent and seen.sent[-1].u[2] < -0.1, "the start of the motors")
        yield seen
    finally:
        seen.process.stop()
        seen.peer.close()


def test_the_policy_flies_its_positions_in_pass_through_at_400_Hz(flight):
    flight.fly_on(17.0)
    for position in POSITIONS:
        near = min(math.dist(position, flight.position(m)) for m in list(flight.truth))
        assert near < 0.35, f"{near:.2f} m from {position}"
    assert math.dist(flight.position(), POSITIONS[-1]) < 0.5, "it stays at the last"
    flying = [m for m in list(flight.sent) if m.u[2] < -0.1]
    assert all(m.mode == Command.MODE_PASS_THROUGH for m in flying)
    times = [stamp_ns(m) for m in flying]
    rate = (len(times) - 1) / ((times[-1] - times[0]) * 1e-9)
    gaps = [(round((b - times[0]) * 1e-9, 3), round((b - a) * 1e-9, 4)) for a, b in zip(times, times[1:]) if b - a > STEP_NS]
    without = [line for line in flight.process.text().splitlines() if WITHOUT in line]
    assert rate < 401.0 and (held(rate, 400.0) or without), f"{rate} Hz, gaps {gaps[:20]}"
    assert all((wanted == sent).all() for wanted, sent in flight.pairs()[-1000:]), "nothing set: nothing changed"
    assert flight.status[-1].control_mode == 0 and not any(s.failsafe for s in flight.status)


@pytest.fixture
def filtered(flight):
    """The flight, its filter as it was afterwards, and the vehicle back at its last position."""
    yield flight
    with flight.paused():
        flight.set_filter(bias=[0.0] * 10, delay_s=0.0, replay_s=0.0, dead_motor=-1)
    if flight.position()[2] < -0.5:  # it has not fallen
        flight.fly_on(4.0)


def test_a_bias_and_a_delay_are_flown_with(filtered):
    flight = filtered
    flight.until(lambda: "the mixer is known" in flight.process.text(), "the mixer")
    with flight.paused():
        flight.set_filter(bias=[0.0] * 3 + [0.05] + [0.0] * 6, delay_s=0.02)
    flight.fly_on(4.0)
    wanted = {stamp_ns(m): numpy.array(m.u) for m in list(flight.wanted)}
    late = [(wanted.get(stamp_ns(m) - 20_000_000), numpy.array(m.u)) for m in list(flight.sent)[-400:]]
    late = [(before, now) for before, now in late if before is not None]
    assert len(late) > 300
    for before, now in late:
        assert now == pytest.approx(before + [0, 0, 0, 0.05, 0, 0, 0, 0, 0, 0], abs=1e-6)
    east = flight.position()[1]
    assert 0.02 < east < 1.0, "a torque to the right that the network does not know of: it stands to the right, and stands"
    assert abs(flight.position()[2] + 2.0) < 0.5


def test_recorded_commands_are_played_again(filtered):
    flight = filtered
    with flight.paused():
        flight.set_filter(replay_s=0.5)
        begin = len(flight.sent)
    flight.fly_on(1.1)
    with flight.paused():
        flight.set_filter(replay_s=0.0)
        sent = [tuple(m.u) for m in list(flight.sent)[begin:]][20:420]
        wanted = list(flight.wanted)
    assert len(sent) == 400 and sent[:200] == sent[200:], "half a second again and again"
    assert len(set(sent)) > 50
    assert any(tuple(m.u) not in set(sent) for m in wanted[-200:]), "while the policy goes on"
    flight.fly_on(5.0)
    assert math.dist(flight.position(), POSITIONS[-1]) < 0.6, "it has caught itself"


def test_a_dead_motor_stands_still_and_the_quadrotor_falls(filtered):
    flight = filtered
    with flight.paused():
        flight.set_filter(dead_motor=0)
        begin = len(flight.pulses)
    flight.until(lambda: flight.position()[2] > -0.5, "the fall")
    idle = 1100  # MOTOR_IDLE_THR
    pulses = [m.values for m in list(flight.pulses)[begin:]]
    pulses = pulses[next(k for k, values in enumerate(pulses) if values[0] <= idle):]
    assert len(pulses) > 100, "more than a quarter of a second of the fall"
    assert all(values[0] <= idle for values in pulses) and any(min(values[1:4]) < max(values[1:4]) > 1200 for values in pulses)
    wanted, sent = flight.pairs()[-1]
    outputs = QUAD_X.T @ wanted[2:6]
    outputs[0] = 0.0
    assert QUAD_X.T @ sent[2:6] == pytest.approx(outputs, abs=1e-4), "the three others as the policy wants them"


@pytest.fixture
def filter_alone():
    """Its peer. In a namespace: the filter of the flight may still run."""
    words = ("--ros-args", "-r", "__ns:=/alone")
    with Process(executable("rosflight_examples", "command_filter.py"), *words) as process, SimPeer(namespace="/alone") as peer:
        process.until("ready")
        yield peer


@pytest.mark.parametrize("name, value, said", [
    ("delay_s", 20.0, "parameter delay_s: found 20.0, allowed 0 to 10 s"),
    ("replay_s", -1.0, "parameter replay_s: found -1.0, allowed 0 to 10 s"),
    ("dead_motor", 4, "parameter dead_motor: found 4, allowed -1 to 3"),
    ("dead_motor", 1, "parameter dead_motor: the mixer of the flight controller is not known yet")])
def test_a_wrong_fault_is_refused_in_one_line(filter_alone, name, value, said):
    result = set_parameters(filter_alone, "command_filter", **{name: value})[0]
    assert not result.successful and result.reason == said


def test_a_filter_passes_commands_of_all_modes_on_under_their_stamps(filter_alone):
    peer = filter_alone
    sent, inputs = peer.listen(Command, "command"), peer.publisher(Command, "command_in")
    message = stamp(Command(mode=2, ignore=0x38, u=[0.0, 0.0, 0.5, 0.1] + [0.0] * 6), 123_000_000)
    peer.introduce(lambda: inputs.publish(message), sent, "command")
    inputs.publish(message)
    peer.wait(lambda: sent, "the command")
    assert sent[-1] == message


def test_a_delay_is_a_whole_number_of_commands(filter_alone):
    """40.0175 s - 0.02 s is less than 39.9975 s in floating-point numbers: one command in six was a tick older than the others."""
    peer, period_ns = filter_alone, 2_500_000
    sent, inputs = peer.listen(Command, "command"), peer.publisher(Command, "command_in")
    peer.introduce(lambda: inputs.publish(stamp(Command(), 39_000_000_000)), sent, "command")
    assert set_parameters(peer, "command_filter", delay_s=0.02)[0].successful
    begin = len(sent)
    for number in range(100):
        inputs.publish(stamp(Command(u=[float(number)] + [0.0] * 9), 40_000_000_000 + number * period_ns))
        peer.wait(lambda: len(sent) > begin + number, f"command {number}")
    assert [m.u[0] for m in sent[begin + 8:]] == list(range(92))
