# SPDX-License-Identifier: BSD-3-Clause
"""rosflight.fly: the flights of the command, to the bit; what it returns, and what it says of bad input."""

import json
import multiprocessing
import os
import signal
import subprocess
import sys
import textwrap
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import rosflight

HOP = {"mission": "hop", "log": "none", "series_hz": 0}


@pytest.mark.parametrize("arguments, options", [
    ({"mission": "hop", "seed": 7}, ["--mission", "hop", "--seed", "7"]),
    ({"mission": "hop", "seed": 3, "wind": (4, 270, 2.5), "faults": "baro@12:3", "set": {"vehicle.body.mass_kg": 3.25}, "state": "truth"},
     ["--mission", "hop", "--seed", "3", "--wind", "4,270,2.5", "--fault", "baro@12:3", "--set", "vehicle.body.mass_kg=3.25", "--state",
      "truth"]),
    ({"vehicle": "anaconda", "log": "full"}, ["--vehicle", "anaconda", "--log", "full"]),
])
def test_a_flight_is_that_of_the_command_to_the_bit(arguments, options, command, tmp_path):
    summary = command(*options)
    flight = rosflight.fly(**arguments, out=tmp_path / "here")
    assert flight.log_sha256 == summary["log_sha256"] and len(flight.log_sha256) == 64
    timed = {"wall_time_s", "realtime_factor", "log", "arguments", "commit", "changed_since_commit"}
    assert {k: v for k, v in flight.summary.items() if k not in timed} == {k: v for k, v in summary.items() if k not in timed}
    here, there = ({path.name for path in folder.iterdir()} for folder in (tmp_path / "here", tmp_path / "by_command"))
    assert here | {"report.html"} == there | {"report.html"}


def test_a_flight_without_a_log_has_no_folder_and_the_same_end(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    without = rosflight.fly(mission="hop", seed=7, log="none")
    logged = rosflight.fly(mission="hop", seed=7)
    assert not without.folder and without.log_sha256 is None
    assert logged.folder.samefile(tmp_path / "flights/0001") and (logged.folder / "flight.mcap").exists()
    assert os.listdir(tmp_path) == ["flights"]
    timed = {"wall_time_s", "realtime_factor", "log", "log_sha256", "log_messages", "log_bytes"}
    assert {k: v for k, v in without.summary.items() if k not in timed} == {k: v for k, v in logged.summary.items() if k not in timed}
    for name, values in without.series.items():
        assert np.array_equal(values, logged.series[name], equal_nan=True), name


def test_what_a_flight_tells():
    flight = rosflight.fly(mission="hop", seed=7, log="none")
    assert flight.success and flight.outcome == "mission_done" and flight.seed == 7
    assert flight.waypoints_reached == flight.waypoints_total > 0
    assert [note.text for note in flight.notes if note.source == "mission"][-1] == "stage done"
    series = flight.series
    assert np.allclose(np.diff(series["t_s"]), 0.01)
    assert series["position_m"].shape == (len(series["t_s"]), 3) and series["attitude"].shape[1] == 4
    assert np.allclose(np.linalg.norm(series["attitude"], axis=1), 1)
    # The velocity is the derivative of the position: central differences of a smooth motion are off by less than a
    # tenth of the largest velocity.
    slope = (series["position_m"][2:] - series["position_m"][:-2]) / 0.02
    assert np.abs(slope - series["velocity_m_s"][1:-1]).max() < 0.1 * np.abs(series["velocity_m_s"]).max()
    errors = np.linalg.norm(series["position_m"] - series["setpoint_m"], axis=1)
    assert np.sqrt(np.nanmean(errors**2)) == pytest.approx(flight.tracking_rms_m, abs=0.02)  # at 100 Hz instead of 400


def test_the_series_is_a_table_of_pandas():
    pytest.importorskip("pandas")
    table = rosflight.fly(mission="hop", log="none", series_hz=10).to_pandas()
    assert table.index.name == "t_s" and {"position_m.x", "attitude.w", "battery_V"} <= set(table.columns)
    assert table["position_m.z"].min() < -1  # it flew


@pytest.mark.parametrize("arguments, kind, said", [
    ({"vehicle": "plane9"}, ValueError, "plane9"),
    ({"mission": "nowhere"}, ValueError, "mission: found 'nowhere', allowed a file or"),
    ({"vehicle": 7}, TypeError, "vehicle: found 7, allowed a name or a path"),
    ({"seed": -1}, ValueError, "seed: found -1, allowed 0 to"),
    ({"seed": 1.5}, TypeError, "seed: found 1.5, allowed a whole number"),
    ({"seed": True}, ValueError, "seed: found True"),
    ({"wind": (50, 0)}, ValueError, "wind: found '50,0', allowed SPEED,FROM_DEG"),
    ({"wind": (float("nan"), 0)}, ValueError, "wind: found nan, allowed a finite number"),
    ({"wind": 5}, TypeError, "wind: found 5, allowed (SPEED, FROM_DEG[, W20])"),
    ({"faults": ["wings@3"]}, ValueError, "wings"),
    ({"faults": [3]}, TypeError, "faults: found 3, allowed a text"),
    ({"set": {"body.mass": 3}}, ValueError, "body.mass"),
    ({"set": {"body.mass_kg": float("inf")}}, ValueError, "set, body.mass_kg: found inf"),
    ({"state": "guess"}, ValueError, "state: found 'guess', allowed estimate, truth"),
    ({"log": "some"}, ValueError, "log: found 'some', allowed plot, full, none"),
    ({"series_hz": 30}, ValueError, "series_hz: found 30, allowed 0 or a divisor of 400"),
])
def test_bad_input_is_one_line_and_nothing_is_written(arguments, kind, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(kind) as raised:
        rosflight.fly(**arguments)
    assert said in str(raised.value) and "\n" not in str(raised.value)
    assert os.listdir(tmp_path) == []


def test_a_folder_with_something_in_it_is_left_alone(tmp_path):
    (tmp_path / "mine").write_text("kept")
    with pytest.raises(ValueError, match="allowed a new or empty folder"):
        rosflight.fly(mission="hop", out=tmp_path)
    assert os.listdir(tmp_path) == ["mine"]


def test_threads_fly_at_once_and_each_as_if_alone():
    alone = [rosflight.fly(seed=seed, **HOP | {"series_hz": 10}) for seed in (1, 2)]
    with ThreadPoolExecutor(2) as pool:
        both = list(pool.map(lambda seed: rosflight.fly(seed=seed, **HOP | {"series_hz": 10}), (1, 2)))
    for one, other in zip(alone, both):
        assert all(np.array_equal(one.series[name], other.series[name], equal_nan=True) for name in one.series)


def test_other_threads_of_python_run_while_it_flies():
    """The interpreter's lock is free: a thread that counts gets on during one call."""
    counted, stop = [0], threading.Event()

    def count():
        while not stop.wait(0.001):
            counted[0] += 1

    thread = threading.Thread(target=count)
    thread.start()
    before = counted[0]
    rosflight.fly(log="none", series_hz=0)
    during = counted[0] - before
    stop.set()
    thread.join()
    assert during >= 3


def _rms(seed):
    return rosflight.fly(seed=seed, **HOP).tracking_rms_m


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_processes_fly_the_same(method):
    with multiprocessing.get_context(method).Pool(2) as pool:
        assert pool.map(_rms, (1, 2)) == [_rms(1), _rms(2)]


def test_ctrl_c_ends_a_flight_and_its_folder_is_whole(tmp_path):
    """The same as with the command: an interrupted flight leaves its folder."""
    script = textwrap.dedent("""
        import rosflight, signal
        signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell has its background jobs ignore it
        try:
            print("flying", flush=True)
            for seed in range(1000):
                rosflight.fly("multirotor", "survey", seed=seed, out=f"flight{seed}")
        except KeyboardInterrupt:
            print("interrupted")
    """)
    with subprocess.Popen([sys.executable, "-c", script], cwd=tmp_path, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout.readline() == "flying\n"
            while not list(tmp_path.glob("flight0/*")):
                pass
            process.send_signal(signal.SIGINT)
            said, _ = process.communicate(timeout=20)
        finally:
            process.kill()  # it would write flights until the disk is full
    assert (said, process.returncode) == ("interrupted\n", 0)
    folders = sorted(tmp_path.iterdir())
    last = json.loads((folders[-1] / "summary.json").read_text())
    assert last["outcome"] == "interrupted" and (folders[-1] / "flight.mcap").exists()


def test_vehicles_and_missions_are_those_of_the_package():
    assert {"multirotor", "anaconda"} <= set(rosflight.vehicles()) and {"default", "hop"} <= set(rosflight.missions())
    assert "mixer_frame_x650" not in rosflight.vehicles()
