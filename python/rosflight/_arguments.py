# SPDX-License-Identifier: BSD-3-Clause
"""Checks and converts what callers give into what the C++ part takes: one line for each error."""

from __future__ import annotations

import math
import operator
import os
from collections.abc import Iterable, Mapping
from typing import Any, Union

Wind = Union[str, tuple[float, float], tuple[float, float, float]]
Overrides = Union[Mapping[str, Any], Iterable[str]]
MAX_DELAY_S = 0.09  #: A command counts for 0.1 s in the firmware, so a later one would leave gaps.


def whole(name: str, value: object, low: int, high: int = 2**64 - 1) -> int:
    try:
        number = operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        raise TypeError(f"{name}: found {value!r}, allowed a whole number") from None
    if isinstance(value, bool) or not low <= number <= high:
        raise ValueError(f"{name}: found {value!r}, allowed {low} to {high}")
    return number


def one_of(name: str, value: object, allowed: tuple[str, ...]) -> str:
    if value not in allowed:
        raise ValueError(f"{name}: found {value!r}, allowed {', '.join(allowed)}")
    return str(value)


def name_or_path(name: str, value: object) -> str:
    if not isinstance(value, (str, os.PathLike)):
        raise TypeError(f"{name}: found {value!r}, allowed a name or a path")
    return os.fspath(value) if isinstance(value, str) else str(value)


def number_text(name: str, value: object) -> str:
    """All digits of a number, as a vehicle file has it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return value
    if isinstance(value, Iterable):
        return "[" + ", ".join(number_text(name, one) for one in value) + "]"
    number = finite(name, value)
    return str(int(number)) if number.is_integer() and abs(number) < 1e15 else repr(number)


def wind_text(wind: Wind | None) -> str | None:
    if wind is None or isinstance(wind, str):
        return wind
    if not isinstance(wind, (tuple, list)):
        raise TypeError(f"wind: found {wind!r}, allowed (SPEED, FROM_DEG[, W20]) or the same as a text")
    return ",".join(number_text("wind", value) for value in wind)


def override_texts(overrides: Overrides) -> list[str]:
    """`{"body.mass_kg": 3.2}` or `["body.mass_kg=3.2"]`."""
    if isinstance(overrides, str):
        return [overrides]
    if isinstance(overrides, Mapping):
        return [f"{key}={number_text(f'set, {key}', value)}" for key, value in overrides.items()]
    return texts("set", overrides)


def texts(name: str, values: str | Iterable[str]) -> list[str]:
    if isinstance(values, str):
        return [values]
    if not isinstance(values, Iterable):
        raise TypeError(f"{name}: found {values!r}, allowed a text or a list of texts")
    found = list(values)
    for value in found:
        if not isinstance(value, str):
            raise TypeError(f"{name}: found {value!r}, allowed a text")
    return found


def finite(name: str, value: object) -> float:
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise TypeError(f"{name}: found {value!r}, allowed a number") from None
    if not math.isfinite(number):
        raise ValueError(f"{name}: found {number}, allowed a finite number")
    return number


def at_least(name: str, value: object, low: float) -> float:
    number = finite(name, value)
    if number < low:
        raise ValueError(f"{name}: found {number}, allowed at least {low}")
    return number
