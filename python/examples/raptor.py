# SPDX-License-Identifier: BSD-3-Clause
"""A policy that knows nothing of this project flies the firmware: RAPTOR (PyPI foundation-policy) commands the motors at 100 Hz.

raptor.py [SEEDS] [truth|estimate]. Start: within 1 m of the target, tilted by up to 60 degrees, up to 2 m/s and 3 rad/s. Success: within
0.3 m of the target and 5 degrees of level in the last 3 of 10 s. Ends with 1 if fewer than 19 of 20 succeed.

On the truth the start is drawn. With `estimate` the policy has what a companion estimates from the link, and its commands are bytes there.
A jump would contradict the sensors, so the vehicle hovers within 1 m, nose anywhere, and its motors then throw it off: by 17 to 42 degrees,
0.2 to 0.8 m/s and 1 to 3.5 rad/s. Success is of the truth either way.

This is the one place where its conventions meet ours. RAPTOR: axes front-left-up in body and world, rotation matrix from body to world,
motors front right, rear right, rear left, front left, -1 off to 1 full. Ours: front-right-down and north-east-down; outputs 0 to 3 of the
default multirotor are in the same order, 0 to 1. Turning either frame about its front axis by 180 degrees leads from one to the other.
Its world is turned so that its front axis is the heading at the start, which it then holds: it does not recover from headings of more
than 140 degrees off, whatever the altitude.
"""

import sys
from typing import NamedTuple

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


def heading_frame(R: NDArray[np.float64]) -> NDArray[np.float64]:
    """The matrix from north-east-down to RAPTOR's world. @param R: of the attitude at the start."""
    north, east = R[:2, 0]
    length = np.hypot(north, east)
    return np.asarray(TURN @ np.array([[north, east, 0], [-east, north, 0], [0, 0, length]]) / length)


class State(NamedTuple):
    offset_m: NDArray[np.float64]  #: Position from the target.
    velocity_m_s: NDArray[np.float64]
    R: NDArray[np.float64]  #: From the body to north-east-down.
    rates_rad_s: NDArray[np.float64]

    def seen(self, frame: NDArray[np.float64], last_action: NDArray[np.float32]) -> NDArray[np.float32]:
        """RAPTOR's observation: position from the target, rotation matrix, velocity, rates, last action."""
        R = frame @ self.R @ TURN
        return np.concatenate([frame @ self.offset_m, R.ravel(), frame @ self.velocity_m_s, TURN @ self.rates_rad_s, last_action],
                              dtype=np.float32)

    def tilt_deg(self) -> float:
        return float(np.degrees(np.arccos(np.clip(self.R[2, 2], -1, 1))))


def true_state(env: FlightEnv) -> State:
    p, v, q, w = np.split(env.truth()[:13], [3, 6, 10])
    return State(p - TARGET_W, v, rotations(q[None])[0], w)


def estimated_state(observation: NDArray[np.float32]) -> State:
    to_target, v, R, w = np.split(observation[:18].astype(float), [3, 6, 15])
    return State(-to_target, v, R.reshape(3, 3), w)


def throw(env: FlightEnv, seed: int) -> NDArray[np.float32]:
    """Front against rear and right against left for 0.1 s, then all as in hover for 0.17 s. @returns the last observation."""
    random = np.random.default_rng(seed)
    roll, pitch = random.uniform(0.04, 0.14) * np.array([np.cos(turn := random.uniform(0, 2 * np.pi)), np.sin(turn)])
    hover = 2 * env.truth()[15:19] - 1
    kick = hover + 2 * roll * np.array([-1, -1, 1, 1]) + 2 * pitch * np.array([1, -1, -1, 1])
    for k in range(27):
        observation, *_ = env.step((kick if k < 10 else hover).astype(np.float32))
    return observation


def fly(seed: int, on_estimate: bool) -> tuple[float, float]:
    """@returns largest distance [m] and tilt [degrees] in the last seconds. What ends an episode does not end the flight: a vehicle that
    has crashed is far away in the end."""
    env = FlightEnv("hover", action="motors", rate_hz=RATE_HZ, start_radius_m=1.0, start_tilt_rad=np.radians(60), start_speed_m_s=2.0,
                    start_rates_rad_s=3.0, link=on_estimate, observation="estimate" if on_estimate else "truth")
    observation, _ = env.reset(seed=seed)
    if on_estimate:
        observation = throw(env, seed)
    policy = Raptor()
    policy.reset()
    action = np.zeros(4, np.float32)
    state = estimated_state(observation) if on_estimate else true_state(env)
    frame = heading_frame(state.R)
    distances, tilts = [], []
    for _ in range(round(SECONDS * RATE_HZ)):
        action = np.clip(policy.evaluate_step(state.seen(frame, action)[None])[0], -1, 1).astype(np.float32)
        observation, *_ = env.step(action)
        truth = true_state(env)
        state = estimated_state(observation) if on_estimate else truth
        distances.append(float(np.linalg.norm(truth.offset_m)))
        tilts.append(truth.tilt_deg())
    return max(distances[-LAST:]), max(tilts[-LAST:])


def main(seeds: int, source: str) -> int:
    if source not in ("truth", "estimate"):
        print(f"raptor.py: found {source!r}, allowed truth, estimate", file=sys.stderr)
        return 2
    good = 0
    for seed in range(1, seeds + 1):
        distance_m, tilt_deg = fly(seed, source == "estimate")
        success = distance_m < 0.3 and tilt_deg < 5
        good += success
        print(f"seed {seed:2d}: {distance_m:.3f} m, {tilt_deg:.2f} degrees at most in the last 3 s{'' if success else '  FAILED'}")
    print(f"{good} of {seeds} succeed")
    return 0 if good >= 0.95 * seeds else 1


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 20, sys.argv[2] if len(sys.argv) > 2 else "truth"))
