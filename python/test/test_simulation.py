# SPDX-License-Identifier: BSD-3-Clause
"""rosflight.Simulation: the firmware answers commands as its interface says, and a moment can be returned to."""

import subprocess
import sys
import textwrap
import threading

import numpy as np
import pytest
import rosflight
from rosflight import Simulation


def state(simulation):
    """Everything that is shown, as one row."""
    seen = [simulation._core.truth, simulation._core.estimate, simulation.outputs, [simulation.time_s, simulation.armed]]
    return np.concatenate([np.array(part, dtype=float) for part in seen])


def hover(simulation, seconds=3.0, altitude_m=5.0):
    """Puts it into the air and keeps it level; the throttle that carries it holds its climb rate near zero."""
    simulation.place([0, 0, -altitude_m])
    simulation.angles(0, 0, 0, simulation.hover_throttle)
    simulation.run(seconds)


@pytest.fixture(scope="module")
def started():
    simulation = Simulation(seed=5)
    return simulation, simulation.snapshot()


@pytest.fixture
def simulation(started):
    started[0].restore(started[1])
    return started[0]


def test_it_begins_armed_on_the_ground(simulation):
    assert simulation.armed and simulation.on_ground and not simulation.failsafe
    assert simulation.time_s > 1 and abs(simulation.truth.position_m[2]) < 0.5
    assert np.linalg.norm(simulation.estimate.position_m) < 1


def test_without_a_start_it_is_just_powered_up():
    simulation = Simulation(start=False)
    assert simulation.time_s == 0 and not simulation.armed
    simulation.run(2.0)
    assert simulation.time_s == 2.0 and len(simulation.parameters) > 100  # the companion has read the table
    simulation.start()
    assert simulation.armed


def test_body_rates_are_followed(simulation):
    hover(simulation, 1.0)
    simulation.rates(0.6, -0.4, 0, simulation.hover_throttle)
    simulation.run(0.3)
    # The loop is proportional: the damping of the rotors holds it a fifth short.
    share = simulation.truth.rates_rad_s[:2] / [0.6, -0.4]
    assert (share > 0.7).all() and (share < 1.05).all() and abs(simulation.truth.rates_rad_s[2]) < 0.05


def test_angles_are_held(simulation):
    hover(simulation, 1.0, altitude_m=50)
    simulation.angles(0.2, 0, 0, simulation.hover_throttle)
    simulation.run(0.5)  # the loop has 10 rad/s; later its integral and the drag add to it
    w, x, y, z = simulation.truth.attitude
    assert np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)) == pytest.approx(0.2, abs=0.06)
    assert simulation.truth.velocity_m_s[1] > 0.3  # to the right


def test_pass_through_reaches_the_mixer(simulation):
    hover(simulation, 0.5, altitude_m=50)
    simulation.mixer([0, 0, -1e3, 0, 0, 0])  # more thrust than there is
    simulation.run(0.5)
    assert simulation.outputs[:4].min() > 0.9
    simulation.mixer([0, 0, 0, 0, 0, 0])
    simulation.run(0.5)
    assert simulation.outputs[:4].max() < 0.2


def test_commands_stop_with_release_and_the_pilot_flies(simulation):
    hover(simulation, 0.5, altitude_m=50)
    simulation.rc(throttle=1.0)
    simulation.release()
    simulation.run(1.0)
    assert simulation.truth.velocity_m_s[2] < -1  # climbs by the pilot's stick


def test_the_pilot_disarms(simulation):
    simulation.rc(arm=0.0)
    simulation.run(0.5)
    assert not simulation.armed and any("isarm" in note.text for note in simulation.texts())


def test_a_command_is_not_there_before_it_is_sent(simulation):
    """40 bytes take 0.4 ms at 921600 baud: the pass at the moment of the command flies the old one, the next pass the new one."""
    simulation.mixer([0, 0, -1e3, 0, 0, 0])
    simulation.step()
    assert simulation.outputs[:4].max() < 0.2
    simulation.step()
    assert simulation.outputs[:4].min() > 0.9


def test_parameters_are_written_over_the_link(simulation):
    before = simulation.time_s
    assert simulation.parameters["PID_ROLL_ANG_P"] > 0
    simulation.parameters["PID_ROLL_ANG_P"] = 1.25
    assert simulation.parameters["PID_ROLL_ANG_P"] == 1.25 and before < simulation.time_s < before + 0.5
    assert simulation.parameters["SYS_ID"] == 1 and isinstance(simulation.parameters["SYS_ID"], int)
    assert "PID_ROLL_ANG_P" in simulation.parameters and dict(simulation.parameters)["PID_ROLL_ANG_P"] == 1.25


@pytest.mark.parametrize("act, kind, said", [
    (lambda s: s.parameters.__setitem__("NO_SUCH", 1), ValueError, "NO_SUCH"),
    (lambda s: s.parameters.__setitem__("SYS_ID", float("nan")), ValueError, "parameters, SYS_ID: found nan"),
    (lambda s: s.parameters.__setitem__("SYS_ID", "one"), TypeError, "parameters, SYS_ID: found 'one', allowed a number"),
    (lambda s: s.parameters["NO_SUCH"], KeyError, "NO_SUCH"),
    (lambda s: s.rates(0, 0, float("nan"), 0.5), ValueError, "rates: found NaN"),
    (lambda s: s.mixer([0, 0, 1]), ValueError, "mixer: found shape (3,)"),
    (lambda s: s.mixer(np.zeros((6, 1))), ValueError, "mixer: found shape (6, 1)"),
    (lambda s: s.mixer(["a"] * 6), ValueError, "allowed 6 numbers"),
    (lambda s: s.surfaces(0, 0, 0, 1), ValueError, "surfaces: found a multirotor, allowed a fixed wing"),
    (lambda s: s.rc(rudder=0.5), ValueError, "rc: found rudder=0.5, allowed 0 to 1 for roll, pitch"),
    (lambda s: s.rc(throttle=1.5), ValueError, "rc: found throttle=1.5"),
    (lambda s: s.fault("motor9_dead@1"), ValueError, "motor 9, allowed 0 to 3"),
    (lambda s: s.step(-1), ValueError, "step: found -1, allowed 0 to"),
    (lambda s: s.step(1.5), TypeError, "step: found 1.5, allowed a whole number"),
    (lambda s: s.wind((90, 0)), ValueError, "wind: found '90,0'"),
    (lambda s: s.place([0, 0, 5]), ValueError, "set_state: found a state"),
    (lambda s: s.place([0, 0, float("inf")]), ValueError, "position_m: found NaN or infinity"),
    (lambda s: s.place([0, 0, -5], attitude=[0, 0, 0, 0]), ValueError, "no attitude"),
    (lambda s: s.restore("moment"), TypeError, "restore"),
])
def test_bad_input_is_one_line_and_changes_nothing(simulation, act, kind, said):
    simulation.run(0.1)
    before = state(simulation)
    with pytest.raises(kind) as raised:
        act(simulation)
    assert said in str(raised.value)
    if kind is not TypeError:
        assert "\n" not in str(raised.value)
    assert np.array_equal(before[:13], state(simulation)[:13]) or simulation.time_s > before[-2]


def test_equal_calls_give_equal_bits():
    rows = []
    for _ in range(2):
        simulation = Simulation(seed=11, wind=(3, 90, 3))
        hover(simulation, 2.0)
        rows.append(state(simulation))
    assert np.array_equal(*rows)


def manoeuvre(simulation):
    """Something of everything: commands, pilot, parameter, fault, gusts."""
    rows = []
    simulation.rates(0.3, -0.2, 0.4, simulation.hover_throttle)
    simulation.run(0.31)
    rows.append(state(simulation))
    simulation.parameters["PID_YAW_RATE_P"] = 0.3
    simulation.rc(roll=0.6)
    simulation.fault(f"motor1_partial=0.8@{simulation.time_s + 0.2}:0.5")
    simulation.fault(f"gnss@{simulation.time_s}:1")
    simulation.angles(0.1, 0, 0, simulation.hover_throttle)
    simulation.run(1.5)
    rows.append(state(simulation))
    return np.array(rows)


@pytest.mark.parametrize("link_protocol", ["mavlink", "lean"])
def test_a_moment_leads_to_the_same_bits_each_time(link_protocol):
    simulation = Simulation(seed=3, wind=(4, 200, 4), link_protocol=link_protocol)
    hover(simulation, 1.2375, altitude_m=30)  # in the middle of the frames of RC and link
    moment = simulation.snapshot()
    first = manoeuvre(simulation)
    simulation.rc(arm=0.0)
    simulation.run(2.0)
    simulation.restore(moment)
    assert np.array_equal(first, manoeuvre(simulation))
    other = Simulation(seed=3, wind=(4, 200, 4), link_protocol=link_protocol)
    hover(other, 1.2375, altitude_m=30)
    assert np.array_equal(first, manoeuvre(other)), "a simulation that never was saved goes another way"


def test_branches_of_a_moment_differ_by_what_is_done_alone(simulation):
    hover(simulation, 1.0)
    moment = simulation.snapshot()
    ends = {}
    for roll_rad in (-0.2, 0.2, -0.2):
        simulation.restore(moment)
        simulation.angles(roll_rad, 0, 0, simulation.hover_throttle)
        simulation.run(0.5)
        ends.setdefault(roll_rad, []).append(state(simulation))
    assert np.array_equal(*ends[-0.2])
    assert ends[-0.2][0][1] < 0 < ends[0.2][0][1]  # east


def test_a_fault_of_another_branch_is_gone(simulation):
    hover(simulation, 0.5, altitude_m=50)
    moment = simulation.snapshot()
    simulation.run(0.5)
    healthy = state(simulation)
    simulation.restore(moment)
    simulation.fault(f"motor0_dead@{simulation.time_s}")
    simulation.run(0.5)
    assert not np.array_equal(healthy, state(simulation))
    simulation.restore(moment)
    simulation.run(0.5)
    assert np.array_equal(healthy, state(simulation))


def test_a_moment_belongs_to_its_simulation(simulation):
    with pytest.raises(rosflight.SimulationError, match="the snapshot is of another simulation"):
        Simulation(start=False).restore(simulation.snapshot())


def test_arrays_are_views_that_follow_and_cannot_be_written(simulation):
    position, before = simulation.truth.position_m, simulation.truth.position_m.copy()
    hover(simulation, 0.1)
    assert position is simulation.truth.position_m and not np.array_equal(position, before)
    assert np.shares_memory(position, simulation._core.truth)
    with pytest.raises(ValueError, match="read-only"):
        position[0] = 1.0


def test_views_outlive_their_simulation():
    position = Simulation(start=False).truth.position_m
    assert np.isfinite(position).all()


def test_a_fixed_wing_is_held_until_it_is_let_go():
    simulation = Simulation("anaconda", seed=2)
    simulation.surfaces(0, 0, 0, 1.0)
    simulation.run(1.0)
    assert np.linalg.norm(simulation.truth.velocity_m_s) < 0.1
    simulation.hold(False)
    simulation.run(2.0)
    assert simulation.truth.velocity_m_s[0] > 3.0


def test_a_function_is_called_at_its_period_and_flies_as_the_same_commands_do(simulation):
    """A controller of altitude at 50 Hz: what it does is what a loop around step(8) does, to the bit."""

    def control(vehicle):
        climb = vehicle.truth.position_m[2] + 5 + vehicle.truth.velocity_m_s[2]
        vehicle.rates(0, 0, 0, float(np.clip(vehicle.hover_throttle + 0.1 * climb, 0, 1)))

    simulation.step(-round(400 * simulation.time_s) % 8)  # until a multiple of 0.02 s
    moment = simulation.snapshot()
    for _ in range(100):
        control(simulation)
        simulation.step(8)
    by_hand = np.array(simulation._core.truth)
    simulation.restore(moment)
    end = simulation.every(0.02, control)
    simulation.step(3)
    simulation.step(797)
    assert np.array_equal(simulation._core.truth, by_hand)
    times = []
    end()
    stop = simulation.every(0.01, lambda vehicle: times.append(vehicle.time_s))
    simulation.run(0.05)
    stop()
    simulation.run(0.05)
    assert len(times) == 5 and np.diff(times) == pytest.approx([0.01] * 4)


def test_what_a_function_raises_ends_the_step(simulation):
    end = simulation.every(0.01, lambda vehicle: vehicle.step())
    before = simulation.time_s
    with pytest.raises(rosflight.SimulationError, match="^step: found a call by a function of every"):
        simulation.run(1)
    end()
    simulation.step()
    assert simulation.time_s < before + 0.02


@pytest.mark.parametrize("arguments, kind, said", [
    ((0.001, print), ValueError, "every: found 0.001, allowed at least 0.0025"),
    ((0.01, 3), TypeError, "every: found 3, allowed a function of the simulation"),
])
def test_bad_arguments_of_every_are_one_line(arguments, kind, said, simulation):
    with pytest.raises(kind) as raised:
        simulation.every(*arguments)
    assert str(raised.value) == said


def test_one_thread_at_a_time(simulation):
    thread = threading.Thread(target=lambda: simulation.run(60.0))
    thread.start()
    with pytest.raises(RuntimeError, match="another thread is using it"):
        while thread.is_alive():
            simulation.time_s
    thread.join()


def test_ctrl_c_ends_a_long_step():
    script = textwrap.dedent("""
        import os, signal, threading, rosflight
        signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell has its background jobs ignore it
        simulation = rosflight.Simulation()
        threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        try:
            simulation.run(1e6)
        except KeyboardInterrupt:
            print("interrupted", simulation.time_s < 1e5)
            simulation.step()
    """)
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert done.stdout == "interrupted True\n", done.stderr
