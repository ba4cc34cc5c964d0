# SPDX-License-Identifier: BSD-3-Clause
"""Reports as one HTML file each: nothing is loaded from elsewhere."""

from __future__ import annotations

import base64
import html
import io
import math
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _worker, plot
from . import _statistics as statistics
from ._campaign import CONDITIONS_END, Campaign, fly_again
from ._compare import Comparison
from ._configuration import METRICS, OUTCOMES
from ._store import write_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WORST = 10
STYLE = """body{font:16px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#1a1a1a;background:#fff}
table{border-collapse:collapse;margin:1rem 0;display:block;overflow-x:auto}td,th{padding:.2rem .8rem;border-bottom:1px solid #ccc;text-align:left}
td.n,th.n{text-align:right;font-variant-numeric:tabular-nums}img{max-width:100%}code{background:#f0f0f0;overflow-wrap:anywhere}
.verdict{font-size:1.3rem;font-weight:600}figure{margin:1rem 0}"""


def worst_rows(campaign: Campaign, count: int = WORST) -> list[int]:
    """Rows of the worst flights: those that failed first, by their outcome, then by the number that the campaign names."""
    value = np.nan_to_num(campaign[campaign.configuration.worst_by].astype(float), nan=math.inf)
    outcome = np.array([OUTCOMES.index(name) for name in campaign["outcome"]])
    return [int(k) for k in np.lexsort((campaign["seed"], -value, -outcome, campaign["passed"]))[:count]]


def verdict(campaign: Campaign) -> tuple[str, bool]:
    """The success rate in a sentence, and whether it is what the campaign requires."""
    required = campaign.configuration.required
    low, high = statistics.clopper_pearson(campaign.passed, len(campaign), required.confidence)
    text = (f"{campaign.passed} of {len(campaign)} flights passed: {100 * campaign.passed / len(campaign):.2f} %, "
            f"{100 * required.confidence:g} % confidence {100 * low:.2f} to {100 * high:.2f} %")
    if required.success_rate is None:
        return text, True
    met = low >= required.success_rate
    return f"{text}; required: a lower limit of {100 * required.success_rate:g} %, {'met' if met else 'not met'}", met


def _page(title: str, parts: Iterable[str]) -> str:
    body = "\n".join(parts)
    return (f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
            f"<title>{html.escape(title)}</title><style>{STYLE}</style></head>\n<body><h1>{html.escape(title)}</h1>\n{body}\n</body></html>\n")


def _table(head: list[str], rows: Iterable[list[str]], texts: int = 1) -> str:
    """@param texts  columns from the left that are no numbers."""
    def line(tag: str, cells: list[str]) -> str:
        return "<tr>" + "".join(f"<{tag}{'' if k < texts else ' class=n'}>{html.escape(cell)}</{tag}>" for k, cell in enumerate(cells)) + "</tr>"

    return "<table>" + line("th", head) + "".join(line("td", row) for row in rows) + "</table>"


def _picture(figure: Figure, text: str, dpi: int = 90) -> str:
    content = io.BytesIO()
    figure.savefig(content, format="png", dpi=dpi, metadata={"Software": None})
    data = base64.b64encode(content.getvalue()).decode()
    return f'<figure><img alt="{html.escape(text)}" src="data:image/png;base64,{data}"><figcaption>{html.escape(text)}</figcaption></figure>'


def _number(value: float) -> str:
    return "–" if math.isnan(value) else f"{value:.4g}"


def _quantile_table(campaign: Campaign) -> str:
    rows = [[name, *map(_number, statistics.quantiles(campaign[name]))] for name in METRICS]
    return _table(["in truth", "smallest", "5 %", "median", "95 %", "largest"], rows)


def _drawn(campaign: Campaign) -> list[str]:
    """Conditions that are not the same in all flights."""
    names = campaign.table.column_names
    return [name for name in names[1:names.index(CONDITIONS_END)] if len(set(campaign[name])) > 1]


def _failures(campaign: Campaign) -> str:
    reasons = Counter(reason.partition(" ")[0].rstrip(":") for text in campaign["broken"] for reason in text.split("; ") if reason)
    if not reasons:
        return ""
    return "<h2>Why flights failed</h2>" + _table(["criterion", "flights"], [[name, str(count)] for name, count in reasons.most_common()])


def _worst_part(campaign: Campaign, rows: list[int], folders: dict[int, Path]) -> list[str]:
    parts = [f"<h2>The worst {len(rows)}</h2><p>Failed flights first, by their outcome, then by {campaign.configuration.worst_by}.</p>"]
    for k in rows:
        seed = int(campaign["seed"][k])
        why = campaign["broken"][k] or "passed"
        parts.append(f"<h3>Seed {seed}: {html.escape(str(why))}</h3><p>{html.escape(str(campaign['verdict'][k]))}</p>")
        parts.append(f"<p><code>{html.escape(str(campaign['command'][k]))}</code></p>")
        if seed in folders:
            report = folders[seed] / "report.html"
            if report.exists():
                parts.append(f'<p><a href="{report.relative_to(campaign.folder)}">report of this flight</a></p>')
            parts.append(_picture(_path(folders[seed]), f"path of seed {seed}", 60))
    return parts


def _path(folder: Path) -> Figure:
    with np.load(folder / _worker.SERIES) as series:
        return plot.path_of({"true path": (series["t_s"], series["position_m"]), "setpoint": (series["t_s"], series["setpoint_m"])})


def campaign_page(campaign: Campaign, folders: dict[int, Path], rows: list[int]) -> str:
    """@param folders: flight folders of the worst flights, by seed. @param rows: the worst flights."""
    title = f"Campaign {campaign.folder.name}"
    text, met = verdict(campaign)
    outcomes = Counter(campaign["outcome"])
    parts = [f'<p class="verdict">{html.escape(text)}</p>']
    if len(campaign) < campaign.flights:
        parts.append(f"<p>{campaign.flights - len(campaign)} of {campaign.flights} flights are still to be flown.</p>")
    parts.append(_table(["outcome", "flights"], [[name, str(outcomes[name])] for name in OUTCOMES if name in outcomes]))
    parts.append(_failures(campaign))
    parts.append("<h2>Quantiles</h2>" + _quantile_table(campaign))
    shown = [campaign.configuration.worst_by, *(limit.metric for limit in campaign.configuration.criteria.limits)]
    for name in dict.fromkeys(shown):
        parts.append(_picture(plot.distribution(campaign, name), f"{name} of all flights"))
    drawn = _drawn(campaign)
    if drawn:
        parts.append("<h2>Success by condition</h2>")
    for name in drawn:
        parts.append(_picture(plot.success(campaign, name), f"success rate by {name}, with its confidence interval"))
    parts += _worst_part(campaign, rows, folders)
    parts.append(f"<h2>How it was flown</h2><p>{html.escape(str(campaign.identity['program']))}. The same program and file give the same rows. "
                 f"All rows: <code>rows.parquet</code>.</p><pre>{html.escape(campaign.configuration.text)}</pre>")
    return _page(title, parts)


def comparison_page(comparison: Comparison) -> str:
    count = len(comparison.seeds)
    rows = []
    for test in comparison.tests:
        paired = test.paired
        rows.append([test.name, str(paired.worse), str(paired.better), _number(test.median_change), f"{paired.p:.3g}", comparison.changed(test)])
    parts = [f'<p class="verdict">After the change: {html.escape(comparison.verdict)}</p>', f"<p>{html.escape(summary(comparison))}</p>"]
    parts.append(_table(["", "worse", "better", "change", "p", "shown"], rows))
    parts.append(f"<p>{count} flights, paired by seed. Success: McNemar's exact test of the flights that changed; the change is that of the rate. "
                 f"Numbers: sign test; the change is the median. A difference counts when p is at most {comparison.level:g} divided by the "
                 f"number of tests.</p>")
    if comparison.differing:
        text = ", ".join(f"{name} in {number} flights" for name, number in comparison.differing.items())
        parts.append(f"<p><strong>Conditions differ:</strong> {html.escape(text)}. The pairs are then not of equal flights.</p>")
    for test in comparison.tests[1:]:
        parts.append(_picture(plot.paired(comparison.before, comparison.after, test.name), f"{test.name}, before and after"))
    parts.append(_table(["", "folder", "program"], [["before", str(comparison.before.folder), comparison.before.identity["program"]],
                                                     ["after", str(comparison.after.folder), comparison.after.identity["program"]]], 3))
    parts.append(_changed_flights(comparison))
    return _page("Two campaigns compared", parts)


def summary(comparison: Comparison) -> str:
    paired = comparison.tests[0].paired
    return (f"passed {comparison.passed_before} before and {comparison.passed_after} after, of {len(comparison.seeds)}; {paired.worse} failed "
            f"that had passed, {paired.better} passed that had failed, p {paired.p:.3g}")


def _changed_flights(comparison: Comparison) -> str:
    def by_seed(campaign: Campaign) -> dict[int, dict[str, Any]]:
        return {row["seed"]: row for row in campaign.table.to_pylist()}

    before, after = by_seed(comparison.before), by_seed(comparison.after)
    changed = [int(seed) for seed in comparison.seeds if before[int(seed)]["passed"] and not after[int(seed)]["passed"]]
    if not changed:
        return ""
    return "<h2>Failed that had passed</h2>" + _table(
        ["seed", "why", "command"], [[str(seed), after[seed]["broken"], after[seed]["command"]] for seed in changed[:50]], 3)


def report(campaign: Campaign, *, worst: int = WORST, workers: int | None = None) -> Path:
    """Writes report.html into the folder of the campaign. The worst flights are flown again, with their logs.

    Raises CampaignError if one of them then flies otherwise than its row has it."""
    rows = worst_rows(campaign, worst)
    folders = {int(campaign["seed"][k]): campaign.folder / "worst" / str(campaign["seed"][k]) for k in rows}
    fly_again(campaign, folders, workers)
    page = campaign.folder / "report.html"
    write_whole(page, campaign_page(campaign, folders, rows).encode())
    return page
