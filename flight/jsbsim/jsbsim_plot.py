# SPDX-License-Identifier: BSD-3-Clause
"""Draws comparisons as one SVG: position and attitude of both programs, and their difference with its bound."""

import math

import numpy as np

from jsbsim_run import HOLD_S

WIDE, HIGH, LEFT, TOP, GAP_X, GAP_Y = 400, 170, 70, 50, 90, 50
COLOURS = ("#1b6ca8", "#c2571a", "#2e8b57")
STYLE = ("text{font:12px sans-serif;fill:#222}.axis{stroke:#888;fill:none}.grid{stroke:#e4e4e4}"
         ".ours{fill:none;stroke-width:3;opacity:.45}.theirs{fill:none;stroke-width:1.2;stroke:#111;stroke-dasharray:5 4}"
         ".difference{fill:none;stroke:#1b6ca8;stroke-width:1.4}.bound{fill:none;stroke:#b00020;stroke-width:1.4}")


class Panel:
    """One pair of axes; time goes right."""

    def __init__(self, x, y, title, low, high, logarithmic=False):
        self.x, self.y, self.low, self.high, self.logarithmic = x, y, low, high, logarithmic
        self.parts = [f'<text x="{x}" y="{y - 8}">{title}</text>',
                      f'<rect class="axis" x="{x}" y="{y}" width="{WIDE}" height="{HIGH}"/>']
        for value in self._ticks():
            at = self._y(value)
            label = f"1e{round(value)}" if logarithmic else f"{value:g}"
            self.parts.append(f'<path class="grid" d="M{x} {at:.1f}h{WIDE}"/>'
                              f'<text x="{x - 6}" y="{at + 4:.1f}" text-anchor="end">{label}</text>')
        for t in range(0, 21, 5):
            self.parts.append(f'<text x="{self._x(t):.1f}" y="{y + HIGH + 16}" text-anchor="middle">{t}'
                              f'{" s" if t == 20 else ""}</text>')

    def _ticks(self):
        if self.logarithmic:
            return range(math.ceil(self.low), math.floor(self.high) + 1, 2)
        step = 10 ** math.floor(math.log10(self.high - self.low))
        step *= next(f for f in (0.2, 0.5, 1, 2, 5) if (self.high - self.low) / (step * f) <= 6)
        return np.arange(math.ceil(self.low / step), math.floor(self.high / step) + 1) * step

    def _x(self, t):
        return self.x + WIDE * t / 20.0

    def _y(self, value):
        return self.y + HIGH * (1.0 - (value - self.low) / (self.high - self.low))

    def line(self, values, style, colour=None):
        every = 40  # 0.1 s
        values = np.asarray(values)[::every]
        if self.logarithmic:
            values = np.log10(np.maximum(values, 1e-300))
        values = np.clip(values, self.low, self.high)
        points = " ".join(f"{self._x(i * every * HOLD_S):.1f},{self._y(v):.1f}" for i, v in enumerate(values))
        stroke = f' style="stroke:{colour}"' if colour else ""
        self.parts.append(f'<polyline class="{style}"{stroke} points="{points}"/>')


def _angles_deg(attitude):
    roll = np.arctan2(attitude[:, 2, 1], attitude[:, 2, 2])
    pitch = np.arcsin(np.clip(-attitude[:, 2, 0], -1, 1))
    return np.degrees(np.stack([roll, pitch], axis=1))


def _pair(x, y, title, ours, theirs) -> Panel:
    both = np.concatenate([ours, theirs])
    margin = 0.05 * (both.max() - both.min())
    panel = Panel(x, y, title, both.min() - margin, both.max() + margin)
    for column in range(ours.shape[1]):
        panel.line(ours[:, column], "ours", COLOURS[column])
        panel.line(theirs[:, column], "theirs")
    return panel


def svg(comparisons) -> str:
    panels, headings = [], []
    for column, c in enumerate(comparisons):
        x = LEFT + column * (WIDE + GAP_X)
        rows = [TOP + row * (HIGH + GAP_Y) for row in range(4)]
        headings.append(f'<text x="{x}" y="20" style="font-weight:bold">{c.name}</text>')
        panels.append(_pair(x, rows[0], "position north, east, down [m]", c.ours.position, c.theirs.position))
        panels.append(_pair(x, rows[1], "roll, pitch [deg]", _angles_deg(c.ours.attitude), _angles_deg(c.theirs.attitude)))
        for row, (quantity, title) in enumerate((("position_m", "difference of position [m]"),
                                                 ("attitude_rad", "difference of attitude [rad]")), 2):
            panel = Panel(x, rows[row], title + ": blue, its bound: red", -9, 1, True)
            panel.line(c.bound[quantity], "bound")
            panel.line(c.difference[quantity], "difference")
            panels.append(panel)
    width = LEFT + len(comparisons) * (WIDE + GAP_X) - GAP_X + 30
    height = TOP + 4 * (HIGH + GAP_Y)
    body = "\n".join(headings + [part for panel in panels for part in panel.parts])
    return (f'<?xml version="1.0"?>\n<!-- SPDX-License-Identifier: BSD-3-Clause; made by flight/jsbsim/jsbsim_compare.py -->\n'
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}">'
            f"<style>{STYLE}</style><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
            f'<text x="{width - 30}" y="20" text-anchor="end">ours: coloured; JSBSim: dashed</text>\n{body}\n</svg>\n')
