# SPDX-License-Identifier: BSD-3-Clause
"""A policy that knows nothing of this project flies the firmware: RAPTOR (PyPI foundation-policy) commands the motors at 100 Hz.

raptor.py [SEEDS]. Start: within 1 m of the target, tilted by up to 60 degrees, up to 2 m/s and 3 rad/s. Success: within 0.3 m of the
target and 5 degrees of level in the last 3 of 10 s. Ends with 1 if fewer than 19 of 20 succeed.

This is the one place where its conventions meet ours. RAPTOR: axes front-left-up in body and world, rotation matrix from body to world,
motors front right, rear right, rear left, front left, -1 off to 1 full. Ours: front-right-down and north-east-down; outputs 0 to 3 of the
default multirotor are in the same order, 0 to 1. Turning either frame about its front axis by 180 degrees leads from one to the other.
Its world is turned so that its front axis is the heading at the start, which it then holds: it does not recover from headings of more
than 140 degrees off, whatever the altitude.
"""

import sys

import numpy as np
from foundation_policy import Raptor
from numpy.typing import NDArray
from rosflight.gym import FlightEnv

TURN = np.diag([1.0, -1.0, -1.0])  #: About the front axis: its own inverse.
TARGET_W = np.array([0.0, 0.0, -5.0])
RATE_HZ, SECONDS = 100, 10.0
LAST = 3 * RATE_HZ


def rotations(q: NDArray[np.float64]) -> NDArray[np.float64]:
    """Matrices of quaternions w, x, y, z."""
    w, x, y, z = q.T
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    return np.moveaxis(np.array(rows), 2, 0)


def heading_frame(truth: NDArray[np.float64]) -> NDArray[np.float64]:
    """The matrix from north-east-down to RAPTOR's world."""
    north, east = rotations(truth[None, 6:10])[0, :2, 0]
    length = np.hypot(north, east)
    return np.asarray(TURN @ np.array([[north, east, 0], [-east, north, 0], [0, 0, length]]) / length)


def observe(truth: NDArray[np.float64], frame: NDArray[np.float64], last_action: NDArray[np.float32]) -> NDArray[np.float32]:
    """RAPTOR's observation: position from the target, rotation matrix, velocity, rates, last action."""
    p, v, q, w = np.split(truth[:13], [3, 6, 10])
    R = frame @ rotations(q[None])[0] @ TURN
    return np.concatenate([frame @ (p - TARGET_W), R.ravel(), frame @ v, TURN @ w, last_action], dtype=np.float32)


def fly(seed: int) -> tuple[float, float]:
    """@returns largest distance [m] and tilt [degrees] in the last seconds. What ends an episode does not end the flight: a vehicle that
    has crashed is far away in the end."""
    env = FlightEnv("hover", action="motors", rate_hz=RATE_HZ, start_radius_m=1.0, start_tilt_rad=np.radians(60), start_speed_m_s=2.0,
                    start_rates_rad_s=3.0)
    env.reset(seed=seed)
    policy = Raptor()
    policy.reset()
    action = np.zeros(4, np.float32)
    frame = heading_frame(env.truth())
    distances, tilts = [], []
    for _ in range(round(SECONDS * RATE_HZ)):
        observation = observe(env.truth(), frame, action)
        action = np.clip(policy.evaluate_step(observation[None])[0], -1, 1).astype(np.float32)
        env.step(action)
        truth = env.truth()
        distances.append(float(np.linalg.norm(truth[:3] - TARGET_W)))
        tilts.append(float(np.degrees(np.arccos(np.clip(rotations(truth[None, 6:10])[0, 2, 2], -1, 1)))))
    return max(distances[-LAST:]), max(tilts[-LAST:])


def main(seeds: int) -> int:
    good = 0
    for seed in range(1, seeds + 1):
        distance_m, tilt_deg = fly(seed)
        success = distance_m < 0.3 and tilt_deg < 5
        good += success
        print(f"seed {seed:2d}: {distance_m:.3f} m, {tilt_deg:.2f} degrees at most in the last 3 s{'' if success else '  FAILED'}")
    print(f"{good} of {seeds} succeed")
    return 0 if good >= 0.95 * seeds else 1


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 20))
