# SPDX-License-Identifier: BSD-3-Clause
"""The command ./rosflight campaign."""

from __future__ import annotations

import argparse
import signal
import sys
from pathlib import Path
from typing import NoReturn

from . import _campaign, _report, _statistics
from ._campaign import Campaign
from ._compare import LEVEL, compare
from ._configuration import OUTCOMES
from ._store import write_whole
from ._yaml import CampaignError


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise CampaignError(message)


class _Stopped(BaseException):
    """By a signal."""


def _options(words: list[str]) -> argparse.Namespace:
    parser = _Parser(prog="./rosflight campaign", add_help=False, allow_abbrev=False)
    parser.add_argument("file", nargs="?")
    parser.add_argument("--workers", type=int)
    parser.add_argument("--dask", metavar="ADDRESS")
    parser.add_argument("--out")
    parser.add_argument("--worst", type=int)
    parser.add_argument("--no-report", action="store_true")
    parser.add_argument("--compare", nargs=2, metavar=("BEFORE", "AFTER"))
    parser.add_argument("--metric", action="append")
    parser.add_argument("--level", type=float)
    options = parser.parse_args(words)
    if (options.file is None) == (options.compare is None):
        raise CampaignError("campaign: found neither or both, allowed one of FILE and --compare BEFORE AFTER")
    others = ("workers", "dask", "worst", "no_report") if options.compare else ("metric", "level")
    for name in others:
        if getattr(options, name) not in (None, False):
            raise CampaignError(f"--{name.replace('_', '-')}: found {'with' if options.compare else 'without'} --compare, allowed "
                                f"{'without' if options.compare else 'with'} it")
    if options.workers is not None and options.dask:
        raise CampaignError("--dask: found with --workers, allowed one of them")
    for name, low in (("workers", 1), ("worst", 0)):
        value = getattr(options, name)
        if value is not None and value < low:
            raise CampaignError(f"--{name}: found {value}, allowed at least {low}")
    return options


def _progress(done: int, wanted: int) -> None:
    if sys.stderr.isatty():
        print(f"\r{done} of {wanted} flights ", end="" if done < wanted else "\n", file=sys.stderr, flush=True)


def _fly(options: argparse.Namespace) -> int:
    flown = _campaign.fly(options.file, options.out, workers=options.workers, dask=options.dask, progress=_progress)
    count = _report.WORST if options.worst is None else options.worst
    page = None if options.no_report else _report.report(flown, worst=count, workers=options.workers)
    _print(flown)
    print(f"\nrows in {flown.folder / 'rows.parquet'}" + (f", report in {page}" if page else ""))
    return 0 if _report.verdict(flown)[1] else 1


def _print(flown: Campaign) -> None:
    outcomes = list(flown["outcome"])
    for name in OUTCOMES:
        if name in outcomes:
            print(f"{name:<26}{outcomes.count(name):8}")
    print(f"\n{'in truth':<26}{'median':>8} {'95 %':>8} {'largest':>8}")
    for name in ("tracking_rms_m", "worst_waypoint_m", "touchdown_speed_m_s", "touchdown_distance_m"):
        print(f"{name:<26}" + " ".join(f"{value:8.2f}" for value in _statistics.quantiles(flown[name], (0.5, 0.95, 1.0))))
    failed = [k for k in _report.worst_rows(flown, len(flown)) if not flown["passed"][k]]
    for k in failed[:_report.WORST]:
        print(f"\nseed {flown['seed'][k]}: {flown['broken'][k]}\n  {flown['command'][k]}")
    if len(failed) > _report.WORST:
        print(f"\nand {len(failed) - _report.WORST} more")
    print(f"\n{_report.verdict(flown)[0]}")


def _compare(options: argparse.Namespace) -> int:
    before, after = (_campaign.read(folder) for folder in options.compare)
    comparison = compare(before, after, tuple(options.metric or ()), LEVEL if options.level is None else options.level)
    page = Path(options.out or after.folder / "compared.html")
    page.parent.mkdir(parents=True, exist_ok=True)
    write_whole(page, _report.comparison_page(comparison).encode())
    print(_report.summary(comparison))
    for test in comparison.tests[1:]:
        print(f"{test.name}: larger in {test.paired.worse}, smaller in {test.paired.better}, median change {test.median_change:.4g}, "
              f"p {test.paired.p:.3g}: {comparison.changed(test)}")
    for name, count in comparison.differing.items():
        print(f"conditions differ: {name} in {count} flights")
    print(f"after the change: {comparison.verdict}\nreport in {page}")
    return 1 if comparison.verdict == "worse" else 0


def _stop(number: int, frame: object) -> NoReturn:
    raise _Stopped(number)


def main(words: list[str]) -> int:
    for number in (signal.SIGINT, signal.SIGTERM):  # a shell has its background jobs ignore the first
        signal.signal(number, _stop)
    try:
        options = _options(words)
        return _compare(options) if options.compare else _fly(options)
    except CampaignError as error:
        print(f"rosflight: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        print(f"rosflight: {place}{error.strerror or error}; rows on the disk are kept, the same command goes on", file=sys.stderr)
        return 2
    except _Stopped as stopped:
        print("rosflight: stopped; the rows are kept, the same command goes on", file=sys.stderr)
        return 128 + int(stopped.args[0])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
