# SPDX-License-Identifier: BSD-3-Clause
import json

import board_demo
import h7_figures
import pytest

TRIP = {"board": "varmint", "link": "usb", "mean_ms": 0.1673, "median_ms": 0.17, "p999_ms": 0.25,
        "max_ms": 0.26, "fastest_hz": 5198.2}
ROLL = {"roll_rms_deg": 1.107, "roll_max_deg": 2.598, "lag_ms": 120.0, "roll_estimated_rms_deg": 0.488, "commands_hz": 399.9}


def test_table_has_a_column_for_each_number():
    heading, row = board_demo.table([TRIP], board_demo.ROUND_TRIP, ("link", "link")).splitlines()
    assert heading.split() == ["board", "link", "mean", "median", "99.9", "%", "max", "fastest", "Hz"]
    assert row.split() == ["varmint", "usb", "0.167", "0.170", "0.250", "0.260", "5198"]


@pytest.mark.parametrize("arguments, said", [
    ([], "DIR"), (["out", "--board", "pixhawk"], "pixhawk"), (["out", "--count", "0"], "found 0, allowed 100 to 1000000"),
    (["out", "--seconds", "-3"], "found -3")])
def test_bad_arguments_are_one_line_and_exit_code_2(arguments, said, capsys):
    with pytest.raises(SystemExit) as ended:
        board_demo.main(arguments)
    told = capsys.readouterr()
    assert ended.value.code == 2 and told.out == "" and told.err.count("\n") == 1 and said in told.err


def test_every_board_is_flown_with_both_attitudes_and_asked_over_each_link(tmp_path, monkeypatch, capsys):
    flown, asked = [], []

    def fly(program, board, *words):
        flown.append((board, "--attitude" in words))
        return {"board": board, **ROLL}

    def ask(board, link, *words):
        asked.append((board, link))
        return {**TRIP, "board": board, "link": link}

    monkeypatch.setattr(board_demo, "build", lambda boards: None)
    monkeypatch.setattr(board_demo, "draw", lambda folder: None)
    monkeypatch.setattr(h7_figures, "bench_program", fly)
    monkeypatch.setattr(h7_figures, "measure_round_trips", ask)
    assert board_demo.main([str(tmp_path / "new" / "folder")]) == 0
    assert flown == [(board, alone) for board in h7_figures.BOARDS for alone in (False, True)]
    assert asked == [(board, link) for board in h7_figures.BOARDS for link in ("usb", "921600", "3000000")]
    left = json.loads((tmp_path / "new" / "folder" / "boards.json").read_text())
    assert len(left["round_trips"]) == 6 and len(left["roll"]) == 4
    assert "pixracer_pro" in capsys.readouterr().out


def test_a_measurement_that_fails_is_one_line_and_exit_code_1(tmp_path, monkeypatch, capsys):
    def lose(*words):
        raise RuntimeError("3 commands were lost")

    monkeypatch.setattr(board_demo, "build", lambda boards: None)
    monkeypatch.setattr(board_demo, "measure", lose)
    assert board_demo.main([str(tmp_path)]) == 1
    assert capsys.readouterr().err == "rosflight: bench --boards: 3 commands were lost\n"
    assert not (tmp_path / "boards.json").exists()
