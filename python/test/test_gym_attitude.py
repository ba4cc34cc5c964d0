# SPDX-License-Identifier: BSD-3-Clause
"""rosflight/Attitude-v0: the numbers that the learned controller of the firmware gets, the commands, the reward, and a law that can do it."""

import numpy as np
import pytest
from rosflight.gym import FlightEnv

MAX_RATES = np.array([3.14159, 3.14159, 1.507])  #: RC_MAX_ROLLRATE, RC_MAX_PITCHRATE, RC_MAX_YAWRATE
MAX_ANGLE = 0.786  #: RC_MAX_ROLL, RC_MAX_PITCH


def make(**options):
    return FlightEnv("attitude", **options)


def true_down(env):
    """Direction of gravity in the body, of the truth."""
    w, x, y, z = env.truth()[6:10]
    return np.array([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)])


def down_of(roll, pitch):
    return np.array([-np.sin(pitch), np.sin(roll) * np.cos(pitch), np.cos(roll) * np.cos(pitch)])


def angle(a, b):
    return np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b)


def law(observation):
    """Angles at 6 /s, and a yaw rate a third larger than asked for, as the rate loop is proportional."""
    d, c = observation[:3], observation[6:9]
    wanted = [6.0 * (c[0] - np.arctan2(d[1], d[2])), 6.0 * (c[1] + np.arcsin(np.clip(d[0], -1, 1))), 1.33 * c[2]]
    return np.clip(wanted / MAX_RATES, -1, 1).astype(np.float32)


def episode(env, policy, seed):
    """@returns observations before each action, and whether it was a success."""
    seen = [env.reset(seed=seed)[0]]
    while True:
        observation, _, terminated, truncated, info = env.step(policy(seen[-1]))
        if terminated or truncated:
            return np.array(seen), info["is_success"]
        seen.append(observation)


def test_an_episode_begins_level_with_zeros_for_the_last_outputs():
    env = make()
    observation, info = env.reset(seed=2)
    assert env.observation_space.shape == (12,) and env.action_space.shape == (3,)
    assert info["options"]["observation"] == "firmware"
    assert observation[:3] == pytest.approx([0, 0, 1], abs=2e-3)
    assert np.abs(observation[6:9]).max() > 0.01 and not observation[9:].any()


def test_the_estimate_of_the_firmware_is_observed_and_not_the_truth():
    env = make()
    observation, _ = env.reset(seed=2)
    tilts, rates = [], []
    for _ in range(300):
        action = law(observation)
        observation = env.step(action)[0]
        assert observation[9:] == pytest.approx(action, abs=1e-7)
        tilts.append(angle(observation[:3], true_down(env)))
        rates.append(observation[3:6] - env.truth()[10:13])
    assert 1e-4 < np.median(tilts) and np.max(tilts) < np.radians(4)
    assert 1e-3 < np.sqrt(np.mean(np.square(rates))) < 0.3  # noise and delay of the filtered gyro


def test_actions_beyond_the_limits_are_observed_as_limited():
    env = make()
    env.reset(seed=2)
    observation = env.step(np.array([3.0, -2.0, 0.5], np.float32))[0]
    assert np.array_equal(observation[9:], np.array([1, -1, 0.5], np.float32))


def test_commands_are_drawn_within_the_limits_and_the_last_one_lasts_a_second():
    commands = []
    env = make(episode_s=8.0)
    for seed in range(8):
        seen, _ = episode(env, law, seed)
        changes = np.flatnonzero(np.any(np.diff(seen[:, 6:9], axis=0), axis=1)) + 1
        lasted_s = np.diff(np.concatenate([[0], changes, [len(seen)]])) / 100
        assert lasted_s[:-1].min() >= 0.5 - 0.011 and lasted_s[:-1].max() <= 2.0 + 0.011 and 1.0 - 0.011 <= lasted_s[-1] <= 3.01
        commands += [seen[0, 6:9], *seen[changes, 6:9]]
    largest = np.abs(commands).max(axis=0)
    assert (largest <= [MAX_ANGLE + 1e-6, MAX_ANGLE + 1e-6, 0.7 * MAX_RATES[2] + 1e-6]).all() and (largest > [0.4, 0.4, 0.8]).all()


def test_the_reward_is_for_the_true_errors():
    env = make(rate_hz=50)
    observation, _ = env.reset(seed=4)
    for _ in range(60):
        command = observation[6:9]
        observation, reward, *_ = env.step(law(observation))
        w = env.truth()[10:13]
        tilt = angle(true_down(env), down_of(*command[:2])) / 0.1
        yaw = abs(w[2] - command[2]) / 0.2
        assert reward == pytest.approx(0.02 * (1 / (1 + tilt) + 0.5 / (1 + yaw) - 0.02 * w @ w), abs=1e-6)


def test_a_law_of_attitude_control_succeeds_and_doing_nothing_does_not():
    # Proportional loops leave an error; of stiffer ones it is half as large.
    env = make(set={"vehicle.firmware.PID_ROLL_RATE_P": 0.14, "vehicle.firmware.PID_PITCH_RATE_P": 0.14})
    succeeded = [episode(env, law, seed)[1] for seed in range(20)]
    idle = [episode(env, lambda _: np.zeros(3, np.float32), seed)[1] for seed in range(20)]
    assert np.mean(succeeded) >= 0.55 and np.mean(idle) <= 0.15


@pytest.mark.parametrize("options, said", [
    ({"observation": "truth"}, "observation: found 'truth', allowed firmware"),
    ({"action": "motors"}, "action: found 'motors', allowed rates"),
    ({"link": True}, "link: found True with observation 'firmware', allowed False"),
    ({"vehicle": "anaconda"}, "vehicle: found anaconda, a fixed wing, allowed a multirotor"),
])
def test_bad_options_are_one_line(options, said):
    with pytest.raises(ValueError) as raised:
        make(**options).reset(seed=1)
    assert said in str(raised.value) and "\n" not in str(raised.value)


def test_the_observation_of_the_firmware_is_for_this_task_alone():
    with pytest.raises(ValueError, match="observation: found 'firmware', allowed truth, estimate, sensors"):
        FlightEnv("hover", observation="firmware")


def test_four_numbers_are_no_action():
    env = make()
    env.reset(seed=1)
    with pytest.raises(ValueError, match=r"actions: found shape \(4,\) of float32, allowed \(3,\) of float32"):
        env.step(np.zeros(4, np.float32))
