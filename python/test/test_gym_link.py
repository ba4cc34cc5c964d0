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


@pytest.mark.parametrize("name", ["Hover", "Waypoints", "Gates", "Landing", "FixedWingLine"])
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


@pytest.mark.parametrize("wind", [None, (4, 250)])
def test_a_fixed_wing_begins_beside_its_line(wind):
    """Off the line by up to the radius of the start, on a course within 29 degrees of it, in level flight at cruise; and it has taken off."""
    env = make("FixedWingLine", wind=wind, **LINKED)
    for seed in (1, 2, None, None):
        observation, _ = env.reset(seed=seed)
        truth = env.truth()
        air = 0 if wind is None else wind[0]
        assert truth[13] < 10 + 1.5 and truth[2] == pytest.approx(-50, abs=10 + 2)
        along = truth[3:5] @ observation[22:24] / np.linalg.norm(truth[3:5])
        assert np.degrees(np.arccos(min(along, 1))) < np.degrees(0.5) + 5
        assert abs(truth[5]) < 1 and 15 - air - 2 < np.linalg.norm(truth[3:5]) < 15 + air + 2
        assert np.linalg.norm(truth[10:13]) < 0.3


def test_episodes_of_a_fixed_wing_differ_and_threads_change_nothing():
    def flown(threads):
        envs = gymnasium.make_vec("rosflight/FixedWingLine-v0", num_envs=3, vectorization_mode="vector_entry_point", threads=threads,
                                  action="velocity", episode_s=0.5, autoreset_mode="SameStep", **LINKED)
        random = np.random.default_rng(0)
        rows = [envs.reset(seed=4)[0]]
        for _ in range(120):
            rows.append(envs.step(random.uniform(-1, 1, (3, 4)).astype(np.float32))[0])
        return np.array(rows)

    first = flown(1)
    assert np.array_equal(first, flown(3))
    assert len(np.unique(first[[0, 50, 100], :, 22])) == 9  # each line has a direction of its own


@pytest.mark.parametrize("action", ["velocity", "waypoint"])
def test_a_fixed_wing_follows_its_line_on_the_estimate(action):
    """Towards the point 60 m ahead on the line; by the truth it ends within two metres of it, most of them the origin's."""
    env = make("FixedWingLine", action=action, **LINKED)
    observation, _ = env.reset(seed=1)
    for _ in range(2999):
        ahead = observation[:3] + 60 * observation[22:25]
        flat = ahead[:2] / (np.hypot(*ahead[:2]) * 4 if action == "velocity" else 100)
        observation, _, terminated, truncated, _ = env.step(
            np.clip([*flat, observation[2] / (5 if action == "velocity" else 15), 0], -1, 1).astype(np.float32))
        assert not terminated and not truncated
    assert np.linalg.norm(observation[:3]) < 1.5 and env.truth()[13] < 3.0
    velocity = env.truth()[3:6]
    assert velocity @ observation[22:25] > np.cos(np.radians(3)) * np.linalg.norm(velocity)


def test_the_firmware_of_a_linked_fixed_wing_holds_angles():
    """A bank of 20 degrees turns at g tan(20)/15 = 13.6 degrees per second, where its own filter has the companion's attitude too."""
    env = make("FixedWingLine", action="angles", **LINKED)
    env.reset(seed=2)
    roll = []
    for k in range(600):
        env.step(np.array([0.1, 20 / 45, 2 / 45, 0], np.float32))
        w, x, y, z = env.truth()[6:10]
        if k > 300:
            roll.append(np.degrees(np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))))
    assert np.mean(roll) == pytest.approx(20, abs=3)


@pytest.mark.parametrize("name, options, kind, said", [
    ("Hover", {"observation": "estimate"}, ValueError, "observation: found 'estimate' without a link, allowed with link=True"),
    ("Hover", {"observation": "all"}, ValueError, "observation: found 'all', allowed truth, estimate, sensors"),
    ("Hover", {"link": 1}, TypeError, "link: found 1, allowed True, False"),
    ("FixedWingLine", {"link": True, "altitude_m": 5.0}, ValueError, "altitude_m: found 5 for anaconda with a link, allowed 15 to 150"),
    ("FixedWingLine", {"link": True, "action": "motors"}, ValueError, "allowed surfaces, rates, angles, velocity, waypoint"),
])
def test_bad_options_are_one_line(name, options, kind, said):
    with pytest.raises(kind) as raised:
        make(name, **options).reset(seed=1)
    assert said in str(raised.value) and "\n" not in str(raised.value)
