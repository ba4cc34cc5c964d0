# SPDX-License-Identifier: BSD-3-Clause
import json

import bench
import board_demo
import h7_figures
import pytest

TRIP = {"board": "varmint", "link": "usb", "mean_ms": 0.1673, "median_ms": 0.17, "p999_ms": 0.25,
        "max_ms": 0.26, "fastest_hz": 5198.2, "idle_fraction": 0.951}
ROLL = {"roll_rms_deg": 1.107, "roll_max_deg": 2.598, "lag_ms": 120.0, "roll_estimated_rms_deg": 0.488, "commands_hz": 399.9}


def test_table_has_a_column_for_each_number():
    heading, row = board_demo.table([TRIP], board_demo.ROUND_TRIP, ("link", "link")).splitlines()
    assert heading.split() == ["board", "link", "mean", "median", "99.9", "%", "max", "fastest", "Hz", "idle"]
    assert row.split() == ["varmint", "usb", "0.167", "0.170", "0.250", "0.260", "5198", "0.951"]


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


@pytest.fixture
def asked(monkeypatch):
    """Round trips without an emulator: which were asked for."""
    calls = []

    def ask(board, link, *words):
        calls.append((board, link, words[1]))
        return {**TRIP, "board": board, "link": link}

    monkeypatch.setattr(board_demo, "build", lambda boards, programs, kinds: calls.append((boards, programs, kinds)))
    monkeypatch.setattr(h7_figures, "measure_round_trips", ask)
    return calls


@pytest.mark.parametrize("words, boards, count", [
    (["--board", "varmint"], ["varmint"], "18000"), (["--board=pixracer_pro", "--count", "400"], ["pixracer_pro"], "400"),
    (["--board", "varmint", "--board", "pixracer_pro"], ["varmint", "pixracer_pro"], "18000")])
def test_bench_rtt_of_a_board_asks_over_each_link_and_prints_the_table(asked, capsys, words, boards, count):
    assert bench.main(["rtt", *words]) == 0
    assert asked == [(boards, ["bench/board_rtt"], ["_echo"]),
                     *((board, link, count) for board in boards for link in ("usb", "921600", "3000000"))]
    rows = [line.split()[:2] for line in capsys.readouterr().out.splitlines()[3:]]
    assert rows == [[board, name] for board in boards for name in ("USB", "UART", "UART")]


@pytest.mark.parametrize("words, said", [
    (["--board", "pixhawk"], "invalid choice: 'pixhawk'"), (["--board"], "expected one argument"), (["--count", "400"], "--board"),
    (["--board", "varmint", "--count", "0"], "found 0, allowed 100 to 1000000"), (["--board", "varmint", "--json", "f"], "--json")])
def test_bench_rtt_refuses_in_one_line(asked, capsys, words, said):
    with pytest.raises(SystemExit) as ended:
        bench.main(["rtt", *words])
    told = capsys.readouterr()
    assert ended.value.code == 2 and asked == [] and told.out == "" and told.err.count("\n") == 1 and said in told.err
    assert told.err.startswith("rosflight: bench rtt: ")


def test_bench_rtt_says_what_failed(asked, capsys, monkeypatch):
    def lose(*words):
        raise RuntimeError("3 commands were lost")

    monkeypatch.setattr(h7_figures, "measure_round_trips", lose)
    assert bench.main(["rtt", "--board", "varmint"]) == 1
    assert capsys.readouterr().err.splitlines()[-1] == "rosflight: bench rtt: 3 commands were lost"
