# SPDX-License-Identifier: BSD-3-Clause
"""Vehicles of an environment that differ: values drawn from the distributions of a YAML file, for each vehicle its own."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Callable

from . import _arguments as arguments
from . import _core, _flight
from ._flight import STEPS_PER_SECOND
from .campaign import _draws as draws
from .campaign import _yaml
from .campaign._configuration import WIND
from .campaign._draws import Drawn
from .campaign._yaml import Value

KEYS = ("set", "wind", "action_delay_s")
KINDS = ("uniform", "normal", "choice")
_RARE = 1e-6


def steps_of(delay_s: float) -> int:
    return round(delay_s * STEPS_PER_SECOND)


class Variation:
    """A file. What vehicle k of a seed has is a function of the file, the seed and k."""

    def __init__(self, file: str, vehicle: str, overrides: list[str]):
        """@param overrides: of all vehicles; those of the file come after them."""
        self._values: dict[str, Value] = {}
        self._draws: dict[str, draws.Draw] = {}
        self._constant: list[str] = []  # overrides that are lists
        root, _ = _yaml.load(Path(file))
        found = root.entries(KEYS)
        if not found:
            root.fail(f"found no key, allowed {', '.join(KEYS)}")
        _flight.check(vehicle, set=overrides)
        for key, value in (found["set"].entries() if "set" in found else {}).items():
            self._read_override(key, value, vehicle, overrides)
        if "wind" in found:
            self._read_wind(found["wind"])
        if "action_delay_s" in found:
            self._read("action_delay_s", found["action_delay_s"], float)
            for delay in self._extremes("action_delay_s"):
                if not 0 <= float(delay) <= arguments.MAX_DELAY_S:
                    found["action_delay_s"].fail(f"found {delay:g}, allowed 0 to {arguments.MAX_DELAY_S:g} s")

    # ---- reading ----

    def _read(self, name: str, value: Value, wanted: type | None) -> None:
        draw = draws.read(value, wanted)
        if isinstance(draw, draws.Grid) or (isinstance(draw, draws.Uniform) and draw.sobol):
            value.fail(f"found {'grid' if isinstance(draw, draws.Grid) else 'sobol'}, allowed {', '.join(KINDS)}")
        self._values[name], self._draws[name] = value, draw

    def _read_override(self, key: str, value: Value, vehicle: str, overrides: list[str]) -> None:
        name = f"set.{key}"
        if value.is_list():
            text = f"{key}=" + arguments.number_text(key, [one.number() for one in value.elements()])
            self._constant.append(text)
            _ask(value, lambda: _flight.check(vehicle, set=[*overrides, text]))
            return
        self._read(name, value, None)
        for drawn in self._extremes(name):
            _ask(value, lambda: _flight.check(vehicle, set=[*overrides, f"{key}={arguments.number_text(name, drawn)}"]))

    def _read_wind(self, wind: Value) -> None:
        found = wind.entries(WIND)
        for key in ("speed_m_s", "from_deg"):
            if key not in found:
                wind.fail(f"found no key '{key}', which is required")
        for key, value in found.items():
            self._read(f"wind.{key}", value, float)
        usual = {name: next(self._extremes(name)) for name in self._draws if name.startswith("wind.")}
        for key, value in found.items():
            for drawn in self._extremes(f"wind.{key}"):
                text = _wind(usual | {f"wind.{key}": drawn})
                _ask(value, lambda: _flight.check(wind=text))

    def _extremes(self, name: str) -> Iterator[Drawn]:
        """Every value of a choice; of a distribution the ends, or what is rarer than one in a million beyond them."""
        draw = self._draws[name]
        if isinstance(draw, draws.Constant):
            yield draw.value
        elif isinstance(draw, (draws.Choice, draws.Grid)):
            yield from draw.values
        elif isinstance(draw, draws.Uniform):
            yield from (draw.low, draw.high)
        else:
            yield from (draw.at(_RARE), draw.at(1 - _RARE))

    # ---- drawing ----

    def draw(self, seed: int, vehicle: int) -> dict[str, Drawn]:
        """The values of one vehicle by their names, such as `set.body.mass_kg`."""
        return {name: draw.value if isinstance(draw, draws.Constant) else draw.at(draws.unit(f"{name}/{vehicle}", seed))
                for name, draw in self._draws.items() if not isinstance(draw, draws.Grid)}

    def individual(self, drawn: dict[str, Drawn], delay_s: float) -> _core.Individual:
        """@param delay_s: where the file has none."""
        overrides = [f"{name.removeprefix('set.')}={arguments.number_text(name, value)}" for name, value in drawn.items()
                     if name.startswith("set.")]
        wind = _wind(drawn) if "wind.speed_m_s" in drawn else None
        return _core.Individual(self._constant + overrides, wind, steps_of(float(drawn.get("action_delay_s", delay_s))))


def _wind(drawn: dict[str, Drawn]) -> str:
    return ",".join(arguments.number_text("wind", drawn[f"wind.{key}"]) for key in WIND if f"wind.{key}" in drawn)


def _ask(value: Value, check: Callable[[], object]) -> None:
    try:
        check()
    except ValueError as error:
        text = str(error)
        value.fail(text[text.index("found "):] if "found " in text else text)
