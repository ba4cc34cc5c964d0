# SPDX-License-Identifier: BSD-3-Clause
"""One of the simulators that ours is compared with, stepped as bench/scale.py steps ours. Runs in .venv-peers, beside that program.

    peers.py crazyflow|crazyflow_rotors|l2f VEHICLES CORES

It measures one round for each line on its standard input and answers with a line of JSON: steps of all vehicles in a second of the clock
and of the processor. A step is an action for each vehicle, random and from NumPy, 0.01 s of flight, and observation, reward and ends as
NumPy arrays; episodes that end begin again. The process keeps to its first CORES processors, before XLA and OpenMP count them.
"""

import json
import os
import sys
import time

VEHICLES, CORES = int(sys.argv[2]), int(sys.argv[3])
os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:CORES])
os.environ |= {"OMP_NUM_THREADS": str(CORES), "JAX_PLATFORMS": "cpu"}

import numpy as np  # noqa: E402

ANSWERS = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)  # what libraries print is no answer

STEPS = 200
RATE_HZ = 100


class Crazyflow:
    """256 worlds of one drone with the defaults of Sim, but for the rate of control: attitude control, of which an action lasts 0.01 s,
    500 Hz of physics by Euler's method, no sensors. Its environments dispatch some ten compiled functions in a step; here all of it is
    one, which is twice as fast. `rotors`: its default dynamics, first principles with four rotors; else the fastest that it has, an
    identified model of second order, which its environments have by default. Reward, ends and starts are those of its ReachPosEnv."""

    def __init__(self, rotors: bool):
        import jax
        import jax.numpy as jnp
        from crazyflow.control import Control
        from crazyflow.dynamics import Dynamics
        from crazyflow.envs import ReachPosEnv
        from crazyflow.sim import Sim
        from crazyflow.sim.functional import attitude_control

        dynamics = Dynamics.first_principles if rotors else Dynamics.so_rpy
        envs = ReachPosEnv(num_envs=VEHICLES, freq=RATE_HZ, dynamics=dynamics)
        sim: Sim = envs.sim
        assert sim.control == Control.default and sim.freq == 500
        space = envs.single_action_space
        self.low, self.high = space.low, space.high
        advance, reset, default = sim.build_step_fn(), sim.build_reset_fn(), sim.default_data

        def step(data, goal, actions):
            data = advance(attitude_control(data, actions[:, None]), n_steps=sim.freq // RATE_HZ)
            position = data.states.pos[:, 0]
            terminated = position[:, 2] < 0.0
            truncated = data.core.steps[:, 0] >= 10 * sim.freq
            reward = jnp.where(terminated, -1.0, jnp.exp(-2.0 * jnp.linalg.norm(position - goal, axis=-1)))
            data = reset(data, default, terminated | truncated)
            states = data.states
            seen = jnp.concatenate([part[:, 0] for part in (states.pos, states.quat, states.vel, states.ang_vel)]
                                   + [goal - states.pos[:, 0]], axis=-1)
            return data, (seen, reward, terminated, truncated)

        self._step, self._goal = jax.jit(step, donate_argnums=0), jnp.tile(jnp.array([0.0, 0.0, 1.0]), (VEHICLES, 1))
        self._data = reset(sim.data, default, None)

    def step(self, actions: np.ndarray) -> tuple[np.ndarray, ...]:
        self._data, out = self._step(self._data, self._goal, actions)
        return tuple(np.asarray(part) for part in out)


class L2f:
    """Its vector of environments at their 100 Hz: commands of motors, one step of integration, no sensors."""

    def __init__(self):
        import l2f

        self._device, self._v = l2f.Device(), l2f.vector_selector[VEHICLES]
        self._envs, self._random, self._parameters = self._v.VectorEnvironment(), self._v.VectorRng(), self._v.VectorParameters()
        self._state, self._next = self._v.VectorState(), self._v.VectorState()
        self._v.initialize_rng(self._device, self._random, 1)
        self._v.initialize_environment(self._device, self._envs)
        self._v.sample_initial_parameters(self._device, self._envs, self._parameters, self._random)
        self._v.sample_initial_state(self._device, self._envs, self._parameters, self._state, self._random)
        self._seen = np.zeros((VEHICLES, self._envs.OBSERVATION_DIM), np.float32)
        self._rewards, self._terminated = np.zeros(VEHICLES, np.float32), np.zeros(VEHICLES, bool)
        self._steps = np.zeros(VEHICLES, int)
        self.low, self.high = -np.ones(4, np.float32), np.ones(4, np.float32)

    def step(self, actions: np.ndarray) -> tuple[np.ndarray, ...]:
        world = (self._device, self._envs, self._parameters)
        self._v.step(*world, self._state, actions, self._next, self._random)
        self._v.reward(*world, self._state, actions, self._next, self._rewards, self._random)
        self._state, self._next = self._next, self._state
        self._v.terminated(*world, self._state, self._terminated, self._random)
        self._steps += 1
        truncated = self._steps >= self._envs.EPISODE_STEP_LIMIT
        ended = self._terminated | truncated
        self._v.sample_initial_state_if_truncated(*world, self._state, ended, self._random)
        self._steps[ended] = 0
        self._v.observe(*world, self._state, self._seen, self._random)
        return self._seen.copy(), self._rewards.copy(), self._terminated.copy(), truncated


PEERS = {"crazyflow": lambda: Crazyflow(rotors=False), "crazyflow_rotors": lambda: Crazyflow(rotors=True), "l2f": L2f}


def main():
    peer = PEERS[sys.argv[1]]()
    random = np.random.default_rng(1)
    actions = random.uniform(peer.low, peer.high, (STEPS, VEHICLES, 4)).astype(np.float32)
    for action in actions[:20]:  # compiles
        peer.step(action)
    for _ in sys.stdin:
        clock, processor = time.monotonic(), time.process_time()
        ends = 0
        for action in actions:
            _, _, terminated, truncated = peer.step(action)
            ends += int((terminated | truncated).sum())
        clock, processor = time.monotonic() - clock, time.process_time() - processor
        steps = STEPS * VEHICLES
        print(json.dumps({"per_s": steps / clock, "per_core_s": steps / processor, "ended": ends}), file=ANSWERS, flush=True)


if __name__ == "__main__":
    main()
