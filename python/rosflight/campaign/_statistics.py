# SPDX-License-Identifier: BSD-3-Clause
"""Statistics of campaigns.

    Clopper and Pearson, "The use of confidence or fiducial limits illustrated in the case of the binomial", Biometrika 26 (1934)
    McNemar, "Note on the sampling error of the difference between correlated proportions or percentages", Psychometrika 12 (1947)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import bdtr, betaincinv

SHARES = (0.0, 0.05, 0.5, 0.95, 1.0)


def clopper_pearson(passed: int, flights: int, confidence: float = 0.95) -> tuple[float, float]:
    """The two-sided interval of a success rate, which holds the true rate with at least that probability."""
    tail = (1 - confidence) / 2
    low = float(betaincinv(passed, flights - passed + 1, tail)) if passed > 0 else 0.0
    high = float(betaincinv(passed + 1, flights - passed, 1 - tail)) if passed < flights else 1.0
    return low, high


def quantiles(values: np.ndarray[Any, Any], shares: tuple[float, ...] = SHARES) -> list[float]:
    """Quantiles of the values that are numbers; NaN where there is none."""
    known = values[np.isfinite(values.astype(float))]
    return [float(value) for value in np.quantile(known, shares)] if len(known) else [float("nan")] * len(shares)


@dataclass(frozen=True)
class Paired:
    """Two outcomes of the same flights: of those that differ, how many changed to the worse, and how probable at least as
    uneven a division is where either direction is as likely (two-sided, exact)."""

    worse: int
    better: int

    @property
    def p(self) -> float:
        changed = self.worse + self.better
        return min(1.0, 2 * float(bdtr(min(self.worse, self.better), changed, 0.5))) if changed else 1.0


def mcnemar(before: np.ndarray[Any, Any], after: np.ndarray[Any, Any]) -> Paired:
    """McNemar's exact test of flights that passed (true) before and after."""
    return Paired(int(np.count_nonzero(before & ~after)), int(np.count_nonzero(~before & after)))


def sign_test(before: np.ndarray[Any, Any], after: np.ndarray[Any, Any]) -> Paired:
    """The same test of numbers of which a smaller one is better; equal ones and those that are missing do not count."""
    return Paired(int(np.count_nonzero(after > before)), int(np.count_nonzero(after < before)))
