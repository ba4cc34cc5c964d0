#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Usage: train_policy.py FILE

Makes the weights of policy.py: a network with one hidden layer learns what a controller does (behaviour cloning).

    h = tanh(A x + a),   u = B h + b                                   (1)
    B = argmin sum |B h(x_k) + b - teacher(x_k)|^2 + r |B|^2            (2)

A and a are drawn once, with a fixed seed; (2) is linear least squares over states drawn around hover, so no step size, and the
same weights on every machine to rounding. Put a teacher of your own, or weights of your own training, in its place: policy.py reads
A, a, B, b and the scales of inputs and outputs from the file.
"""

import sys

import numpy

# Inputs, and how far the network has seen them: position error forward, right, down [m]; velocity forward, right, down [m/s];
# roll, pitch, heading error [rad]; body rates [rad/s]; integral of the error down [m s].
REACH = numpy.array([2.0, 2.0, 2.0, 2.5, 2.5, 2.0, 0.5, 0.5, 0.8, 2.0, 2.0, 1.5, 1.0])
HIDDEN, SAMPLES, RIDGE, SEED = 96, 12000, 1e-4, 7
GRAVITY_M_S2 = 9.80665


def teacher(x):
    """Mixer inputs of a quadrotor without motor model (USE_MOTOR_PARAM 0): throttle 0 to 1, roll, pitch, yaw torque in its units.

    Position error to acceleration, acceleration to angles, angles to torques, as the loops of vehicles/multirotor.yaml do."""
    error, velocity, attitude, rates, integral = x[:, 0:3], x[:, 3:6], x[:, 6:9], x[:, 9:12], x[:, 12]
    wanted = 2.0 * (1.6 * numpy.tanh(0.7 * error) - velocity)
    pitch = 0.35 * numpy.tanh(-wanted[:, 0] / GRAVITY_M_S2 / 0.35)
    roll = 0.35 * numpy.tanh(wanted[:, 1] / GRAVITY_M_S2 / 0.35)
    lift = 1.0 - (wanted[:, 2] + 0.8 * integral) / GRAVITY_M_S2
    return numpy.stack([0.48 * lift, 1.0 * (roll - attitude[:, 0]) - 0.14 * rates[:, 0],
                        1.0 * (pitch - attitude[:, 1]) - 0.14 * rates[:, 1],
                        0.5 * (1.2 * attitude[:, 2] - rates[:, 2])], axis=1)


def train():
    draw = numpy.random.default_rng(SEED)
    hidden = draw.normal(0.0, 0.15, (HIDDEN, len(REACH)))
    bias = draw.uniform(-0.3, 0.3, HIDDEN)
    states = draw.uniform(-1.0, 1.0, (SAMPLES, len(REACH))) * REACH
    wanted = teacher(states)
    scale = wanted.std(axis=0)
    layer = numpy.hstack([numpy.tanh((states / REACH) @ hidden.T + bias), numpy.ones((SAMPLES, 1))])
    weights = numpy.linalg.solve(layer.T @ layer + RIDGE * numpy.eye(HIDDEN + 1), layer.T @ (wanted / scale)).T
    return {"A": hidden, "a": bias, "B": weights[:, :-1], "b": weights[:, -1], "input_scale": REACH, "output_scale": scale}


def network(made, states):
    """(1), for rows of states."""
    return (numpy.tanh((states / made["input_scale"]) @ made["A"].T + made["a"]) @ made["B"].T + made["b"]) * made["output_scale"]


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(f"train_policy.py: found {len(sys.argv) - 1} arguments, allowed FILE")
    with open(sys.argv[1], "wb") as file:
        numpy.savez(file, **train())
