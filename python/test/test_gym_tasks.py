# SPDX-License-Identifier: BSD-3-Clause
"""What each task of the environments asks for: numbers by hand, and a controller of a few lines that can do it."""

import gymnasium
import numpy as np
import pytest
import rosflight

STILL = {"start_radius_m": 0.0, "start_tilt_rad": 0.0, "start_speed_m_s": 0.0, "start_rates_rad_s": 0.0}
SPEED, CLIMB, DESCENT = 8.0, 2.0, 1.5  #: Limits of vehicles/multirotor.yaml.


def make(name, **options):
    return gymnasium.make(f"rosflight/{name}-v0", **options).unwrapped


def velocity(v):
    """An action of the level `velocity`."""
    return np.clip([v[0] / SPEED, v[1] / SPEED, v[2] / (CLIMB if v[2] < 0 else DESCENT), 0], -1, 1).astype(np.float32)


def fly(env, policy, seed=1, steps=20_000):
    """@returns the rewards, how it ended and whether that was a success."""
    observation, _ = env.reset(seed=seed)
    rewards = []
    for _ in range(steps):
        observation, reward, terminated, truncated, info = env.step(policy(observation))
        rewards.append(reward)
        if terminated or truncated:
            return np.array(rewards), terminated, info["is_success"]
    raise AssertionError("the episode does not end")


# ---- actions ----------------------------------------------------------------------------------

def test_velocities_are_flown():
    env = make("Hover", action="velocity", **STILL)
    env.reset(seed=3)
    wanted = np.array([1.5, -1.0, -0.5])
    for _ in range(300):
        env.step(velocity(wanted))
    assert env.truth()[3:6] == pytest.approx(wanted, abs=0.1)


def test_a_waypoint_is_where_the_action_began():
    """One action of a second: 1 m north of where it began, at 5 m for a number of 1, and a heading of 90 degrees."""
    env = make("Hover", action="waypoint", rate_hz=1, episode_s=100, **STILL)
    env.reset(seed=3)
    begun = env.truth()[:3]
    env.step(np.array([0.2, 0, 0, 0.5], np.float32))
    moved = env.truth()[:3] - begun
    assert 0.3 < moved[0] < 1.1 and np.abs(moved[1:]).max() < 0.1
    for _ in range(10):  # here, now
        env.step(np.array([0, 0, 0, 0.5], np.float32))
    q = env.truth()[6:10]
    assert 2 * np.arctan2(q[3], q[0]) == pytest.approx(np.pi / 2, abs=0.02)
    assert np.linalg.norm(env.truth()[3:6]) < 0.05


def test_a_command_does_not_time_out_within_an_action():
    """The firmware discards a command after 0.1 s, an action may last longer."""
    env = make("Hover", action="rates", rate_hz=2, **STILL)
    env.reset(seed=3)
    env.step(np.zeros(4, np.float32))
    assert abs(env.truth()[5]) < 0.3  # without thrust it would fall at 2 m/s and more by now


@pytest.mark.parametrize("action", ["surfaces", "angles", "rates"])
def test_the_throttle_of_a_fixed_wing_is_the_same_at_each_level(action):
    """Half way from cruise (0.5) to none."""
    env = make("FixedWingLine", action=action, **STILL)
    env.reset(seed=3)
    env.step(np.array([-0.5, 0, 0, 0], np.float32))
    assert env.truth()[15 + 4] == pytest.approx(0.25, abs=0.01)


# ---- gates ------------------------------------------------------------------------------------

def race(observation, aside_m=0.0):
    """Through the opening, or beside its middle: along the gate's direction, and across to its axis."""
    to, forward = observation[:3].astype(float), observation[22:25].astype(float)
    to = to + aside_m * np.cross(forward, [0, 0, 1])
    ahead = forward @ to
    across = to - ahead * forward
    straight = np.linalg.norm(across) < 0.4
    return velocity(1.5 * across + forward * (2.0 if straight else 0.5))


def test_two_laps_through_the_gates_are_a_success():
    env = make("Gates", action="velocity", episode_s=200, start_tilt_rad=0.0, start_rates_rad_s=0.0)
    rewards, terminated, success = fly(env, race)
    assert terminated and success and env.truth()[14] == 12
    # 1 for each gate, and the way: between gates that stand 8 m apart, moved by up to 1.5 m each, less what was missed of their middle.
    assert 12 + 12 * (8 - 3) < rewards.sum() < 12 + 12 * (8 + 3)


def test_gates_stand_on_the_circle_that_the_page_states():
    env = make("Gates", **STILL)
    for seed in range(1, 30):
        observation, _ = env.reset(seed=seed)
        gate, forward = env.truth()[:3] + observation[:3], observation[22:25]
        assert abs(np.hypot(*gate[:2]) - 8) <= 1.5 and abs(gate[2] + 5) <= 1.5
        assert observation[:3] @ forward == pytest.approx(3.0, abs=1e-5)  # the start is 3 m before it
        tangent = abs(np.cross(np.append(gate[:2] / np.hypot(*gate[:2]), 0), forward)[2])
        # Turned by up to 30 degrees; a gate that is moved along the circle has another tangent there.
        assert tangent >= np.cos(np.radians(30) + np.arcsin(1.5 / 8)) - 1e-6
        assert np.linalg.norm(observation[25:28]) < 8 + 3 + 1e-5


@pytest.mark.parametrize("aside_m, hits", [(0.0, False), (0.5, False), (1.0, True), (1.7, True)])
def test_what_does_not_fit_through_the_opening_hits_the_frame(aside_m, hits):
    """Half an opening is 1.2 m, the frame 0.3 m, the vehicle's radius 0.44 m: 0.76 m to 1.94 m off the middle are a crash."""
    env = make("Gates", action="velocity", start_tilt_rad=0.0, start_rates_rad_s=0.0, episode_s=60)
    observation, _ = env.reset(seed=2)
    while env.truth()[14] == 0:
        observation, reward, terminated, _, info = env.step(race(observation, aside_m))
        if terminated:
            break
    assert terminated == hits
    if hits:
        assert reward < -1.5 and not info["is_success"]


def test_a_gate_backwards_does_not_count():
    """Round it at a distance, then through it from behind: no reward, no crash."""
    env = make("Gates", action="velocity", start_tilt_rad=0.0, start_rates_rad_s=0.0, episode_s=200)
    observation, _ = env.reset(seed=2)
    forward = observation[22:25].astype(float)
    side = np.cross(forward, [0, 0, 1])
    gate = env.truth()[:3] + observation[:3]
    for point in (gate - 3 * forward + 4 * side, gate + 3 * forward + 4 * side, gate + 3 * forward, gate - 3 * forward):
        for _ in range(5000):
            to = point - env.truth()[:3]
            if np.linalg.norm(to) < 0.3:
                break
            _, _, terminated, _, _ = env.step(velocity(1.0 * to))
            assert not terminated
        else:
            raise AssertionError("the point is not reached")
    assert env.truth()[14] == 0


# ---- landing ----------------------------------------------------------------------------------

def descend(speed_m_s):
    return lambda observation: velocity([observation[0], observation[1], speed_m_s])


def test_a_soft_landing_on_the_point_is_a_success():
    env = make("Landing", action="velocity", start_tilt_rad=0.0, start_rates_rad_s=0.0)
    rewards, terminated, success = fly(env, descend(0.5))
    v = env.truth()
    assert terminated and success and np.hypot(*v[:2]) < 0.5
    assert 5 / (1 + 0.5**2) / (1 + 0.5**2) - 0.5 < rewards[-1] < 5  # by the formula of the page


def test_a_fall_is_a_crash_at_the_time_of_a_fall():
    env = make("Landing", action="motors", altitude_m=3.0, **STILL)
    rewards, terminated, success = fly(env, lambda _: np.full(4, -1, np.float32))
    assert terminated and not success and rewards[-1] < -1.5
    fall_s = np.sqrt(2 * 3.0 / 9.80665)
    assert fall_s <= len(rewards) / 100 < fall_s + 0.3  # the rotors still turn at first


# ---- fixed wing -------------------------------------------------------------------------------

def follow(observation):
    """Roll by the way across the line, pitch by the altitude, throttle by the airspeed."""
    to, v, forward, airspeed = observation[:3], observation[3:6], observation[22:25], observation[25]
    right = np.cross([0, 0, 1], forward)
    course = np.arctan2(v @ right, v @ forward)
    wanted = np.arctan(0.04 * (to @ right))
    roll = np.clip(1.2 * (wanted - course), -0.6, 0.6)
    pitch = np.clip(0.05 - 0.03 * to[2] + 0.03 * v[2], -0.3, 0.3)
    return np.clip([0.3 * (15 - airspeed), roll / np.pi * 4, pitch / np.pi * 4, 0], -1, 1).astype(np.float32)


def test_a_line_is_followed():
    rewards, terminated, success = fly(make("FixedWingLine", action="angles"), follow)
    assert success and not terminated and rewards.sum() > 20  # of 30 on the line all the time


CRUISE, SLOWEST, FASTEST = 15.0, 13.25, 21.0  #: Of vehicles/anaconda.yaml and the defaults of its section `autonomy`.
CLIMB_SLOPE, DESCENT_SLOPE = 0.6 * np.tan(np.radians(15)), 0.6 * np.tan(np.radians(12))  #: Largest slopes of its paths.
RADIUS = 50.0  #: Of its turns.
REACH = np.array([2 * RADIUS, 2 * RADIUS, 2 * RADIUS * CLIMB_SLOPE])


def flown(numbers, seconds=20, off_deg=0.0, seed=3, **options):
    """A constant action at 1 Hz, of which `numbers` has the length of the first two, which lie `off_deg` beside the line, and the others.

    @returns what is true at the end: course less that of the action in degrees and velocity downwards, both of the last 5 s, airspeed, distance
    downwards from the start.
    """
    env = make("FixedWingLine", rate_hz=1, episode_s=1000, altitude_m=100, **STILL | options)
    observation, _ = env.reset(seed=seed)
    course = np.arctan2(observation[23], observation[22]) + np.radians(off_deg)
    action = np.array([numbers[0] * np.cos(course), numbers[0] * np.sin(course), *numbers[1:]], np.float32)
    first, positions, airspeeds = env.truth()[2], [], []
    for _ in range(seconds):
        observation, _, terminated, _, _ = env.step(action)
        assert not terminated
        positions.append(env.truth()[:3])
        airspeeds.append(observation[25])
    north, east, down = (positions[-1] - positions[-6]) / 5
    return off_course_deg((north, east), np.degrees(course)), down, np.mean(airspeeds[-5:]), positions[-1][2] - first


def off_course_deg(velocity, course_deg):
    return (np.degrees(np.arctan2(velocity[1], velocity[0])) - course_deg + 180) % 360 - 180


@pytest.mark.parametrize("off_deg, seed", [(-12, 1), (0, 2), (12, 3)])
@pytest.mark.parametrize("length, airspeed", [(0.2, SLOWEST + 0.2 * (FASTEST - SLOWEST)), (1.0, FASTEST)])
def test_the_velocity_of_a_fixed_wing_is_course_and_airspeed(off_deg, seed, length, airspeed):
    off, down, speed, sunk = flown((length, 0, 0), off_deg=off_deg, seed=seed, action="velocity")
    assert abs(off) < 1 and speed == pytest.approx(airspeed, abs=0.3) and abs(down) < 0.2 and abs(sunk) < 2


@pytest.mark.parametrize("number", [-0.8, 0.5])
def test_the_velocity_of_a_fixed_wing_climbs_and_descends(number):
    off, down, _, _ = flown((0.3, number, 0), action="velocity")
    wanted = (CLIMB_SLOPE if number < 0 else DESCENT_SLOPE) * number * (SLOWEST + 0.3 * (FASTEST - SLOWEST))
    assert down == pytest.approx(wanted, abs=0.15) and abs(off) < 1


def test_a_fixed_wing_flies_its_course_over_ground_in_wind():
    off, _, speed, _ = flown((0.3, 0, 0), action="velocity", wind=(4, 90))
    assert abs(off) < 1 and speed == pytest.approx(SLOWEST + 0.3 * (FASTEST - SLOWEST), abs=0.3)


def test_without_a_direction_a_fixed_wing_keeps_its_course():
    env = make("FixedWingLine", action="velocity", **STILL)
    observation, _ = env.reset(seed=3)
    before = np.degrees(np.arctan2(observation[4], observation[3]))
    for _ in range(1000):
        env.step(np.zeros(4, np.float32))
    assert abs(off_course_deg(env.truth()[3:6], before)) < 3


def test_a_fixed_wing_passes_the_waypoint_of_its_action():
    """Half the reach of two turn radii, north-east of the start and 4 m above it."""
    env = make("FixedWingLine", action="waypoint", rate_hz=1, episode_s=100, altitude_m=100, **STILL)
    env.reset(seed=3)
    point = env.truth()[:3] + np.array([RADIUS * np.sqrt(0.5), RADIUS * np.sqrt(0.5), -4.0])
    nearest = np.inf
    for _ in range(60):  # the same point, as seen from where the vehicle is
        to = (point - env.truth()[:3]) / REACH
        env.step(np.clip(np.append(to, 0), -1, 1).astype(np.float32))
        nearest = min(nearest, np.linalg.norm(point - env.truth()[:3]))
    assert nearest < 15  # a step is 15 m


@pytest.mark.parametrize("fourth, airspeed", [(-1, SLOWEST), (0, CRUISE), (1, FASTEST)])
def test_a_waypoint_ahead_is_a_straight_flight(fourth, airspeed):
    off, down, speed, sunk = flown((0.7, 0, fourth), off_deg=-10, action="waypoint")
    assert abs(off) < 1 and speed == pytest.approx(airspeed, abs=0.3) and abs(down) < 0.2 and abs(sunk) < 3


def test_a_waypoint_above_is_climbed_to():
    """15 m above the start: each action asks for the altitude that is left."""
    env = make("FixedWingLine", action="waypoint", rate_hz=1, episode_s=100, altitude_m=100, **STILL)
    env.reset(seed=3)
    for _ in range(30):
        env.step(np.array([1, 0, np.clip((-115 - env.truth()[2]) / REACH[2], -1, 1), 0], np.float32))
    assert env.truth()[2] == pytest.approx(-115, abs=1)


def test_a_line_is_followed_by_waypoints():
    """The point ahead on the line: what is left across and in altitude, over the reach."""
    def policy(observation):
        to, forward = observation[:3], observation[22:25]
        return np.clip(np.append((to + 60 * forward) / REACH, 0), -1, 1).astype(np.float32)

    rewards, terminated, success = fly(make("FixedWingLine", action="waypoint"), policy)
    assert success and not terminated and rewards.sum() > 20


def test_a_fixed_wing_begins_trimmed_in_the_wind():
    """Its airspeed is the cruise of 15 m/s, its ground speed that and the wind."""
    env = make("FixedWingLine", wind=(4, 270), **STILL)
    observation, _ = env.reset(seed=1)
    assert observation[25] == pytest.approx(15.0, abs=1e-4)
    air_W = observation[3:6] - np.array([0, 4, 0])
    assert np.linalg.norm(air_W) == pytest.approx(15.0, abs=1e-4) and abs(air_W[2]) < 1e-4  # level
    assert np.linalg.norm(observation[:3]) < 1e-4 and observation[22:25] @ observation[22:25] == pytest.approx(1.0, abs=1e-6)


def test_the_target_is_the_nearest_point_of_the_line():
    observation, _ = make("FixedWingLine").reset(seed=1)
    assert abs(observation[:3] @ observation[22:25]) < 1e-4
    assert np.linalg.norm(observation[:3]) <= 10


@pytest.mark.parametrize("name, options, said", [
    ("FixedWingLine", {"vehicle": "multirotor", "action": "rates"}, "vehicle: found multirotor, a multirotor, allowed a fixed wing"),
    ("FixedWingLine", {"action": "motors"}, "action: found 'motors' for anaconda, a fixed wing, allowed surfaces, rates, angles, velocity, waypoint"),
    ("Gates", {"vehicle": "anaconda"}, "vehicle: found anaconda, a fixed wing, allowed a multirotor"),
    ("Landing", {"action": "surfaces"}, "action: found 'surfaces' for multirotor, a multirotor, allowed motors, rates, angles, velocity, waypoint"),
    ("FixedWingLine", {"set": {"body.mass_kg": 12}}, "allowed one that can hold its cruise of 15 m/s: it needs more lift"),
    ("Landing", {"altitude_m": 0.5}, "altitude_m: found 0.5, allowed at least 1.0"),
])
def test_bad_options_are_one_line(name, options, said):
    with pytest.raises(ValueError) as raised:
        make(name, **options).reset(seed=1)
    assert said in str(raised.value) and "\n" not in str(raised.value)


def test_the_task_is_checked():
    from rosflight.gym import FlightEnv

    with pytest.raises(ValueError, match="task: found 'fly', allowed hover, waypoints, gates"):
        FlightEnv("fly")


def test_the_tasks_of_both_sides_are_the_same():
    from rosflight import _core, gym

    assert sorted(_core.tasks()) == sorted(gym.TASKS.values()) == sorted(gym.OF_TASK)
    assert rosflight.gym.TASKS.keys() <= gymnasium.registry.keys()
