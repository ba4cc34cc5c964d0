# SPDX-License-Identifier: BSD-3-Clause
import math
import re

import bench_programs
import bench_worlds
import pytest

FLIGHT = ("jsbsim", "anaconda", "default", "6,270,4")
FOUND = {"position_rms_m": 0.12811, "position_max_m": 0.33934, "attitude_rms_deg": 0.1579, "attitude_max_deg": 2.797,
         "tracking_rms_m": [0.3906, 0.3905], "touchdown_m_s": [0.683, None], "success": [True, True], "duration_s": 90.0}
PAGE = f"# Engines\n{bench_worlds.BEGIN}| old |\n{bench_worlds.END}After.\n"


def test_a_row_names_the_flight_and_says_what_failed():
    lines = bench_worlds.table({FLIGHT: FOUND}).splitlines()
    assert [line.count("|") for line in lines] == [7, 7, 7]
    assert lines[2] == ("| jsbsim | anaconda, default, wind 6,270,4 | 0.128, 0.339 | 0.158, 2.797 | 0.391, 0.391 | 0.683, - |")
    failed = bench_worlds.table({FLIGHT: {**FOUND, "success": [True, False]}})
    assert "wind 6,270,4: **not a success** |" in failed


def test_the_page_keeps_what_is_around_the_table(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(PAGE)
    bench_worlds.write_page("| new |\n", page)
    assert page.read_text() == PAGE.replace("old", "new")


@pytest.mark.parametrize("text", ["no marks\n", f"{bench_worlds.BEGIN}| no end |\n"])
def test_a_page_without_marks_is_not_touched(text, tmp_path):
    page = tmp_path / "page.md"
    page.write_text(text)
    with pytest.raises(RuntimeError, match="found no table"):
        bench_worlds.write_page("| new |\n", page)
    assert page.read_text() == text


def test_worst_is_the_largest_of_its_group_and_a_missing_touchdown_counts_as_infinite(monkeypatch):
    group = [("a", "default", ""), ("b", "default", "")]
    flown = {("jsbsim", *group[0]): FOUND, ("jsbsim", *group[1]): {**FOUND, "position_rms_m": 0.5, "tracking_rms_m": [1.0, 3.0]}}
    monkeypatch.setattr(bench_worlds, "flights", lambda: flown)
    assert bench_worlds.worst("jsbsim", group, "position_rms_m") == 0.5
    assert bench_worlds.worst_between("jsbsim", group, "tracking_rms_m") == 2.0
    assert math.isinf(bench_worlds.worst_between("jsbsim", group, "touchdown_m_s"))


def test_the_page_has_a_row_for_each_engine_and_flight():
    text = bench_worlds.PAGE.read_text()
    rows = text.partition(bench_worlds.BEGIN)[2].partition(bench_worlds.END)[0].splitlines()[2:]
    named = [f"{vehicle}, {mission}" + (f", wind {wind}" if wind else "") for vehicle, mission, wind in bench_worlds.FLIGHTS]
    assert [re.findall(r"[^|]+", row)[:2] for row in rows] == [[f" {engine} ", f" {name} "] for name in named
                                                              for engine in bench_worlds.ENGINES]


def test_a_flight_without_a_program_of_its_own_has_the_numbers_of_the_page():
    flight = ("runge_kutta_held", "multirotor", "default", "")
    row = bench_worlds.table({flight: bench_worlds.fly(*flight)}).splitlines()[2]
    assert row in bench_worlds.PAGE.read_text().splitlines()


@pytest.mark.parametrize("words, said", [(["jsbsim", "anaconda"], "usage: worlds ENGINE"), (["bullet", "multirotor", "hop"], "found bullet")])
def test_bad_words_are_one_line_and_exit_code_2(words, said):
    done = bench_programs.subprocess.run([bench_programs.program("worlds"), *words], capture_output=True, text=True)
    assert done.returncode == 2 and done.stderr.count("\n") == 1 and said in done.stderr
