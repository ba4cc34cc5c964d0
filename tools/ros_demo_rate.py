# SPDX-License-Identifier: BSD-3-Clause
"""Whether a demonstration has held its rate; ros_demo.py documents its use."""

import sys

HELD = 0.98  # of the rate, to count as held


def held(reached_Hz: float, wanted_Hz: float) -> bool:
    return reached_Hz >= HELD * wanted_Hz


def exit_code(rates: list[tuple[str, float, float]]) -> int:
    """0, or 1 with a line for each that was not held: name, rate reached, rate wanted [Hz]."""
    missed = [(name, reached, wanted) for name, reached, wanted in rates if not held(reached, wanted)]
    for name, reached, wanted in missed:
        print(f"rosflight: {name}: rate not held, found {reached:.1f} Hz, wanted {wanted:g} Hz: "
              "these figures are not those of the demonstration", file=sys.stderr)
    return 1 if missed else 0
