# SPDX-License-Identifier: BSD-3-Clause
"""The sizes of docs/beyond-one-machine.md, by figures whose result is known without the program."""

import json

import beyond_one_machine as beyond
import pytest

# A flight a second and core; 10^5 steps.
FIGURES = {"scale.flights_per_core_minute": 60, "scale.steps_per_core_s": 1e5, "scale.memory_kB": 200, "scale.row_bytes": 500,
           "scale.log_bytes": 2_000_000}


def written(folder, **changed):
    file = folder / "figures.json"
    file.write_text(json.dumps({name: {"value": value} for name, value in {**FIGURES, **changed}.items()}))
    return file


def test_the_page_follows_from_the_figures_that_it_names():
    assert beyond.main(["--check"]) == 0, "run tools/beyond_one_machine.py"
    assert set(beyond.said(beyond.DOCUMENT.read_text())) == set(FIGURES)


def test_a_million_flights_of_a_second_take_278_core_hours():
    """10^6 s are 277.8 h; over 2 cores at 90 % 154.3 h, which are 6.4 days. 10^10 steps are 10^5 s."""
    text = beyond.tables(FIGURES)
    assert "A million flights take 277.8 core-hours, 10^10 steps of environments 27.8." in text
    assert "| 2 | 6.4 days | 15.4 h |" in text
    assert "| 1024 | 18 min | 2 min |" in text


def test_bytes():
    text = beyond.tables(FIGURES)
    assert "| rows | 500 MB |" in text and "| logs of 1 % that failed, flown again | 20 GB |" in text
    assert "keep | 2 TB |" in text and "10 000 vehicles of environments need 2 GB of memory." in text


def test_figures_reach_the_page(tmp_path, monkeypatch):
    page = tmp_path / "page.md"
    page.write_text(f"before\n{beyond.BEGIN}stale\n{beyond.END}after\n")
    monkeypatch.setattr(beyond, "DOCUMENT", page)
    assert beyond.main([str(written(tmp_path))]) == 0
    text = page.read_text()
    assert text.startswith("before\n") and text.endswith("after\n") and "stale" not in text
    assert beyond.said(text) == FIGURES and beyond.main(["--check"]) == 0
    page.write_text(text.replace("6.4 days", "6.5 days"))
    assert beyond.main(["--check"]) == 1


@pytest.mark.parametrize("changed", [{"scale.row_bytes": None}, {"scale.memory_kB": "much"}])
def test_a_figure_that_was_not_measured_is_one_line_and_exit_code_2(changed, tmp_path, capsys):
    before = beyond.DOCUMENT.read_text()
    assert beyond.main([str(written(tmp_path, **changed))]) == 2
    assert capsys.readouterr().err.count("\n") == 1 and beyond.DOCUMENT.read_text() == before
