# SPDX-License-Identifier: BSD-3-Clause
"""rosflight.Simulation.forces: what a function leaves acts, at each stage of the integration, and its errors arrive."""

import gc
import weakref

import numpy as np
import pytest
from rosflight import Forces, Simulation

GRAVITY_M_S2 = 9.80665


@pytest.fixture
def simulation():
    """High up and at rest."""
    vehicle = Simulation(start=False)
    vehicle.place([0, 0, -500])
    return vehicle


def test_without_any_force_it_falls_as_galileo_says(simulation):
    def nothing(at: Forces):
        at.force_N[:] = 0
        at.torque_Nm[:] = 0
    simulation.forces(nothing)
    simulation.run(2.0)
    assert simulation.truth.velocity_m_s[2] == pytest.approx(2 * GRAVITY_M_S2, abs=1e-10)
    assert simulation.truth.position_m[2] + 500 == pytest.approx(2 * GRAVITY_M_S2, abs=1e-9)
    assert np.abs(simulation.truth.specific_force_m_s2).max() == 0


def test_a_spring_swings_as_its_closed_form(simulation):
    """Fourth order, so that all stages ask: an oscillator of 8 rad/s is off by h^4 w^5 t/120 = 3e-8 of its amplitude in 3 s."""
    omega, mass, seen = 8.0, 3.5, []  # the mass of vehicles/multirotor.yaml

    def spring(at: Forces):
        seen.append((at.time_s, at.position_m[2], at.height_m, at.air_velocity_m_s[2]))
        at.force_N[:] = [0, 0, -mass * (GRAVITY_M_S2 + omega ** 2 * (at.position_m[2] + 499))]
        at.torque_Nm[:] = 0
    simulation.forces(spring)
    simulation.run(3.0)
    assert simulation.truth.position_m[2] + 499 == pytest.approx(-np.cos(omega * 3.0), abs=1e-7)
    assert simulation.truth.velocity_m_s[2] == pytest.approx(omega * np.sin(omega * 3.0), abs=1e-6)
    assert len(seen) == 4 * 1200 and seen[0][0] == 0 and seen[-1][0] == pytest.approx(2.9975)
    assert seen[0][1:] == (-500, 500, 0) and seen[4][3] > 0


def test_a_torque_turns_it(simulation):
    def turn(at: Forces):
        at.force_N[:] = 0
        at.torque_Nm[:] = [0.08, 0, 0]  # its inertia is 0.08 kg m^2 (vehicles/multirotor.yaml)
    simulation.forces(turn)
    simulation.run(1.0)
    assert simulation.truth.rates_rad_s == pytest.approx([1, 0, 0], abs=1e-9)


def test_a_function_that_changes_nothing_changes_no_bit():
    ends = []
    for function in (None, lambda at: None):
        vehicle = Simulation(seed=3, wind=(4, 270, 3))
        vehicle.forces(function)
        vehicle.angles(0.1, 0, 0, 1.1 * vehicle.hover_throttle)
        vehicle.run(2.0)
        ends.append(vehicle._core.truth.tobytes())
    assert ends[0] == ends[1]


def test_it_ends_when_asked_and_a_snapshot_does_not_hold_it(simulation):
    calls = []
    moment = simulation.snapshot()
    simulation.forces(lambda at: calls.append(at.time_s))
    simulation.step()
    simulation.restore(moment)
    simulation.step()
    assert len(calls) == 8
    simulation.forces(None)
    simulation.step()
    assert len(calls) == 8


def test_what_it_raises_ends_the_step_and_the_simulation_goes_on(simulation):
    class Own(Exception):
        pass

    def broken(at: Forces):
        raise Own("no model")
    simulation.forces(broken)
    with pytest.raises(Own, match="no model"):
        simulation.run(1.0)
    assert simulation.time_s == Simulation.STEP_S
    with pytest.raises(Own):
        simulation.place([0, 0, -400])
    simulation.forces(None)
    simulation.run(1.0)
    assert simulation.time_s == pytest.approx(1.0 + Simulation.STEP_S)


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_a_wrench_that_is_no_number_is_refused(simulation, value):
    def wrong(at: Forces):
        at.torque_Nm[1] = value
    simulation.forces(wrong)
    with pytest.raises(ValueError, match="^forces: found NaN or infinity in what the function left, allowed finite numbers$"):
        simulation.step(10)
    assert simulation.time_s == Simulation.STEP_S and np.isfinite(simulation.truth.position_m).all()


def test_bad_input(simulation):
    with pytest.raises(TypeError, match="forces: found 3, allowed a function of Forces, or None"):
        simulation.forces(3)

    def writes(at: Forces):
        at.position_m[0] = 1
    simulation.forces(writes)
    with pytest.raises(ValueError, match="read-only"):
        simulation.step()

    def steps(at: Forces):
        simulation.step()
    simulation.forces(steps)
    with pytest.raises(RuntimeError, match="another thread is using it"):
        simulation.step()


def test_a_function_that_refers_to_its_simulation_does_not_keep_it():
    vehicle = Simulation(start=False)
    vehicle.forces(lambda at, vehicle=vehicle: vehicle.STEP_S)
    vehicle.step()
    seen = weakref.ref(vehicle), weakref.ref(vehicle._forces)  # the latter holds the core by its arrays
    del vehicle
    gc.collect()
    assert [one() for one in seen] == [None, None]
