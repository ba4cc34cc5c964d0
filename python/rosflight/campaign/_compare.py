# SPDX-License-Identifier: BSD-3-Clause
"""Two campaigns of the same flights, before and after a change: paired by seed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _statistics as statistics
from ._campaign import CONDITIONS_END, Campaign
from ._configuration import METRICS
from ._yaml import CampaignError

LEVEL = 0.05


@dataclass(frozen=True)
class Test:
    """One number of the flights, before and after."""

    name: str
    paired: statistics.Paired
    median_change: float  #: After less before; NaN: none has both. For success the change of the rate.


@dataclass(frozen=True)
class Comparison:
    before: Campaign
    after: Campaign
    seeds: np.ndarray[Any, Any]  #: Flown in both.
    passed_before: int
    passed_after: int
    tests: tuple[Test, ...]  #: Success first.
    level: float
    differing: dict[str, int]  #: Conditions that differ, and in how many flights.

    def changed(self, test: Test) -> str:
        """worse, better, or none shown. The level is shared by the tests (Bonferroni), so that it holds for all together."""
        if test.paired.p > self.level / len(self.tests):
            return "none shown"
        return "worse" if test.paired.worse > test.paired.better else "better"

    @property
    def verdict(self) -> str:
        """worse: any of the tests shows it; else better: any; else no difference shown."""
        found = {self.changed(test) for test in self.tests}
        return next((name for name in ("worse", "better") if name in found), "no difference shown")


def compare(before: Campaign, after: Campaign, metrics: tuple[str, ...] = (), level: float = LEVEL) -> Comparison:
    """Pairs flights by seed. `metrics` are tested beside success; of each a smaller number is better."""
    for metric in metrics:
        if metric not in METRICS:
            raise CampaignError(f"--metric: found '{metric}', allowed {', '.join(METRICS)}")
    if not 0 < level < 1:
        raise CampaignError(f"--level: found {level:g}, allowed a number between 0 and 1")
    seeds, mine, theirs = np.intersect1d(before["seed"], after["seed"], return_indices=True)
    if not len(seeds):
        raise CampaignError(f"--compare: found no seed that {before.folder} and {after.folder} share, allowed campaigns of the same seeds")
    passed = before["passed"][mine], after["passed"][theirs]
    tests = [Test("success", statistics.mcnemar(*passed), float(passed[1].mean() - passed[0].mean()))]
    for metric in metrics:
        was, now = before[metric][mine], after[metric][theirs]
        change = (now - was).astype(float)
        known = change[np.isfinite(change)]
        tests.append(Test(metric, statistics.sign_test(was, now), float(np.median(known)) if len(known) else float("nan")))
    return Comparison(before, after, seeds, int(passed[0].sum()), int(passed[1].sum()), tuple(tests), level,
                      _differing(before, after, mine, theirs))


def _conditions(campaign: Campaign) -> list[str]:
    names = campaign.table.column_names
    return list(names[:names.index(CONDITIONS_END)])


def _differing(before: Campaign, after: Campaign, mine: Any, theirs: Any) -> dict[str, int]:
    out = {}
    for name in dict.fromkeys(_conditions(before) + _conditions(after)):
        if name not in before.table.column_names or name not in after.table.column_names:
            out[name] = len(mine)
        elif count := int(np.count_nonzero(before[name][mine] != after[name][theirs])):
            out[name] = count
    return out
