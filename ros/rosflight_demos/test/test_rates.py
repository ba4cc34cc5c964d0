# SPDX-License-Identifier: BSD-3-Clause
"""A demonstration whose rate was not held is marked and ends with 1; what it measured is made up here."""

import argparse
import json

import pytest
import rclpy
import ros_demo_load
import ros_demo_passthrough
import ros_demo_rtt


@pytest.fixture
def options(tmp_path, monkeypatch):
    monkeypatch.setattr(rclpy, "init", lambda: None)  # the tests have done so
    monkeypatch.setattr(rclpy, "try_shutdown", lambda: None)
    return argparse.Namespace(out=tmp_path, json=False, rate=400.0, count=1000, seconds=20.0, link=["udp"])


@pytest.mark.parametrize("reached, code", [(400.0, 0), (393.0, 0), (391.0, 1), (150.0, 1)])
def test_a_round_trip_at_another_rate_is_marked(options, monkeypatch, capsys, reached, code):
    def run(kind, loaded, rate, count, file):
        file.write_text("round_trip_us\n" + "500\n" * 10)
        return {"sent": 10, "lost": 0, "achieved_Hz": reached if loaded and rate else rate or 900.0}
    monkeypatch.setattr(ros_demo_rtt, "bare", run)
    monkeypatch.setattr(ros_demo_rtt, "over_dds", lambda *arguments: run(*arguments))
    monkeypatch.setattr(ros_demo_rtt, "through_ros", run)
    assert ros_demo_rtt.run(options) == code
    said = capsys.readouterr()
    marked = [line for line in said.out.splitlines() if line.endswith("rate not held")]
    assert len(marked) == 2 * code and all("parameters" in line for line in marked)
    complaints = [line for line in said.err.splitlines() if "rate not held" in line]
    assert len(complaints) == 2 * code
    if code:
        assert complaints[0] == (f"rosflight: bare link udp parameters: rate not held, found {reached:.1f} Hz, wanted 400 Hz: "
                                 "these figures are not those of the demonstration")
    rows = json.loads((options.out / "rtt.json").read_text())
    with_load, without = [True, not code, True], [True, True]
    assert [row["held"] for row in rows] == with_load + without + with_load, "as fast as they come back is no rate to hold"


@pytest.mark.parametrize("step_s, code", [(0.0025, 0), (0.004, 1)])
def test_attitude_loops_at_another_rate_are_told(options, monkeypatch, capsys, step_s, code):
    def fly(options, csv_file):
        csv_file.write_text("time_s,set_roll_rad,roll_rad\n" + "".join(f"{k * step_s},{k % 7},{k % 7}\n" for k in range(500)))
    monkeypatch.setattr(ros_demo_passthrough, "fly", fly)
    assert ros_demo_passthrough.run(options) == code
    assert ("passthrough: rate not held, found 250.0 Hz, wanted 400 Hz" in capsys.readouterr().err) == bool(code)


@pytest.mark.parametrize("commands, code", [(2000, 0), (1500, 1)])
def test_fewer_commands_than_the_load_is_made_of_are_told(options, monkeypatch, capsys, commands, code):
    class Rig:
        def __init__(self, *_):
            pass

        def close(self):
            pass
    monkeypatch.setattr(ros_demo_load, "Rig", Rig)
    monkeypatch.setattr(ros_demo_load, "measure", lambda rig, seconds: {
        "seconds": seconds, "commands": commands, "pauses": 0, "topics": {}, "stamp_error_ms": {"mean": 0.0, "std": 0.0, "max": 0.0},
        "sequence_gaps": 0, "frames_dropped": 0, "send_failures": 0, "memory_growth_kB": 0})
    assert ros_demo_load.run(options) == code
    assert ("load: rate not held, found 75.0 Hz, wanted 100 Hz" in capsys.readouterr().err) == bool(code)
