# SPDX-License-Identifier: BSD-3-Clause
"""What a value of a campaign is drawn from.

Each draw is a function of the name of the value and the seed of the flight alone, so that a flight does not depend on others,
and a value that is added leaves the others as they were.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Union

import numpy as np
from scipy.special import ndtr, ndtri

from ._yaml import Value

Drawn = Union[float, str]
KINDS = ("uniform", "normal", "choice", "grid", "sobol")
MAX_SOBOL = 21201  #: Dimensions that SciPy has direction numbers for.


def unit(name: str, seed: int) -> float:
    """A number between 0 and 1, both excluded, uniform over the seeds: 52 bits of SHA-256 of name and seed."""
    digest = hashlib.sha256(f"{name}:{seed}".encode()).digest()
    return float(((int.from_bytes(digest[:8], "big") >> 12) + 0.5) / 2**52)


@dataclass(frozen=True)
class Constant:
    value: Drawn


@dataclass(frozen=True)
class Uniform:
    low: float
    high: float
    sobol: bool = False  #: Its u is a dimension of the Sobol sequence.

    def at(self, u: float) -> Drawn:
        return self.low + u * (self.high - self.low)


@dataclass(frozen=True)
class Normal:
    """Within limits it is the truncated normal distribution, by its inverse."""

    mean: float
    sigma: float
    low: float = -np.inf
    high: float = np.inf

    def at(self, u: float) -> Drawn:
        first, last = ndtr((np.array([self.low, self.high]) - self.mean) / self.sigma)
        return float(np.clip(self.mean + self.sigma * ndtri(first + u * (last - first)), self.low, self.high))


@dataclass(frozen=True)
class Choice:
    values: tuple[Drawn, ...]
    weights: tuple[float, ...]

    def at(self, u: float) -> Drawn:
        edges = np.cumsum(self.weights)
        return self.values[min(int(np.searchsorted(edges, u * edges[-1], side="right")), len(self.values) - 1)]


@dataclass(frozen=True)
class Grid:
    """Every value equally often: with other grids, every combination."""

    values: tuple[Drawn, ...]


Draw = Union[Constant, Uniform, Normal, Choice, Grid]


def _drawn(value: Value, wanted: type | None) -> Drawn:
    if wanted is float or (wanted is None and value.is_number()):
        return value.number()
    return value.text("a number or a text" if wanted is None else "a text")


def _pair(value: Value, what: str) -> tuple[float, float]:
    numbers = value.elements()
    if len(numbers) != 2:
        value.refuse(what)
    return numbers[0].number(), numbers[1].number()


def _ordered(value: Value, what: str = "[LOW, HIGH] with LOW below HIGH") -> tuple[float, float]:
    low, high = _pair(value, what)
    if not low < high:
        value.fail(f"found [{low:g}, {high:g}], allowed {what}")
    return low, high


def read(value: Value, wanted: type | None = None) -> Draw:
    """A number or a text; or a map with one of KINDS. @param wanted: float or str; None: both."""
    if not value.is_map():
        return Constant(_drawn(value, wanted))
    found = value.entries((*KINDS, "weights", "within"))
    kinds = [name for name in KINDS if name in found]
    if len(kinds) != 1:
        value.fail(f"found {' and '.join(kinds) or 'no distribution'}, allowed one of {', '.join(KINDS)}")
    kind = kinds[0]
    for option, owner in (("weights", "choice"), ("within", "normal")):
        if option in found and kind != owner:
            found[option].fail(f"found with {kind}, allowed with {owner}")
    if wanted is str and kind not in ("choice", "grid"):
        found[kind].fail(f"found {kind}, allowed choice, grid")
    if kind in ("uniform", "sobol"):
        return Uniform(*_ordered(found[kind]), sobol=kind == "sobol")
    if kind == "normal":
        return _normal(found)
    values = tuple(_drawn(one, wanted) for one in found[kind].elements())
    if kind == "grid":
        if len(set(values)) != len(values):
            found[kind].fail("found a value twice, allowed each once")
        return Grid(values)
    return Choice(values, _weights(found.get("weights"), len(values)))


def _normal(found: dict[str, Value]) -> Normal:
    mean, sigma = _pair(found["normal"], "[MEAN, STANDARD DEVIATION]")
    if sigma <= 0:
        found["normal"].fail(f"found the standard deviation {sigma:g}, allowed above 0")
    low, high = _ordered(found["within"]) if "within" in found else (-np.inf, np.inf)
    if ndtr((high - mean) / sigma) - ndtr((low - mean) / sigma) < 1e-6:
        found["within"].fail(f"found [{low:g}, {high:g}], where normal has less than 1e-6 of its probability; allowed nearer to its mean")
    return Normal(mean, sigma, low, high)


def _weights(value: Value | None, count: int) -> tuple[float, ...]:
    if value is None:
        return (1.0,) * count
    weights = tuple(one.number(low=0) for one in value.elements())
    if len(weights) != count or sum(weights) <= 0:
        value.fail(f"found {len(weights)} of sum {sum(weights):g}, allowed {count} of a sum above 0")
    return weights


@dataclass
class Plan:
    """All drawn values of a campaign, by their names."""

    draws: dict[str, Draw] = field(default_factory=dict)

    @property
    def cells(self) -> int:
        """Combinations of the grids."""
        return int(np.prod([len(draw.values) for draw in self.draws.values() if isinstance(draw, Grid)], dtype=np.int64))

    @property
    def sobol(self) -> list[str]:
        return [name for name, draw in self.draws.items() if isinstance(draw, Uniform) and draw.sobol]

    def table(self, first_seed: int, flights: int) -> dict[str, Sequence[Drawn]]:
        """The values of each flight: name -> a value for each seed from the first on."""
        points = sobol_points(len(self.sobol), flights, first_seed)
        out: dict[str, Sequence[Drawn]] = {}
        stride = 1
        for name, draw in self.draws.items():
            if isinstance(draw, Grid):
                out[name] = [draw.values[(k // stride) % len(draw.values)] for k in range(flights)]
                stride *= len(draw.values)
            elif isinstance(draw, Constant):
                out[name] = [draw.value] * flights
            elif isinstance(draw, Uniform) and draw.sobol:
                out[name] = [draw.at(float(u)) for u in points[:, self.sobol.index(name)]]
            else:
                out[name] = [draw.at(unit(name, first_seed + k)) for k in range(flights)]
        return out


def sobol_points(dimensions: int, count: int, seed: int) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """The first points of the scrambled Sobol sequence of SciPy: a row each. The first of them do not depend on `count`."""
    if dimensions == 0:
        return np.empty((count, 0))
    from scipy.stats import qmc  # takes a second

    engine = qmc.Sobol(dimensions, scramble=True, rng=seed)
    return np.asarray(engine.random_base2(max(count - 1, 1).bit_length())[:count])
