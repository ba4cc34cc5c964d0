# SPDX-License-Identifier: BSD-3-Clause
"""A campaign file, read and checked: the flights that it stands for."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, NoReturn

from .. import _arguments as arguments
from .. import _flight
from . import _draws as draws
from . import _yaml
from ._draws import Drawn
from ._yaml import Value

KEYS = ("flights", "seed", "vehicle", "mission", "wind", "set", "faults", "state", "pilot", "criteria", "required", "worst_by")
WIND = ("speed_m_s", "from_deg", "w20_m_s")
OUTCOMES = ("mission_done", "landed_elsewhere", "hard_landing", "timeout", "crash")  #: From good to bad.
#: Numbers of a flight that criteria may name.
METRICS = ("waypoints_reached", "worst_waypoint_m", "tracking_rms_m", "tracking_max_m", "own_tracking_rms_m", "own_tracking_max_m",
           "touchdown_speed_m_s", "touchdown_tilt_deg", "touchdown_distance_m", "flight_time_s", "sim_time_s", "warnings", "errors")
MAX_FLIGHTS = 10_000_000
MAX_SEED = 2**63 - 1


@dataclass(frozen=True)
class Limit:
    """What one number of a flight has to keep to."""

    metric: str
    low: float
    high: float

    def broken(self, value: float) -> str | None:
        """What is wrong with it; None: nothing."""
        if math.isnan(value):
            return f"{self.metric}: none"
        if value > self.high:
            return f"{self.metric} {value:g} above {self.high:g}"
        return f"{self.metric} {value:g} below {self.low:g}" if value < self.low else None


@dataclass(frozen=True)
class Criteria:
    outcomes: tuple[str, ...]
    limits: tuple[Limit, ...]

    def broken(self, result: Mapping[str, Any]) -> list[str]:
        """Why a flight has not passed; empty: it has."""
        outcome = [] if result["outcome"] in self.outcomes else [str(result["outcome"])]
        return outcome + [text for limit in self.limits if (text := limit.broken(float(result[limit.metric])))]


@dataclass(frozen=True)
class Required:
    """What the campaign is judged by: the lower limit of the confidence interval."""

    success_rate: float | None
    confidence: float


@dataclass(frozen=True)
class Fault:
    key: str  #: In the file, such as `faults[0]`.
    probability: float


class Configuration:
    """A campaign file. The conditions of flight k are a function of the file and of its seed, `seed` + k."""

    def __init__(self, file: Path, *, check: bool = True):
        """@param check: whether its flights could be flown. One that has been flown may be of another commit."""
        self.file = file
        self.root, self.text = _yaml.load(file)
        found = self.root.entries(KEYS)
        self._values: dict[str, Value] = {}  # of what is drawn, by the name of the draw
        self.plan = draws.Plan()
        self.flights = _required(self.root, found, "flights").whole(1, MAX_FLIGHTS)
        self.first_seed = found["seed"].whole(0, MAX_SEED - MAX_FLIGHTS) if "seed" in found else 1
        for name, default in (("vehicle", "multirotor"), ("mission", "default")):
            self._read_draw(name, found.get(name), str, default)
        self._read_wind(found.get("wind"))
        self.overrides: dict[str, str] = {}  # constant ones
        for key, value in (found["set"].entries() if "set" in found else {}).items():
            self._read_override(key, value)
        self.faults = [self._read_fault(one) for one in found["faults"].elements()] if "faults" in found else []
        self.state = found["state"].one_of(("estimate", "truth")) if "state" in found else "estimate"
        self.pilot = found["pilot"].one_of(("hover", "idle")) if "pilot" in found else "hover"
        self.criteria = _read_criteria(found.get("criteria"))
        self.required = _read_required(found.get("required"))
        self.worst_by = found["worst_by"].one_of(METRICS) if "worst_by" in found else "tracking_max_m"
        self._check_counts(found["flights"])
        self.values = self.plan.table(self.first_seed, self.flights)
        self.files = self._check_flights() if check else {}

    # ---- reading ----

    def _read_draw(self, name: str, value: Value | None, wanted: type | None, default: Drawn | None = None) -> None:
        if value is not None:
            self._values[name] = value
            self.plan.draws[name] = draws.read(value, wanted)
        elif default is not None:
            self.plan.draws[name] = draws.Constant(default)

    def _read_wind(self, wind: Value | None) -> None:
        if wind is None:
            return
        found = wind.entries(WIND)
        _required(wind, found, "speed_m_s")
        self._read_draw("wind.speed_m_s", found["speed_m_s"], float)
        self._read_draw("wind.from_deg", found.get("from_deg"), float, 0.0)
        self._read_draw("wind.w20_m_s", found.get("w20_m_s"), float)

    def _read_override(self, key: str, value: Value) -> None:
        if value.is_list():
            self._values[f"set.{key}"] = value
            self.overrides[key] = "[" + ", ".join(arguments.number_text(key, one.number()) for one in value.elements()) + "]"
        else:
            self._read_draw(f"set.{key}", value, None)

    def _read_fault(self, value: Value) -> Fault:
        found = value.entries(("fault", "probability", "value", "at_s", "for_s"))
        for key in ("fault", "at_s"):
            _required(value, found, key)
        for key in ("fault", "value", "at_s", "for_s"):
            self._read_draw(f"{value.key}.{key}", found.get(key), str if key == "fault" else float)
        probability = found["probability"].number(0, 1) if "probability" in found else 1.0
        return Fault(value.key, probability)

    def _check_counts(self, flights: Value) -> None:
        if self.flights % self.plan.cells:
            flights.refuse(f"a multiple of {self.plan.cells}, the combinations of the grids")
        if len(self.plan.sobol) > draws.MAX_SOBOL:
            self._values[self.plan.sobol[draws.MAX_SOBOL]].fail(
                f"found {len(self.plan.sobol)} values from sobol, allowed {draws.MAX_SOBOL}")

    # ---- flights ----

    @property
    def seeds(self) -> range:
        return range(self.first_seed, self.first_seed + self.flights)

    def conditions(self, seed: int) -> dict[str, Drawn]:
        """What a flight is flown under, by the names of the columns."""
        k = seed - self.first_seed
        out = {name: values[k] for name, values in self.values.items() if not name.startswith("faults[")}
        return out | {"faults": " ".join(self._faults(seed))}

    def arguments(self, seed: int) -> dict[str, Any]:
        """The arguments of `rosflight.fly`."""
        k = seed - self.first_seed
        overrides = dict(self.overrides)
        overrides |= {name[len("set."):]: arguments.number_text(name, values[k])
                      for name, values in self.values.items() if name.startswith("set.")}
        return {"vehicle": self.values["vehicle"][k], "mission": self.values["mission"][k], "seed": seed, "wind": self._wind(k),
                "faults": self._faults(seed), "set": overrides, "state": self.state, "pilot": self.pilot}

    def _wind(self, k: int) -> str | None:
        numbers = [self.values[f"wind.{name}"][k] for name in WIND if f"wind.{name}" in self.values]
        return ",".join(arguments.number_text("wind", number) for number in numbers) or None

    def _faults(self, seed: int) -> list[str]:
        return [self._fault_text(fault.key, seed - self.first_seed) for fault in self.faults
                if draws.unit(f"{fault.key}.probability", seed) < fault.probability]

    def _fault_text(self, key: str, k: int) -> str:
        def part(name: str, before: str) -> str:
            values = self.values.get(f"{key}.{name}")
            return "" if values is None else before + arguments.number_text(name, values[k])

        return part("fault", "") + part("value", "=") + part("at_s", "@") + part("for_s", ":")

    # ---- checks by what reads the flights' arguments ----

    def _check_flights(self) -> dict[str, str]:
        """Refuses what no flight could be flown with, at its line. Returns the files that fly: name -> SHA-256."""
        files: dict[str, str] = {}
        for vehicle in sorted({str(value) for value in self.values["vehicle"]}):
            files |= self._check_vehicle(vehicle)
        return files

    def _check_vehicle(self, vehicle: str) -> dict[str, str]:
        flights = [k for k in range(self.flights) if self.values["vehicle"][k] == vehicle]
        files: dict[str, str] = {}
        for mission in sorted({str(self.values["mission"][k]) for k in flights}):
            try:
                texts = _flight.check(vehicle, mission)
            except ValueError as error:
                self._refuse("mission" if _is_about_mission(str(error), mission) else "vehicle", str(error))
            for name, text in zip((f"vehicle {vehicle}", f"mission {mission}"), texts):
                files[name] = hashlib.sha256(text.encode()).hexdigest()
        self._check_extremes(vehicle, str(self.values["mission"][flights[0]]), flights)
        return files

    def _check_extremes(self, vehicle: str, mission: str, flights: Sequence[int]) -> None:
        """The smallest and the largest of each drawn number, and every text."""
        for name, values in self.values.items():
            mine = [values[k] for k in flights]
            for k in _extremes(mine):
                flight = flights[k]
                if name.startswith("wind."):
                    self._ask(name, lambda: _flight.check(vehicle, mission, wind=self._wind(flight)))
                elif name.startswith("set."):
                    self._ask(name, lambda: _flight.check(vehicle, mission, set={name[len("set."):]: arguments.number_text(name, mine[k])}))
                elif name.startswith("faults["):
                    key = name.rpartition(".")[0]
                    self._ask(name, lambda: _flight.check(vehicle, mission, faults=self._fault_text(key, flight)))
        for key, text in self.overrides.items():
            self._ask(f"set.{key}", lambda: _flight.check(vehicle, mission, set={key: text}))

    def _ask(self, name: str, check: Callable[[], object]) -> None:
        try:
            check()
        except ValueError as error:
            self._refuse(name, str(error))

    def _refuse(self, name: str, error: str) -> NoReturn:
        """@param error  one line of "OPTION: found X, allowed Y", or of a file of its own with its line."""
        own = error.partition(":")[0] in ("vehicle", "mission") or name not in ("vehicle", "mission")
        text = error[error.index("found "):] if own and "found " in error else error
        if name in self._values:
            self._values[name].fail(text)
        raise _yaml.CampaignError(f"{self.file}: {name}: {text}")


def _is_about_mission(error: str, mission: str) -> bool:
    place = error.partition(":")[0]
    return place == "mission" or mission in place or "/missions/" in place


def _extremes(values: Sequence[Drawn]) -> list[int]:
    """Where each text, the smallest and the largest number stand."""
    numbers = [k for k, value in enumerate(values) if isinstance(value, float)]
    texts = {value: k for k, value in enumerate(values) if isinstance(value, str)}
    ends = {min(numbers, key=lambda k: values[k]), max(numbers, key=lambda k: values[k])} if numbers else set()
    return sorted({*texts.values(), *ends})


def _required(parent: Value, found: Mapping[str, Value], key: str) -> Value:
    if key not in found:
        parent.fail(f"found no key '{key}', which is required")
    return found[key]


def _read_criteria(value: Value | None) -> Criteria:
    if value is None:
        return Criteria(("mission_done",), ())
    found = value.entries(("outcome", *METRICS))
    outcomes: tuple[str, ...] = ("mission_done",)
    if "outcome" in found:
        allowed = found["outcome"]
        outcomes = tuple(one.one_of(OUTCOMES) for one in (allowed.elements() if allowed.is_list() else [allowed]))
    return Criteria(outcomes, tuple(_read_limit(name, limit) for name, limit in found.items() if name != "outcome"))


def _read_limit(name: str, value: Value) -> Limit:
    found = value.entries(("at_least", "at_most"))
    if not found:
        value.fail("found no limit, allowed at_least, at_most")
    low = found["at_least"].number() if "at_least" in found else -math.inf
    high = found["at_most"].number() if "at_most" in found else math.inf
    if low > high:
        value.fail(f"found at_least {low:g} above at_most {high:g}, allowed at most that")
    return Limit(name, low, high)


def _read_required(value: Value | None) -> Required:
    if value is None:
        return Required(None, 0.95)
    found = value.entries(("success_rate", "confidence"))
    rate = found["success_rate"].number(0, 1) if "success_rate" in found else None
    confidence = found["confidence"].number(0.5, 0.9999) if "confidence" in found else 0.95
    return Required(rate, confidence)
