# SPDX-License-Identifier: BSD-3-Clause
"""Gymnasium environments with the real firmware in the loop; `import rosflight` registers them where gymnasium is installed.

    env = gymnasium.make("rosflight/Hover-v0", action="rates")
    envs = gymnasium.make_vec("rosflight/Hover-v0", num_envs=64, vectorization_mode="vector_entry_point", threads=2)
"""

from __future__ import annotations

from copy import deepcopy
from typing import TYPE_CHECKING, Any, Union

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from . import _arguments as arguments
from . import _core
from ._flight import STEPS_PER_SECOND

if TYPE_CHECKING:
    from ._variation import Variation

Floats = np.ndarray[Any, np.dtype[np.float32]]
Flags = np.ndarray[Any, np.dtype[np.bool_]]

OBSERVATIONS = ("truth", "estimate", "sensors")
OF_FIRMWARE = ("attitude",)  #: Tasks whose observation is "firmware".
ACTIONS = ("motors", "surfaces", "rates", "angles", "velocity", "waypoint")
TASKS = {"rosflight/Hover-v0": "hover", "rosflight/Waypoints-v0": "waypoints", "rosflight/Gates-v0": "gates",
         "rosflight/FixedWingLine-v0": "fixed_wing_line", "rosflight/Landing-v0": "landing", "rosflight/Attitude-v0": "attitude"}
#: Options and their defaults.
OPTIONS: dict[str, Any] = {
    "vehicle": "multirotor", "action": "rates", "rate_hz": 100, "episode_s": 10.0, "threads": 1, "wind": None, "set": (), "altitude_m": 5.0,
    "start_radius_m": 1.0, "start_tilt_rad": 0.5, "start_speed_m_s": 1.0, "start_rates_rad_s": 1.0, "observation": "truth", "link": False,
    "action_delay_s": 0.0, "randomise": None,
}
#: Where a task has others.
OF_TASK: dict[str, dict[str, Any]] = {
    "hover": {},
    "waypoints": {},
    "gates": {"episode_s": 30.0, "start_radius_m": 0.5, "start_tilt_rad": 0.3},
    "landing": {"episode_s": 15.0, "start_radius_m": 2.0, "start_tilt_rad": 0.3, "start_rates_rad_s": 0.5},
    "fixed_wing_line": {"vehicle": "anaconda", "action": "surfaces", "episode_s": 30.0, "altitude_m": 50.0, "start_radius_m": 10.0,
                        "start_tilt_rad": 0.3, "start_rates_rad_s": 0.3},
    # The firmware begins each episode with the attitude of the ground.
    "attitude": {"observation": "firmware", "episode_s": 6.0, "altitude_m": 100.0, "start_tilt_rad": 0.0},
}
_LARGEST_SEED = 2**63


class _Vehicles:
    """Options of an environment, checked, and the vehicles that they describe. They are made with the first seed."""

    def __init__(self, count: int, task: str, options: dict[str, Any]):
        known = OPTIONS | OF_TASK[arguments.one_of("task", task, tuple(OF_TASK))]
        for name in options:
            if name not in known:
                raise ValueError(f"{name}: found an unknown option, allowed {', '.join(known)}")
        chosen = known | options
        rate_hz = arguments.whole("rate_hz", chosen["rate_hz"], 1, STEPS_PER_SECOND)
        if STEPS_PER_SECOND % rate_hz:
            raise ValueError(f"rate_hz: found {rate_hz}, allowed a divisor of {STEPS_PER_SECOND}")
        #: As they are in force; part of `info` at each reset.
        self.options: dict[str, Any] = chosen | {"task": task, "substeps": STEPS_PER_SECOND // rate_hz}
        by_firmware = task in OF_FIRMWARE
        observation = arguments.one_of("observation", chosen["observation"], ("firmware",) if by_firmware else OBSERVATIONS)
        if not isinstance(chosen["link"], bool):
            raise TypeError(f"link: found {chosen['link']!r}, allowed True, False")
        if by_firmware and chosen["link"]:
            raise ValueError("link: found True with observation 'firmware', allowed False")
        if observation not in ("truth", "firmware") and not chosen["link"]:
            raise ValueError(f"observation: found {observation!r} without a link, allowed with link=True")
        self._delay_s = arguments.at_least("action_delay_s", chosen["action_delay_s"], 0.0)
        if self._delay_s > arguments.MAX_DELAY_S:
            raise ValueError(f"action_delay_s: found {self._delay_s}, allowed 0 to {arguments.MAX_DELAY_S}")
        self.count = arguments.whole("num_envs", count, 1, 2**20)
        self.size, self.actions = _core.observation_size(task, observation), _core.action_size(task)
        self._arguments: dict[str, Any] = {
            "vehicle": arguments.name_or_path("vehicle", chosen["vehicle"]),
            "wind": arguments.wind_text(chosen["wind"]),
            "overrides": arguments.override_texts(chosen["set"]),
            "task": task,
            "action": arguments.one_of("action", chosen["action"], ("rates",) if by_firmware else ACTIONS),
            "count": self.count,
            "threads": arguments.whole("threads", chosen["threads"], 1, 1024),
            "observation": observation,
            "link": chosen["link"],
            "substeps": STEPS_PER_SECOND // rate_hz,
            "delay_steps": round(self._delay_s * STEPS_PER_SECOND),
            "episode_s": arguments.at_least("episode_s", chosen["episode_s"], 0.0025),
            "altitude_m": arguments.at_least("altitude_m", chosen["altitude_m"], 1.0),
            **{name: arguments.at_least(name, chosen[name], 0.0)
               for name in ("start_radius_m", "start_tilt_rad", "start_speed_m_s", "start_rates_rad_s")},
        }
        self._core: _core.Vehicles | None = None
        self._seed: int | None = None
        self._variation = self._read_variation(chosen["randomise"])
        #: What was drawn for each vehicle.
        self.drawn: dict[str, np.ndarray[Any, Any]] = {}

    def _read_variation(self, file: object) -> Variation | None:
        if file is None:
            return None
        path = arguments.name_or_path("randomise", file)
        try:
            from ._variation import Variation
        except ImportError as error:
            raise ImportError(f"randomise: found no {error.name}, allowed with rosflight[campaign] installed") from None
        return Variation(path, self._arguments["vehicle"], self._arguments["overrides"])

    def _make(self, seed: int) -> _core.Vehicles:
        individuals = []
        if self._variation is not None:
            drawn = [self._variation.draw(seed, k) for k in range(self.count)]
            self.drawn = {name: np.array([one[name] for one in drawn]) for name in drawn[0]}
            individuals = [self._variation.individual(one, self._delay_s) for one in drawn]
        return _core.Vehicles(**self._arguments, seed=seed, individuals=individuals)

    def info(self) -> dict[str, Any]:
        """What a reset returns beside the observation."""
        options = {"options": deepcopy(self.options)}
        return options if self._variation is None else options | {"drawn": {name: value.copy() for name, value in self.drawn.items()}}

    def reset(self, observations: Floats, seed: int | None, mask: Flags | None) -> None:
        """@param seed: of new vehicles, noise and episodes; None: these go on."""
        others = self._variation is not None and seed is not None and seed != self._seed
        if self._core is None or others:
            self._seed = int(np.random.SeedSequence().generate_state(1, np.uint64)[0]) if seed is None else seed
            self._core = self._make(self._seed)
        self._core.reset(observations, seed, mask)

    @property
    def core(self) -> _core.Vehicles:
        if self._core is None:
            raise gymnasium.error.ResetNeeded("step: found no episode, allowed after reset()")
        return self._core

    def truth(self) -> np.ndarray[Any, np.dtype[np.float64]]:
        out = np.empty((self.count, _core.TRUTH_COLUMNS))
        self.core.truth(out)
        return out


def _actions(value: object, shape: tuple[int, ...]) -> Floats:
    array = np.asarray(value)
    if array.shape != shape or array.dtype.kind not in "fiu":
        raise ValueError(f"actions: found shape {array.shape} of {array.dtype}, allowed {shape} of float32")
    return np.ascontiguousarray(array, np.float32)


def _seed(seed: object) -> int | None:
    return None if seed is None else arguments.whole("seed", seed, 0, _LARGEST_SEED)


def _spaces(vehicles: _Vehicles) -> tuple[Any, Any]:
    return spaces.Box(-np.inf, np.inf, (vehicles.size,), np.float32), spaces.Box(-1.0, 1.0, (vehicles.actions,), np.float32)


class FlightEnv(gymnasium.Env[Floats, Floats]):
    """One vehicle. docs/gymnasium/ has the observation, the action, the reward and the options of each task."""

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(self, task: str = "hover", render_mode: None = None, **options: Any):
        if render_mode is not None:
            raise ValueError(f"render_mode: found {render_mode!r}, allowed None")
        self._vehicles = _Vehicles(1, task, options)
        self.observation_space, self.action_space = _spaces(self._vehicles)
        self._observation = np.zeros((1, self._vehicles.size), np.float32)
        self._last = np.zeros_like(self._observation)
        self._reward = np.zeros(1, np.float32)
        self._terminated, self._truncated, self._success = np.zeros(1, bool), np.zeros(1, bool), np.zeros(1, bool)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Floats, dict[str, Any]]:
        super().reset(seed=seed)
        self._vehicles.reset(self._observation, _seed(seed), None)
        info = self._vehicles.info()
        if "drawn" in info:
            info["drawn"] = {name: value[0].item() for name, value in info["drawn"].items()}
        return self._observation[0].copy(), info

    def step(self, action: Floats) -> tuple[Floats, float, bool, bool, dict[str, Any]]:
        self._vehicles.core.step(_actions(action, (self._vehicles.actions,))[None], self._observation, self._reward, self._terminated, self._truncated,
                                 self._success, self._last, False, None)
        terminated, truncated = bool(self._terminated[0]), bool(self._truncated[0])
        info = {"is_success": bool(self._success[0])} if terminated or truncated else {}
        return self._observation[0].copy(), float(self._reward[0]), terminated, truncated, info

    def truth(self) -> np.ndarray[Any, np.dtype[np.float64]]:
        """Position 3, velocity 3, attitude 4 (w, x, y, z), rates 3, distance, waypoints or gates passed, outputs 14."""
        first: np.ndarray[Any, np.dtype[np.float64]] = self._vehicles.truth()[0]
        return first


class FlightVectorEnv(VectorEnv[Floats, Floats, Any]):
    """Many vehicles on a pool of threads, stepped without the interpreter's lock. The result does not depend on `threads`.

    autoreset_mode: NEXT_STEP, SAME_STEP (the last observations are info["final_obs"]) or DISABLED (reset with
    options={"reset_mask": mask}). With copy=False observations are arrays that the next step fills again.
    """

    def __init__(
        self,
        num_envs: int = 1,
        task: str = "hover",
        autoreset_mode: Union[AutoresetMode, str] = AutoresetMode.NEXT_STEP,
        copy: bool = True,
        render_mode: None = None,
        **options: Any,
    ):
        if render_mode is not None:
            raise ValueError(f"render_mode: found {render_mode!r}, allowed None")
        self._vehicles = _Vehicles(num_envs, task, options)
        self.num_envs = self._vehicles.count
        self._mode = AutoresetMode(autoreset_mode)
        self.metadata = {"render_modes": [], "autoreset_mode": self._mode}
        self.single_observation_space, self.single_action_space = _spaces(self._vehicles)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._copy = copy
        self._observations = np.zeros((self.num_envs, self._vehicles.size), np.float32)
        self._last = np.zeros_like(self._observations)
        self._rewards = np.zeros(self.num_envs, np.float32)
        self._terminated, self._truncated = np.zeros(self.num_envs, bool), np.zeros(self.num_envs, bool)
        self._success, self._ended = np.zeros(self.num_envs, bool), np.zeros(self.num_envs, bool)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Floats, dict[str, Any]]:
        """@param seed: one number, from which each vehicle has its own."""
        super().reset(seed=seed)
        mask = _mask(options, self.num_envs)
        if mask is not None and seed is not None:
            raise ValueError("reset: found a seed with a reset_mask, allowed one of them")
        self._vehicles.reset(self._observations, _seed(seed), mask)
        self._ended &= False if mask is None else ~mask
        return self._out(self._observations), self._vehicles.info()

    def step(self, actions: Floats) -> tuple[Floats, Floats, Flags, Flags, dict[str, Any]]:
        given = _actions(actions, (self.num_envs, self._vehicles.actions))
        if self._mode is AutoresetMode.DISABLED and self._ended.any():
            raise gymnasium.error.ResetNeeded("step: found an episode that has ended, allowed after a reset of it")
        self._vehicles.core.step(given, self._observations, self._rewards, self._terminated, self._truncated, self._success,
                                 self._last, self._mode is AutoresetMode.SAME_STEP,
                                 self._ended if self._mode is AutoresetMode.NEXT_STEP else None)
        self._ended = self._terminated | self._truncated
        info = self._info() if self._ended.any() else {}
        return (self._out(self._observations), self._out(self._rewards), self._terminated.copy(), self._truncated.copy(), info)

    def _info(self) -> dict[str, Any]:
        """Of the episodes that have ended, as gymnasium's own vector environments have it."""
        ended = self._ended.copy()
        info: dict[str, Any] = {"is_success": self._success & ended, "_is_success": ended}
        if self._mode is not AutoresetMode.SAME_STEP:
            return info
        last = np.full(self.num_envs, None, object)
        for k in np.flatnonzero(ended):
            last[k] = self._last[k].copy()
        return {"final_obs": last, "_final_obs": ended.copy(), "final_info": info, "_final_info": ended.copy()}

    def truth(self) -> np.ndarray[Any, np.dtype[np.float64]]:
        """A row for each vehicle, as FlightEnv.truth()."""
        return self._vehicles.truth()

    def _out(self, array: Floats) -> Floats:
        return array.copy() if self._copy else array


def _mask(options: dict[str, Any] | None, count: int) -> Flags | None:
    if not options or "reset_mask" not in options:
        return None
    mask = np.asarray(options["reset_mask"])
    if mask.shape != (count,) or mask.dtype != np.bool_:
        raise ValueError(f"reset_mask: found shape {mask.shape} of {mask.dtype}, allowed ({count},) of bool")
    return np.ascontiguousarray(mask)


def register() -> None:
    """Makes the environments known to gymnasium."""
    for name, task in TASKS.items():
        if name not in gymnasium.registry:
            gymnasium.register(name, entry_point="rosflight.gym:FlightEnv", vector_entry_point="rosflight.gym:FlightVectorEnv",
                               kwargs={"task": task})
