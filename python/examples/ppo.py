# SPDX-License-Identifier: BSD-3-Clause
"""Proximal policy optimisation in one file, with NumPy alone: a policy learns a task from nothing, with the firmware in the loop.

    ppo.py TASK [--steps N] [--seed S] [--threads T] [--out FILE.npz] [--csv FILE.csv]

TASK is hover, waypoints, gates, landing or attitude. Two networks of two layers of 64 (tanh), one for the mean of the action and one for the
value; the spread of the action does not depend on the observation. They see vectors in the axes of the body. A line for each percent: steps,
seconds of the clock and of the processor, and of the episodes that ended meanwhile how many succeeded; FILE.csv receives the same, for
learning_curves.py. Then 100 episodes of other seeds without noise. FILE.npz receives what fly() needs.

J. Schulman et al.: Proximal Policy Optimization Algorithms. arXiv:1707.06347, 2017. Advantages by (11) there.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from contextlib import nullcontext
from typing import Any, TextIO

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # Matrices this small take longer on several threads.

import numpy as np  # noqa: E402
from gymnasium.vector import AutoresetMode  # noqa: E402
from numpy.typing import NDArray  # noqa: E402
from rosflight.gym import FlightVectorEnv  # noqa: E402

Array = NDArray[np.float32]

VEHICLES, HORIZON = 128, 64  #: A batch has this many steps of this many vehicles.
EPOCHS, MINIBATCHES = 5, 16
RATE_HZ = 50  #: Actions per second: at 100 a drawn action is over before the position shows whether it was good.
GAMMA, LAMBDA, CLIP = 0.995, 0.95, 0.2
RATE, MAX_GRADIENT = 1e-3, 0.5
FIRST_SPREAD = 0.6
ACTIONS = 4
STEPS = {"hover": 1_500_000, "waypoints": 5_000_000, "gates": 10_000_000, "landing": 5_000_000, "attitude": 2_000_000}


class Network:
    """Layers of tanh, the last one linear."""

    def __init__(self, sizes: list[int], last_gain: float, random: np.random.Generator):
        gains = [1.0] * (len(sizes) - 2) + [last_gain]
        self.parameters: list[Array] = []
        for gain, rows, columns in zip(gains, sizes, sizes[1:]):
            self.parameters += [(gain / np.sqrt(rows) * random.standard_normal((rows, columns))).astype(np.float32),
                                np.zeros(columns, np.float32)]

    def __call__(self, x: Array) -> Array:
        return self.layers(x)[-1]

    def layers(self, x: Array) -> list[Array]:
        """x and the output of each layer."""
        out = [x]
        for k in range(0, len(self.parameters), 2):
            y = out[-1] @ self.parameters[k] + self.parameters[k + 1]
            out.append(y if k == len(self.parameters) - 2 else np.tanh(y))
        return out

    def gradients(self, layers: list[Array], g: Array) -> list[Array]:
        """@param g: gradient of the loss by the output."""
        out: list[Array] = []
        for k in range(len(self.parameters) - 2, -1, -2):
            x = layers[k // 2]
            out = [x.T @ g, g.sum(axis=0), *out]
            g = (g @ self.parameters[k].T) * (1 - x * x)
        return out


class Adam:
    """D. P. Kingma, J. Ba: Adam. arXiv:1412.6980, 2014. Gradients together are limited to MAX_GRADIENT."""

    def __init__(self, parameters: list[Array]):
        self.parameters = parameters
        self.m = [np.zeros_like(p) for p in parameters]
        self.v = [np.zeros_like(p) for p in parameters]
        self.t = 0

    def step(self, gradients: list[Array], rate: float) -> None:
        self.t += 1
        norm = np.sqrt(sum(float((g * g).sum()) for g in gradients))
        scale = min(1.0, MAX_GRADIENT / (norm + 1e-8))
        for p, g, m, v in zip(self.parameters, gradients, self.m, self.v):
            m += 0.1 * (scale * g - m)
            v += 0.001 * (scale * scale * g * g - v)
            p -= np.float32(rate) * (m / (1 - 0.9**self.t)) / (np.sqrt(v / (1 - 0.999**self.t)) + np.float32(1e-8))


class Moments:
    """Mean and spread of the columns of all that was seen."""

    def __init__(self, size: int):
        self.mean, self.spread, self._count = np.zeros(size), np.ones(size), 1e-4

    def watch(self, rows: Array) -> None:
        """Of two sets together."""
        count, mean, variance = len(rows), rows.mean(axis=0), rows.var(axis=0)
        total, apart = self._count + count, mean - self.mean
        self.spread = np.sqrt((self.spread**2 * self._count + variance * count + apart**2 * self._count * count / total) / total)
        self.mean, self._count = self.mean + apart * count / total, total


class Policy:
    """Observations are brought to mean 0 and spread 1 by those that were seen."""

    def __init__(self, size: int, random: np.random.Generator, actions: int = ACTIONS):
        self.seen = Moments(size)
        self.actor = Network([size, 64, 64, actions], 0.01, random)
        self.critic = Network([size, 64, 64, 1], 1.0, random)
        self.log_spread = np.full(actions, np.log(FIRST_SPREAD), np.float32)

    def scaled(self, observations: Array) -> Array:
        return np.clip((observations - self.seen.mean) / (self.seen.spread + 1e-6), -10, 10).astype(np.float32)

    def fly(self, observations: Array) -> Array:
        """The action without noise for what in_body() returns. An environment limits it."""
        return self.actor(self.scaled(observations))

    def save(self, file: str) -> None:
        np.savez(file, *self.actor.parameters, mean=self.seen.mean, spread=self.seen.spread, rate_hz=RATE_HZ)


def in_body(observations: Array) -> Array:
    """Observations of docs/gymnasium with all vectors in the axes of the body; what is left of the attitude is where down is. A task that
    is turned about the vertical then looks the same, and is not learnt once for each heading. Those of Attitude-v0 are so already."""
    if observations.shape[1] < 22:
        return observations
    turn = observations[:, 6:15].reshape(-1, 3, 3)  # takes what is in the body to north-east-down

    def turned(vectors: Array) -> Array:
        return (vectors.reshape(len(vectors), -1, 3) @ turn).reshape(vectors.shape)

    return np.concatenate([turned(observations[:, :6]), turn[:, 2], observations[:, 15:22], turned(observations[:, 22:])], axis=1)


def surplus(rewards: Array, values: Array, terminated: NDArray[np.bool_], ended: NDArray[np.bool_]) -> Array:
    """Generalised advantages. @param values: of the observations before each step and after the last."""
    out = np.zeros_like(rewards)
    later = np.zeros(rewards.shape[1], np.float32)
    for k in range(len(rewards) - 1, -1, -1):
        error = rewards[k] + GAMMA * values[k + 1] * ~terminated[k] - values[k]
        later = error + GAMMA * LAMBDA * later * ~ended[k]
        out[k] = later
    return out


def train(task: str, steps: int, seed: int, threads: int, csv: TextIO | None = None) -> Policy:
    random = np.random.default_rng(seed)
    envs = FlightVectorEnv(VEHICLES, task, AutoresetMode.NEXT_STEP, rate_hz=RATE_HZ, threads=threads)
    first = in_body(envs.reset(seed=seed)[0])
    size, actions = first.shape[1], envs.action_space.sample().shape[1]
    policy = Policy(size, random, actions)
    adam = Adam([*policy.actor.parameters, policy.log_spread, *policy.critic.parameters])
    seen = np.zeros((HORIZON + 1, VEHICLES, size), np.float32)
    acted, rewards = np.zeros((HORIZON, VEHICLES, actions), np.float32), np.zeros((HORIZON, VEHICLES), np.float32)
    terminated, ended, valid = np.zeros((3, HORIZON, VEHICLES), bool)
    seen[0] = first
    policy.seen.watch(first)
    sums = np.zeros((HORIZON + 1, VEHICLES), np.float32)  # of rewards since an episode began, faded
    returns = Moments(1)
    over = np.zeros(VEHICLES, bool)
    began, used, said, episodes, successes = time.monotonic(), time.process_time(), 0, 0, 0
    batches = max(1, steps // (HORIZON * VEHICLES))
    for number in range(batches):
        for k in range(HORIZON):
            noise = random.standard_normal((VEHICLES, actions), np.float32)
            acted[k] = policy.fly(seen[k]) + np.exp(policy.log_spread) * noise
            valid[k] = ~over  # after its end an episode begins again, whatever the action
            observations, rewards[k], terminated[k], truncated, info = envs.step(acted[k])
            seen[k + 1] = in_body(observations)
            sums[k + 1] = GAMMA * sums[k] * ~over + rewards[k]
            ended[k] = over = terminated[k] | truncated
            episodes += int(over.sum())
            successes += int(info["is_success"].sum()) if "is_success" in info else 0
        # Rewards are brought to returns of spread 1, so that the value's gradient leaves the policy's its share of MAX_GRADIENT.
        returns.watch(sums[1:][valid][:, None])
        sums[0] = sums[-1]
        inputs = policy.scaled(seen)
        values = policy.critic(inputs.reshape(-1, size)).reshape(HORIZON + 1, VEHICLES)
        advantages = surplus(rewards / np.float32(returns.spread[0] + 1e-6), values, terminated, ended)
        learn(policy, adam, inputs[:-1][valid], acted[valid], advantages[valid], (advantages + values[:-1])[valid],
              RATE * (1 - number / batches), random)
        policy.seen.watch(seen[:-1][valid])
        seen[0] = seen[-1]
        if (percent := 100 * (number + 1) // batches) > said or number == 0:
            said = percent
            done, clock, processor = (number + 1) * HORIZON * VEHICLES, time.monotonic() - began, time.process_time() - used
            print(f"{done:9d} steps {clock:6.1f} s {processor:6.1f} s of the processor"
                  f"  {successes:4d} of {episodes:4d} episodes succeed  reward {rewards[valid].mean():.4f}", flush=True)
            if csv:
                print(f"{done},{clock:.1f},{processor:.1f},{successes},{episodes},{rewards[valid].mean():.5f}", file=csv, flush=True)
            episodes = successes = 0
    return policy


def learn(policy: Policy, adam: Adam, inputs: Array, acted: Array, advantages: Array, returns: Array, rate: float,
          random: np.random.Generator) -> None:
    def log_density(mean: Array, taken: Array) -> Any:
        return -(0.5 * ((taken - mean) / np.exp(policy.log_spread)) ** 2 + policy.log_spread).sum(axis=-1)

    before = log_density(policy.actor(inputs), acted)
    advantages = (advantages - advantages.mean()) / (advantages.std() + 1e-8)
    for _ in range(EPOCHS):
        for rows in np.array_split(random.permutation(len(inputs)), MINIBATCHES):
            x, a, advantage = inputs[rows], acted[rows], advantages[rows]
            layers = policy.actor.layers(x)
            z = (a - layers[-1]) / np.exp(policy.log_spread)
            ratio = np.exp(log_density(layers[-1], a) - before[rows])
            # The clipped objective has no slope where the ratio has left its band in the direction of the advantage.
            inside = np.where(advantage > 0, ratio < 1 + CLIP, ratio > 1 - CLIP)
            by_log = (-advantage * ratio * inside / len(rows))[:, None].astype(np.float32)
            actor = policy.actor.gradients(layers, by_log * z / np.exp(policy.log_spread))
            values = policy.critic.layers(x)
            critic = policy.critic.gradients(values, 0.5 * (values[-1] - returns[rows][:, None]) / np.float32(len(rows)))
            adam.step([*actor, (by_log * (z * z - 1)).sum(axis=0), *critic], rate)


def judge(task: str, policy: Policy, seed: int, threads: int) -> int:
    """@returns how many of 100 episodes succeed, each of another vehicle."""
    envs = FlightVectorEnv(100, task, AutoresetMode.DISABLED, rate_hz=RATE_HZ, threads=threads)
    observations, _ = envs.reset(seed=seed)
    ended, succeeded = np.zeros(100, bool), np.zeros(100, bool)
    while not ended.all():
        observations, _, terminated, truncated, info = envs.step(policy.fly(in_body(observations)))
        over = terminated | truncated
        if over.any():
            succeeded |= info["is_success"] & ~ended
            ended |= over
            envs.reset(options={"reset_mask": over})
    return int(succeeded.sum())


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("task", choices=tuple(STEPS))
    parser.add_argument("--steps", type=int, help="of all vehicles together")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--out", help="a file for the policy")
    parser.add_argument("--csv", help="a file for the learning curve")
    given = parser.parse_args()
    with open(given.csv, "w", encoding="utf-8") if given.csv else nullcontext() as csv:
        if csv:
            print("steps,clock_s,processor_s,successes,episodes,reward", file=csv)
        policy = train(given.task, given.steps or STEPS[given.task], given.seed, given.threads, csv)
    if given.out:
        policy.save(given.out)
    print(f"{judge(given.task, policy, 10_000 + given.seed, given.threads)} of 100 episodes without noise succeed")
    return 0


if __name__ == "__main__":
    sys.exit(main())
