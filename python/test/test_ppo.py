# SPDX-License-Identifier: BSD-3-Clause
"""The parts of python/examples/ppo.py by themselves. Whether it learns to hover is measured by ./rosflight bench learn."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

FILE = Path(__file__).resolve().parents[1] / "examples/ppo.py"


@pytest.fixture(scope="module")
def ppo():
    spec = importlib.util.spec_from_file_location("ppo", FILE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_gradients_are_those_of_central_differences(ppo):
    random = np.random.default_rng(1)
    network = ppo.Network([3, 5, 4, 2], 1.0, random)
    network.parameters = [p.astype(float) + 0.1 * random.standard_normal(p.shape) for p in network.parameters]
    x, weights = random.standard_normal((7, 3)), random.standard_normal((7, 2))
    found = network.gradients(network.layers(x), weights)
    step = 1e-6
    for p, g in zip(network.parameters, found, strict=True):
        for k in np.ndindex(p.shape):
            value = p[k]
            p[k] = value + step
            above = (weights * network(x)).sum()
            p[k] = value - step
            below = (weights * network(x)).sum()
            p[k] = value
            assert g[k] == pytest.approx((above - below) / (2 * step), rel=1e-6, abs=1e-8)


def test_advantages_are_the_sum_of_the_paper(ppo):
    """arXiv:1707.06347, (11): the sum of (gamma lambda)^l delta_(t+l), which ends with the episode."""
    random = np.random.default_rng(2)
    rewards, values = random.standard_normal((6, 1)), random.standard_normal((7, 1))
    terminated, ended = np.zeros((6, 1), bool), np.zeros((6, 1), bool)
    terminated[2] = ended[2] = True  # lost
    ended[4] = True  # truncated: what would have come counts
    errors = [rewards[t, 0] + (0 if terminated[t] else ppo.GAMMA * values[t + 1, 0]) - values[t, 0] for t in range(6)]
    fade = ppo.GAMMA * ppo.LAMBDA
    expected = [errors[0] + fade * errors[1] + fade**2 * errors[2], errors[1] + fade * errors[2], errors[2], errors[3] + fade * errors[4],
                errors[4], errors[5]]
    assert ppo.surplus(rewards, values, terminated, ended)[:, 0] == pytest.approx(expected)


def test_adam_makes_the_first_step_of_its_rate(ppo):
    """arXiv:1412.6980, section 2.1: the first step is the rate, whatever the gradient is."""
    p = np.array([1.0, -2.0], np.float32)
    ppo.Adam([p]).step([np.array([0.3, -0.001], np.float32)], 0.01)
    assert p == pytest.approx([0.99, -1.99], abs=1e-5)


def test_mean_and_spread_of_parts_are_those_of_the_whole(ppo):
    random = np.random.default_rng(3)
    moments, seen = ppo.Moments(4), random.normal(5.0, 3.0, (1000, 4)).astype(np.float32)
    for part in np.array_split(seen, 7):
        moments.watch(part)
    assert moments.mean == pytest.approx(seen.mean(axis=0), rel=1e-4) and moments.spread == pytest.approx(seen.std(axis=0), rel=1e-4)


def test_what_the_policy_sees_does_not_depend_on_the_heading(ppo):
    """SciPy turns a whole scene about the vertical: position, velocity, attitude and the gates."""
    from scipy.spatial.transform import Rotation

    random = np.random.default_rng(5)

    def scene(turn):
        rows = np.empty((20, 31), np.float32)
        for row, (vectors, attitude, body) in zip(rows, scenes, strict=True):
            p, v, *gates = turn.apply(vectors)
            row[:] = np.concatenate([p, v, (turn * attitude).as_matrix().ravel(), body, *gates])
        return ppo.in_body(rows)

    scenes = [(random.standard_normal((5, 3)), Rotation.random(rng=random), random.standard_normal(7)) for _ in range(20)]
    straight = scene(Rotation.identity())
    assert scene(Rotation.from_euler("z", 1.2)) == pytest.approx(straight, abs=1e-5)
    assert abs(scene(Rotation.from_euler("x", 1.2)) - straight).max() > 0.1
    level = np.zeros((1, 22), np.float32)
    level[0, :6], level[0, 6:15] = [1, 0, 0, 0, 2, 0], Rotation.from_euler("z", 90, degrees=True).as_matrix().ravel()
    # Nose to the east: north is to the left, east ahead, down below.
    assert ppo.in_body(level)[0, :9] == pytest.approx([0, -1, 0, 2, 0, 0, 0, 0, 1], abs=1e-6)


def test_the_policy_moves_to_where_the_advantage_is(ppo):
    """Of drawn actions those near a point, which depends on the observation, have the advantage."""
    random = np.random.default_rng(4)
    policy = ppo.Policy(3, random)
    adam = ppo.Adam([*policy.actor.parameters, policy.log_spread, *policy.critic.parameters])

    def best(x):
        return 0.5 * np.tanh(x @ np.eye(3, ppo.ACTIONS))

    for _ in range(40):
        x = random.standard_normal((2048, 3)).astype(np.float32)
        acted = policy.actor(x) + np.exp(policy.log_spread) * random.standard_normal((2048, ppo.ACTIONS), np.float32)
        reward = -((acted - best(x)) ** 2).sum(axis=1).astype(np.float32)
        ppo.learn(policy, adam, x, acted, reward - policy.critic(x)[:, 0], reward, 1e-3, random)
    x = random.standard_normal((1000, 3)).astype(np.float32)
    assert np.sqrt(np.mean((policy.actor(x) - best(x)) ** 2)) < 0.05  # at first 0.3
    assert np.exp(policy.log_spread).max() < 0.8 * ppo.FIRST_SPREAD
