# SPDX-License-Identifier: BSD-3-Clause
"""Vehicles of an environment that differ, and commands that are late."""

from pathlib import Path

import gymnasium
import numpy as np
import pytest
import rosflight  # noqa: F401  registers the environments
from gymnasium.utils.env_checker import data_equivalence
from rosflight._variation import Variation

EXAMPLE = Path(__file__).resolve().parents[1] / "examples/variation.yaml"
STILL = {"start_radius_m": 0.0, "start_tilt_rad": 0.0, "start_speed_m_s": 0.0, "start_rates_rad_s": 0.0}


def vector(file, name="Hover", num_envs=3, **options):
    return gymnasium.make_vec(f"rosflight/{name}-v0", num_envs=num_envs, vectorization_mode="vector_entry_point", randomise=file, **options)


@pytest.fixture
def written(tmp_path):
    def write(text):
        (tmp_path / "v.yaml").write_text(text)
        return tmp_path / "v.yaml"

    return write


def test_vehicles_differ_and_a_seed_says_how():
    envs = vector(EXAMPLE, threads=2)
    first, info = envs.reset(seed=4)
    drawn = info["drawn"]
    assert len(drawn) == 11 and all(value.shape == (3,) for value in drawn.values())
    assert len(np.unique(drawn["set.body.mass_kg"])) == 3
    other = envs.reset(seed=5)[1]["drawn"]
    assert not np.array_equal(other["set.body.mass_kg"], drawn["set.body.mass_kg"])
    again, info = envs.reset(seed=4)
    assert data_equivalence(info["drawn"], drawn, exact=True) and np.array_equal(first, again)
    assert data_equivalence(envs.reset()[1]["drawn"], drawn, exact=True)  # another episode of the same vehicles


def test_the_single_vehicle_is_the_first_of_many():
    env, envs = gymnasium.make("rosflight/Hover-v0", randomise=EXAMPLE), vector(EXAMPLE)
    (one, info), (many, infos) = env.reset(seed=9), envs.reset(seed=9)
    assert info["drawn"] == {name: values[0] for name, values in infos["drawn"].items()}
    for _ in range(20):
        one, many = env.step(np.zeros(4, np.float32))[0], envs.step(np.zeros((3, 4), np.float32))[0]
    assert np.array_equal(one, many[0])


def test_equal_thrust_accelerates_by_the_drawn_mass(written):
    """After 0.15 s all rotors turn alike, and none has gone far: climbing at 2 m/s they pull less."""
    envs = vector(written("set: {body.mass_kg: {uniform: [2.5, 4.5]}}"), num_envs=6, action="motors", **STILL)
    _, info = envs.reset(seed=1)
    mass = info["drawn"]["set.body.mass_kg"]
    actions = np.full((6, 4), 0.4, np.float32)
    for _ in range(15):
        envs.step(actions)
    before = envs.truth()[:, 5]
    envs.step(actions)
    thrust = (9.80665 - (envs.truth()[:, 5] - before) / 0.01) * mass
    assert np.ptp(mass) > 0.5 * mass.mean() and np.ptp(thrust) < 0.06 * thrust.mean()


def test_a_fixed_wing_begins_in_the_drawn_wind(written):
    envs = vector(written("wind: {speed_m_s: {uniform: [1, 6]}, from_deg: {choice: [90, 180]}}"), "FixedWingLine", **STILL)
    observations, info = envs.reset(seed=1)
    speed, toward = info["drawn"]["wind.speed_m_s"], np.radians(info["drawn"]["wind.from_deg"] + 180)
    air = observations[:, 3:5] - (speed * [np.cos(toward), np.sin(toward)]).T
    assert np.hypot(*air.T) == pytest.approx([15.0] * 3, abs=1e-3)


@pytest.mark.parametrize("delay_s, steps", [(0.0, 0), (0.05, 20), (0.0125, 5)])
def test_a_delayed_command_reaches_the_motors_so_many_steps_later(delay_s, steps):
    """Each step of an environment is one pass of the firmware here: 2.5 ms. A pass controls with what the one before it received."""
    env = gymnasium.make("rosflight/Hover-v0", action="motors", rate_hz=400, action_delay_s=delay_s, **STILL).unwrapped
    env.reset(seed=1)
    wanted = np.full(4, 0.8, np.float32)
    outputs = []
    for _ in range(30):
        env.step(2 * wanted - 1)
        outputs.append(env.truth()[15:19])
    came = [np.allclose(output, wanted, atol=1e-3) for output in outputs]
    assert came == [False] * (1 + steps) + [True] * (29 - steps)


def test_delays_of_a_file(written):
    envs = vector(written("action_delay_s: {choice: [0, 0.05]}"), num_envs=8, action="motors", rate_hz=400, **STILL)
    _, info = envs.reset(seed=1)
    for _ in range(2):
        envs.step(np.full((8, 4), 0.6, np.float32))
    at_once = np.isclose(envs.truth()[:, 15], 0.8, atol=1e-3)
    assert np.array_equal(at_once, info["drawn"]["action_delay_s"] == 0) and 0 < at_once.sum() < 8


def test_draws_have_the_mean_and_spread_of_their_distributions(written):
    file = written("set:\n  body.mass_kg: {uniform: [3, 4]}\n  rotors.motor.resistance_ohm: {normal: [0.04, 0.004], within: [0.02, 0.06]}\n")
    variation = Variation(str(file), "multirotor", [])
    drawn = [variation.draw(1, k) for k in range(2000)]
    mass = np.array([one["set.body.mass_kg"] for one in drawn])
    ohm = np.array([one["set.rotors.motor.resistance_ohm"] for one in drawn])
    assert mass.mean() == pytest.approx(3.5, abs=4 * np.sqrt(1 / 12 / 2000)) and mass.min() >= 3 and mass.max() <= 4
    assert ohm.mean() == pytest.approx(0.04, abs=4 * 0.004 / np.sqrt(2000))
    assert ohm.std() == pytest.approx(0.004, rel=4 / np.sqrt(2 * 2000))
    assert abs(np.corrcoef(mass, ohm)[0, 1]) < 4 / np.sqrt(2000)


@pytest.mark.parametrize("text, line, said", [
    ("sett: {}", 1, "found the key 'sett', allowed set, wind, action_delay_s"),
    ("{}", 1, "found no key, allowed set, wind, action_delay_s"),
    ("set:\n  body.mas_kg: 3", 2, "set.body.mas_kg: found"),
    ("set:\n  body.mass_kg: {uniform: [-1, 4]}", 2, "set.body.mass_kg: found -1"),
    ("set:\n  body.mass_kg: {normal: [3.5, 2]}", 2, "set.body.mass_kg: found -"),
    ("set:\n  body.mass_kg: {uniform: [4, 3]}", 2, "found [4, 3], allowed [LOW, HIGH] with LOW below HIGH"),
    ("set:\n  body.mass_kg: {grid: [3, 4]}", 2, "found grid, allowed uniform, normal, choice"),
    ("set:\n  body.mass_kg: {sobol: [3, 4]}", 2, "found sobol, allowed uniform, normal, choice"),
    ("set:\n  body.mass_kg: {gauss: [3, 4]}", 2, "found the key 'gauss', allowed uniform, normal, choice"),
    ("wind:\n  speed_m_s: 3", 2, "wind: found no key 'from_deg', which is required"),
    ("wind:\n  from_deg: 0\n  speed_m_s: {uniform: [0, 90]}", 3, "wind.speed_m_s: found"),
    ("action_delay_s: {uniform: [0, 0.2]}", 1, "action_delay_s: found 0.2, allowed 0 to 0.09 s"),
    ("action_delay_s: soon", 1, "action_delay_s: found 'soon', allowed a number"),
    ("set: [", 1, "allowed YAML"),
])
def test_bad_files_are_one_line(written, text, line, said):
    file = written(text)
    with pytest.raises(ValueError) as raised:
        vector(file)
    message = str(raised.value)
    assert message.startswith(f"{file}:{line}: ") and said in message and "\n" not in message, message


@pytest.mark.parametrize("options, kind, said", [
    ({"randomise": "/none.yaml"}, ValueError, "/none.yaml: cannot read it: No such file"),
    ({"randomise": 3}, TypeError, "randomise: found 3, allowed a name or a path"),
    ({"action_delay_s": 0.1}, ValueError, "action_delay_s: found 0.1, allowed 0 to 0.09"),
    ({"action_delay_s": float("nan")}, ValueError, "action_delay_s: found nan"),
])
def test_bad_options_are_one_line(options, kind, said):
    with pytest.raises(kind) as raised:
        gymnasium.make("rosflight/Hover-v0", **options)
    assert said in str(raised.value) and "\n" not in str(raised.value)
