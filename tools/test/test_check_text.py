# SPDX-License-Identifier: BSD-3-Clause
"""check_text.py sees broken equations, words to avoid, frames that look like newtons, comments without a head and long cells."""

from pathlib import Path

import check_text
import pytest

CPP, PROSE = Path("a.hpp"), Path("a.md")


@pytest.mark.parametrize("path, line, count", [
    (CPP, "// it has patience", 1), (CPP, "int patience;", 0), (CPP, 'say("set-points");', 1), (PROSE, "Whoever reads", 1),
    (PROSE, "a timeout of 3 s", 0), (CPP, 'int a;  // "quoted" believes', 1), (PROSE, "the-house-of", 0),
])
def test_words(path, line, count):
    assert len(check_text.words_in(path, line)) == count


@pytest.mark.parametrize("line, count", [
    ("///     (1)", 1), ("///     a = b + c                    (1)", 0), ("///     a = b + c (2)", 0),
    ("/// Pressure: a = b + c (1)", 1), ("/// with a of (1) and b of (2).", 0), ("/// The root a of (1), or 0 (see above).", 0),
])
def test_equations(line, count):
    assert len(check_text.equations_in(CPP, line)) == count


@pytest.mark.parametrize("text, count", [
    ("int a;  ///< Of the queue.", 1), ("/// Of the queue: half of it remains.", 1), ("/// Number\n/// Of Two.", 0), ("// Often", 0),
])
def test_fragments(text, count):
    assert len(check_text.fragments_in(CPP, text)) == count


def test_paths():
    assert len(check_text.paths_in(CPP, 'std::fopen("/tmp/trace.txt", "a");\nopen("/dev/null");')) == 1


@pytest.mark.parametrize("cell, count", [("a" * 300, 0), ("a" * 301, 1), (f"`{'a' * 301}`", 0), (f"aa `b` {'a' * 300}", 1)])
def test_cells(cell, count):
    assert len(check_text.cells_in(PROSE, f"| x | {cell} |")) == count


@pytest.mark.parametrize("name, count", [
    ("p_N", 1), ("q_NB", 1), ("v_N_m_s", 1), ("steady_N_", 1), ("thrust_N", 0), ("max_thrust_N_", 0), ("stiffness_N_m", 0),
    ("thrust_gain_N_s2", 0), ("p_W", 0), ('"q_NB"', 0),
])
def test_frames(name, count):
    assert len(check_text.frames_in(CPP, f"double x = {name};")) == count
