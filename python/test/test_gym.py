# SPDX-License-Identifier: BSD-3-Clause
"""The Gymnasium environments: Gymnasium's own checks, autoreset, repeatability, and what an action does."""

import subprocess
import sys
import warnings

import gymnasium
import numpy as np
import pytest
import rosflight
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

NAMES = ["rosflight/Hover-v0", "rosflight/Waypoints-v0", "rosflight/Gates-v0", "rosflight/Landing-v0", "rosflight/FixedWingLine-v0",
         "rosflight/Attitude-v0"]
LEVELS = {name: ("surfaces" if "FixedWing" in name else "motors", "rates", "angles", "velocity", "waypoint")
          for name in NAMES} | {"rosflight/Attitude-v0": ("rates",)}


def vector(name=NAMES[0], num_envs=3, **options):
    return gymnasium.make_vec(name, num_envs=num_envs, vectorization_mode="vector_entry_point", **options)


def fly(envs, steps, seed=4, actions_seed=0):
    """Everything that an environment says, as one array."""
    random = np.random.default_rng(actions_seed)
    rows = [envs.reset(seed=seed)[0].ravel()]
    for _ in range(steps):
        observations, rewards, terminated, truncated, _ = envs.step(random.uniform(-1, 1, envs.action_space.shape).astype(np.float32))
        rows.append(np.concatenate([observations.ravel(), np.ravel(rewards), np.ravel(terminated), np.ravel(truncated)]))
    return np.concatenate(rows)


@pytest.mark.parametrize("name, action", [(name, action) for name in NAMES for action in LEVELS[name]])
def test_the_checks_of_gymnasium_pass(name, action):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", message=".*(infinity|render|not within).*")
        check_env(gymnasium.make(name, action=action).unwrapped, skip_render_check=True)


@pytest.mark.parametrize("name", NAMES)
def test_a_seed_says_all(name):
    first = fly(gymnasium.make(name), 50)
    env = gymnasium.make(name)
    assert np.array_equal(first, fly(env, 50))
    assert np.array_equal(first, fly(env, 50))  # after other steps, in the same object
    assert not np.array_equal(first, fly(env, 50, seed=5))


@pytest.mark.parametrize("name", NAMES)
def test_the_number_of_threads_changes_nothing(name):
    options = {"num_envs": 5, "autoreset_mode": "SameStep", "episode_s": 0.2}
    assert np.array_equal(fly(vector(name, threads=1, **options), 60), fly(vector(name, threads=3, **options), 60))


def test_episodes_of_a_seed_differ_and_so_do_vehicles():
    envs = vector()
    starts = [envs.reset(seed=2)[0], envs.reset()[0]]
    assert len(np.unique(np.concatenate(starts)[:, 0])) == 6
    assert np.abs(np.concatenate(starts)[:, :3]).max() <= 1.0  # start_radius_m


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_it_does_what_the_vector_environment_of_gymnasium_does(name, mode):
    """Which steps the single environment one by one."""
    ours = vector(name, num_envs=1, episode_s=0.05, autoreset_mode=mode)
    theirs = gymnasium.make_vec(name, num_envs=1, vectorization_mode="sync", vector_kwargs={"autoreset_mode": AutoresetMode(mode)},
                                episode_s=0.05)
    assert ours.metadata["autoreset_mode"] is theirs.metadata["autoreset_mode"]
    assert ours.observation_space == theirs.observation_space and ours.action_space == theirs.action_space
    assert np.array_equal(ours.reset(seed=3)[0], theirs.reset(seed=3)[0])
    random = np.random.default_rng(1)
    for _ in range(17):
        action = random.uniform(-1, 1, ours.action_space.shape).astype(np.float32)
        mine, other = ours.step(action), theirs.step(action)
        assert all(np.array_equal(a, b) for a, b in zip(mine[:4], other[:4]))
        info, wanted = mine[4], {key: value for key, value in other[4].items() if key.lstrip("_") != "options"}
        assert info.keys() == wanted.keys()
        if "final_obs" in info:
            assert info["final_obs"].dtype == wanted["final_obs"].dtype == object
            assert np.array_equal(info["final_obs"][0], wanted["final_obs"][0])
            info, wanted = info["final_info"], wanted["final_info"]
        for key, value in wanted.items():
            assert np.array_equal(info[key], value) and info[key].dtype == np.asarray(value).dtype


def test_next_step_begins_again_in_the_step_after():
    envs = vector(episode_s=0.05)  # five steps
    assert envs.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    envs.reset(seed=1)
    ends = [envs.step(np.zeros((3, 4), np.float32)) for _ in range(7)]
    assert [end[3].all() for end in ends] == [False] * 4 + [True, False, False]
    assert (ends[5][1] == 0).all() and (ends[6][1] != 0).all()


def test_same_step_shows_the_last_observation():
    envs, whole = vector(episode_s=0.05, autoreset_mode="SameStep"), vector(episode_s=0.05)
    envs.reset(seed=1), whole.reset(seed=1)
    for _ in range(5):
        observations, _, _, truncated, info = envs.step(np.zeros((3, 4), np.float32))
        last = whole.step(np.zeros((3, 4), np.float32))[0]
    assert truncated.all() and info["_final_obs"].all()
    assert np.array_equal(np.stack(info["final_obs"]), last) and not np.array_equal(observations, last)


def test_without_autoreset_those_that_ended_are_reset_by_the_caller():
    envs = vector(episode_s=0.05, autoreset_mode="Disabled")
    envs.reset(seed=1)
    envs.step(np.zeros((3, 4), np.float32))
    envs.reset(options={"reset_mask": np.array([True, False, False])})
    for _ in range(4):
        truncated = envs.step(np.zeros((3, 4), np.float32))[3]
    assert truncated.tolist() == [False, True, True]
    with pytest.raises(gymnasium.error.ResetNeeded, match="an episode that has ended"):
        envs.step(np.zeros((3, 4), np.float32))
    envs.reset(options={"reset_mask": truncated})
    envs.step(np.zeros((3, 4), np.float32))


def test_wrappers_of_gymnasium_work():
    envs = gymnasium.wrappers.vector.RecordEpisodeStatistics(vector(episode_s=0.05, autoreset_mode="SameStep"))
    envs.reset(seed=1)
    for _ in range(5):
        info = envs.step(np.zeros((3, 4), np.float32))[4]
    assert (info["episode"]["l"] == 5).all()


@pytest.mark.parametrize("name", NAMES)
def test_the_single_vehicle_is_the_first_of_many(name):
    """Same seed, same vehicle, whatever flies beside it."""
    env, envs = gymnasium.make(name), vector(name)
    one, many = env.reset(seed=9)[0], envs.reset(seed=9)[0]
    assert np.array_equal(one, many[0])
    for _ in range(20):
        one, many = (each.step(np.zeros(each.action_space.shape, np.float32))[0] for each in (env, envs))
    assert np.array_equal(one, many[0])


def test_motors_get_the_outputs_that_are_asked_for():
    env = gymnasium.make(NAMES[0], action="motors", start_tilt_rad=0.0, start_rates_rad_s=0.0).unwrapped
    env.reset(seed=3)
    wanted = np.array([0.45, 0.55, 0.5, 0.6])
    env.step((2 * wanted - 1).astype(np.float32))
    assert env.truth()[15:19] == pytest.approx(wanted, abs=1e-3)


def test_rates_are_over_the_limits_of_the_firmware():
    env = gymnasium.make(NAMES[0], action="rates", start_tilt_rad=0.0, start_rates_rad_s=0.0, start_speed_m_s=0.0).unwrapped
    env.reset(seed=3)
    limit = rosflight.Simulation(start=False)
    limit.run(2.0)
    for _ in range(30):
        env.step(np.array([0, 0.2, -0.1, 0], np.float32))
    share = env.truth()[10:12] / [0.2 * limit.parameters["RC_MAX_ROLLRATE"], -0.1 * limit.parameters["RC_MAX_PITCHRATE"]]
    assert (share > 0.7).all() and (share < 1.05).all()  # the loop is proportional


def test_a_simple_controller_hovers():
    """Angles from the error of position and velocity, by hand: the interface is one that can be flown."""
    env = gymnasium.make(NAMES[0], action="angles").unwrapped
    observation, _ = env.reset(seed=1)
    total = 0.0
    for _ in range(1000):
        to, v, R = observation[:3], observation[3:6], observation[6:15].reshape(3, 3)
        forward, right = R[:2, 0] / np.linalg.norm(R[:2, 0]), np.array([-R[1, 0], R[0, 0]]) / np.linalg.norm(R[:2, 0])
        a = np.clip(1.0 * to - 1.6 * v, -3, 3) / 9.81
        roll, pitch = a[:2] @ right, -a[:2] @ forward
        action = np.clip([-1.5 * a[2], roll / 0.8, pitch / 0.8, 0], -1, 1).astype(np.float32)
        observation, reward, terminated, truncated, _ = env.step(action)
        total += reward
    assert truncated and not terminated and np.linalg.norm(observation[:3]) < 0.3
    assert total > 6.0  # of 10 at the target all the time


@pytest.mark.parametrize("options, kind, said", [
    ({"vehicle": "plane9"}, ValueError, "plane9"),
    ({"vehicle": "anaconda"}, ValueError, "vehicle: found anaconda, a fixed wing, allowed a multirotor"),
    ({"vehicle": "quadplane"}, ValueError, "vehicle: found quadplane, a quad-plane, allowed a multirotor or a fixed wing"),
    ({"action": "will"}, ValueError, "action: found 'will', allowed motors, surfaces, rates, angles, velocity, waypoint"),
    ({"rate_hz": 30}, ValueError, "rate_hz: found 30, allowed a divisor of 400"),
    ({"colour": "red"}, ValueError, "colour: found an unknown option, allowed vehicle, action"),
    ({"episode_s": float("nan")}, ValueError, "episode_s: found nan"),
    ({"start_radius_m": -1}, ValueError, "start_radius_m: found -1.0, allowed at least 0.0"),
    ({"start_radius_m": 50}, ValueError, "reset: found a start below the ground"),
    ({"threads": 0}, ValueError, "threads: found 0, allowed 1 to"),
    ({"num_envs": 0}, ValueError, "num_envs: found 0, allowed 1 to"),
    ({"render_mode": "human"}, ValueError, "render_mode"),
])
def test_bad_options_are_one_line(options, kind, said):
    from rosflight.gym import FlightVectorEnv

    with pytest.raises(kind) as raised:
        FlightVectorEnv(**{"num_envs": 8} | options).reset(seed=1)
    assert said in str(raised.value) and "\n" not in str(raised.value)


@pytest.mark.parametrize("actions, said", [
    (np.full((3, 4), np.nan, np.float32), "actions: found NaN or infinity"),
    (np.zeros((3, 5), np.float32), "actions: found shape (3, 5) of float32, allowed (3, 4) of float32"),
    (np.zeros((4, 3), np.float32), "actions: found shape (4, 3)"),
    (np.zeros((3, 4), complex), "of complex128"),
    (np.full((3, 4), "a"), "actions: found shape (3, 4) of <U1"),
])
def test_bad_actions_are_one_line_and_change_nothing(actions, said):
    envs = vector()
    envs.reset(seed=1)
    before = envs.truth()
    with pytest.raises(ValueError) as raised:
        envs.step(actions)
    assert said in str(raised.value) and "\n" not in str(raised.value)
    assert np.array_equal(before, envs.truth())


@pytest.mark.parametrize("mask", [np.array([1, 0, 0]), np.array([True]), "all"])
def test_a_bad_mask_is_one_line(mask):
    envs = vector()
    envs.reset(seed=1)
    with pytest.raises(ValueError, match="reset_mask: found shape"):
        envs.reset(options={"reset_mask": mask})


def test_a_step_needs_a_reset():
    with pytest.raises(gymnasium.error.ResetNeeded):
        vector().step(np.zeros((3, 4), np.float32))


def test_every_option_is_in_the_info():
    _, info = gymnasium.make(NAMES[0], action="motors", rate_hz=50).reset(seed=1)
    assert info["options"]["action"] == "motors" and info["options"]["rate_hz"] == 50
    assert {"vehicle", "episode_s", "task", "observation", "link", "wind"} <= info["options"].keys()


def test_without_gymnasium_the_package_works():
    script = "import sys; sys.modules['gymnasium'] = None; import rosflight; print(rosflight.vehicles()[0])"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_a_vehicle_takes_200_kb():
    """By the resident memory of a process of its own, after one set has been made."""
    measure = """if True:
        from pathlib import Path
        from rosflight.gym import FlightVectorEnv
        def made(count):
            envs = FlightVectorEnv(count)
            envs.reset(seed=1)
            return envs, 4096 * int(Path("/proc/self/statm").read_text().split()[1])
        first, before = made(4)
        second, after = made(256)
        print((after - before) / 256)
    """
    assert float(subprocess.run([sys.executable, "-c", measure], capture_output=True, text=True, check=True).stdout) <= 200e3
