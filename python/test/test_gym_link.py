# SPDX-License-Identifier: BSD-3-Clause
"""Environments with the bytes of the link in the loop, and what a companion sees over it."""

import warnings

import gymnasium
import numpy as np
import pytest
import rosflight  # noqa: F401  registers the environments
from gymnasium.utils.env_checker import check_env

LINKED = {"link": True, "observation": "estimate"}


def make(name="Hover", **options):
    return gymnasium.make(f"rosflight/{name}-v0", **options).unwrapped


def trajectory(env, steps=40, seed=4):
    random = np.random.default_rng(0)
    rows = [env.reset(seed=seed)[0]]
    for _ in range(steps):
        rows.append(env.step(random.uniform(-0.3, 0.3, env.action_space.shape).astype(np.float32))[0])
    return np.array(rows)


@pytest.mark.parametrize("name", ["Hover", "Waypoints", "Gates", "Landing"])
@pytest.mark.parametrize("observation", ["truth", "estimate", "sensors"])
def test_the_checks_of_gymnasium_pass(name, observation):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", message=".*(infinity|render|not within).*")
        check_env(make(name, link=True, observation=observation), skip_render_check=True)


def test_a_seed_says_all_and_the_single_vehicle_is_the_first_of_many():
    one = trajectory(make(**LINKED))
    env = make(**LINKED)
    assert np.array_equal(one, trajectory(env)) and np.array_equal(one, trajectory(env))
    envs = gymnasium.make_vec("rosflight/Hover-v0", num_envs=3, vectorization_mode="vector_entry_point", threads=3, **LINKED)
    random = np.random.default_rng(0)
    rows = [envs.reset(seed=4)[0][0]]
    for _ in range(40):
        rows.append(envs.step(np.tile(random.uniform(-0.3, 0.3, 4).astype(np.float32), (3, 1)))[0][0])
    assert np.array_equal(one, np.array(rows))


def test_the_estimate_is_near_the_truth_and_not_it():
    env = make(**LINKED)
    for seed in range(1, 6):
        observation, _ = env.reset(seed=seed)
        for _ in range(50):
            observation = env.step(np.zeros(4, np.float32))[0]
        truth = env.truth()
        off = observation[:3] - (np.array([0, 0, -5]) - truth[:3])
        assert 1e-4 < np.linalg.norm(off) < 1.5
        assert 1e-5 < np.linalg.norm(observation[3:6] - truth[3:6]) < 0.3
        w, x, y, z = truth[6:10]
        down_true = np.array([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)])
        assert np.degrees(np.arccos(np.clip(observation[12:15] @ down_true, -1, 1))) < 2.0


def test_with_a_link_the_truth_can_be_seen_too():
    env = make(link=True)
    observation, _ = env.reset(seed=1)
    assert observation[:3] == pytest.approx(np.array([0, 0, -5]) - env.truth()[:3], abs=1e-6)


def test_the_sensors_measure_what_they_should_in_hover():
    """Rates and gravity within the noise of vehicles/multirotor.yaml and the vibration of its rotors; the field of the place, 50 uT."""
    env = make(link=True, observation="sensors", start_radius_m=0.0)
    observation, _ = env.reset(seed=1)
    rows = []
    for _ in range(100):
        rows.append(env.step(np.zeros(4, np.float32))[0][22:])
    assert observation.shape == (22 + 15,)
    gyro, accel, mag, baro, distance, airspeed, velocity = np.split(np.mean(rows, axis=0), [3, 6, 9, 10, 11, 12])
    assert np.abs(gyro).max() < 0.05 and np.linalg.norm(accel) == pytest.approx(9.8, abs=0.5)
    assert 40 < np.linalg.norm(mag) < 60
    assert distance[0] == pytest.approx(-env.truth()[2], abs=0.4)
    assert np.abs(velocity).max() < 0.6
    assert len(np.unique([row[0] for row in rows])) > 10  # each step has its own sample


def test_a_command_is_not_there_before_it_is_sent():
    """40 bytes take 0.4 ms at 921600 baud: the pass at the moment of the action flies the old command, the next one the new."""
    env = make(action="motors", rate_hz=400, start_radius_m=0.0, **LINKED)
    env.reset(seed=1)
    outputs = []
    for _ in range(5):
        env.step(np.full(4, 0.6, np.float32))
        outputs.append(env.truth()[15:19])
    assert [np.allclose(output, 0.8, atol=1e-3) for output in outputs] == [False, True, True, True, True]


def test_a_controller_hovers_on_the_estimate():
    env = make(action="velocity", **LINKED)
    observation, _ = env.reset(seed=1)
    for _ in range(999):
        to = observation[:3]
        observation, _, terminated, truncated, _ = env.step(np.clip([to[0] / 8, to[1] / 8, to[2] / 2, 0], -1, 1).astype(np.float32))
        assert not terminated and not truncated
    assert np.linalg.norm(observation[:3]) < 0.15  # by the estimate
    assert env.truth()[13] < 1.5


@pytest.mark.parametrize("name, options, kind, said", [
    ("Hover", {"observation": "estimate"}, ValueError, "observation: found 'estimate' without a link, allowed with link=True"),
    ("Hover", {"observation": "all"}, ValueError, "observation: found 'all', allowed truth, estimate, sensors"),
    ("Hover", {"link": 1}, TypeError, "link: found 1, allowed True, False"),
    ("FixedWingLine", {"link": True}, ValueError, "link: found true for anaconda, a fixed wing, allowed false"),
])
def test_bad_options_are_one_line(name, options, kind, said):
    with pytest.raises(kind) as raised:
        make(name, **options).reset(seed=1)
    assert said in str(raised.value) and "\n" not in str(raised.value)
