# SPDX-License-Identifier: BSD-3-Clause
"""A policy for the firmware's learned controller, by imitation: a network learns a law of attitude control from samples of it.

    attitude_policy.py FILE.onnx [--samples N] [--seed S]

The law turns roll and pitch towards their commands at GAIN times the error, and yaw at the commanded rate. The network has two layers
of 64 (tanh) and a tanh at its outputs, so these are always in range. Prints the rms of its error. FILE is for ROSFLIGHT_POLICY.
"""

from __future__ import annotations

import argparse
import sys

import numpy as np
import onnx
from export_policy import model_of
from numpy.typing import NDArray
from ppo import Adam, Network

Array = NDArray[np.float32]

GAIN = 7.0  #: 1/s
MAX_RATES = np.array([3.14159, 3.14159, 1.507])  #: RC_MAX_ROLLRATE, RC_MAX_PITCHRATE, RC_MAX_YAWRATE [rad/s]
MAX_ANGLE, MAX_TILT, SPREAD_RATE = 0.786, 1.2, 1.5  #: Commands up to RC_MAX_ROLL and attitudes [rad], spread of the rates [rad/s].
MAX_OUTPUT = 0.95  #: A tanh does not reach 1.
RATE_HZ = 100
INPUTS, OUTPUTS, BATCH, RATE = 12, 3, 512, 2e-3


def samples(random: np.random.Generator, n: int) -> tuple[Array, Array]:
    """Inputs as the firmware gives them (firmware/core/policy.hpp), and outputs by the law."""
    roll, pitch = random.uniform(-MAX_TILT, MAX_TILT, (2, n))
    commands = random.uniform([-MAX_ANGLE, -MAX_ANGLE, -MAX_RATES[2]], [MAX_ANGLE, MAX_ANGLE, MAX_RATES[2]], (n, 3))
    down = np.stack([-np.sin(pitch), np.sin(roll) * np.cos(pitch), np.cos(roll) * np.cos(pitch)], axis=1)
    rates = SPREAD_RATE * random.standard_normal((n, 3))
    last = random.uniform(-1, 1, (n, OUTPUTS))
    wanted = np.stack([GAIN * (commands[:, 0] - roll), GAIN * (commands[:, 1] - pitch), commands[:, 2]], axis=1) / MAX_RATES
    inputs = np.concatenate([down, rates, commands, last], axis=1)
    return inputs.astype(np.float32), np.clip(wanted, -MAX_OUTPUT, MAX_OUTPUT).astype(np.float32)


def learn(count: int, seed: int) -> Network:
    random = np.random.default_rng(seed)
    network = Network([INPUTS, 64, 64, OUTPUTS], 0.1, random)
    adam = Adam(network.parameters)
    batches = max(1, count // BATCH)
    for k in range(batches):
        x, wanted = samples(random, BATCH)
        layers = network.layers(x)
        y = np.tanh(layers[-1])
        slope = (y - wanted) * (1 - y * y) / np.float32(BATCH)
        adam.step(network.gradients(layers, slope), RATE * (1 - k / batches))
    x, wanted = samples(random, 10_000)
    error = np.tanh(network(x)) - wanted
    print(f"rms of the error {np.sqrt((error * error).mean()):.4f} of the largest rate")
    return network


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", help="where the ONNX file goes")
    parser.add_argument("--samples", type=int, default=500_000)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    onnx.save(model_of(learn(given.samples, given.seed).parameters, RATE_HZ), given.file)
    return 0


if __name__ == "__main__":
    sys.exit(main())
