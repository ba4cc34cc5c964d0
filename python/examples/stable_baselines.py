# SPDX-License-Identifier: BSD-3-Clause
"""Stable-Baselines3 learns to hover: its PPO, its vector of environments, its normalisation, and the registered environment as it is.

    ./rosflight python --with sb3 python/examples/stable_baselines.py [STEPS]

`--with sb3` installs Stable-Baselines3 and PyTorch, several gigabytes, on the first start. STEPS are those of all vehicles together. Then
20 episodes of other seeds are flown without the noise of exploration.
"""

from __future__ import annotations

import sys

import gymnasium
import rosflight  # noqa: F401  registers the environments

try:
    from stable_baselines3 import PPO
    from stable_baselines3.common.env_util import make_vec_env
    from stable_baselines3.common.vec_env import VecNormalize
except ImportError as error:
    print(f"stable_baselines.py: found no {error.name}, allowed with ./rosflight python --with sb3", file=sys.stderr)
    sys.exit(2)

VEHICLES, EPISODES = 32, 20
RATE_HZ = 50  #: At 100 Hz a drawn action is over before the position shows whether it was good.


def main(steps: int) -> int:
    # By its name alone make_vec_env would ask for a picture, which no environment here draws.
    envs = VecNormalize(make_vec_env(lambda: gymnasium.make("rosflight/Hover-v0", rate_hz=RATE_HZ), n_envs=VEHICLES, seed=1))
    model = PPO("MlpPolicy", envs, n_steps=256, batch_size=512, n_epochs=5, learning_rate=lambda left: 1e-3 * left, seed=1, device="cpu")
    model.learn(steps)
    successes = 0
    env = gymnasium.make("rosflight/Hover-v0", rate_hz=RATE_HZ)
    for episode in range(EPISODES):
        observation, _ = env.reset(seed=10_001 + episode)
        while True:
            action, _ = model.predict(envs.normalize_obs(observation), deterministic=True)
            observation, _, terminated, truncated, info = env.step(action)
            if terminated or truncated:
                break
        successes += info["is_success"]
    print(f"{successes} of {EPISODES} episodes without noise succeed")
    return 0


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000))
