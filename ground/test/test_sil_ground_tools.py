# SPDX-License-Identifier: BSD-3-Clause
"""The ground tools against the firmware as a process: every command, good and refused. scenarios.py has what runs."""

import csv
import json
import re
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from scenarios import ROOT, run_all  # noqa: E402

MEASURED = {"BARO_BIAS", "DIFF_PRESS_BIAS", "GROUND_LEVEL"}  # by the firmware, seconds after each start


@pytest.fixture(scope="module")
def said(tmp_path_factory):
    return run_all(tmp_path_factory.mktemp("ground"))


def of(said, name):
    return said[name].result()


def table_rows():
    with (ROOT / "firmware" / "core" / "parameters.csv").open() as file:
        return list(csv.DictReader(file))


def one_line(done, code=2):
    assert (done.code, done.out, len(done.err.splitlines())) == (code, "", 1), done
    assert done.err.startswith("rosflight: ")
    return done.err


# ---- parameters ------------------------------------------------------------------------------------


def test_the_list_has_every_parameter_with_default_and_unit(said):
    result = of(said, "listing")
    assert result["link"].startswith("pty:")
    rows = {row["name"]: row for row in json.loads(result["json"].out)}
    wanted = table_rows()
    assert len(rows) == len(wanted)
    for row in wanted:
        got = rows[row["name"]]
        assert got["unit"] == row["units"] and got["type"] == row["type"]
        assert got["default"] == pytest.approx(float(row["default"]), rel=1e-6)
        assert got["differs"] == (got["value"] != got["default"]), got
    assert {row["name"] for row in rows.values() if row["differs"]} <= MEASURED | {"RC_TYPE"}
    lines = result["text"].lines
    assert {line.split()[1] for line in lines[1:-1]} <= MEASURED | {"RC_TYPE"}
    assert re.search(r"^\* RC_TYPE +1 +0  enum$", result["text"].out, re.M)
    assert lines[-1] == f"{len(rows)} parameters, * {len(lines) - 2} differ from their defaults"


def values(done):
    return {row["name"]: row["value"] for row in json.loads(done.out)}


def test_what_was_set_is_read_back_and_outlives_a_restart_only_when_stored(said):
    result = of(said, "storing")
    assert (result["set"].code, result["set"].lines) == (
        0, ["RC_TYPE: set to 1", "X_EQ_TORQUE: set to -0.125", "writing parameters: done"])
    assert result["not stored"].lines[0] == "FAILSAFE_THR: set to 0.25"
    assert "--write stores them" in result["not stored"].lines[1]
    assert values(result["get"]) == {"RC_TYPE": 1, "X_EQ_TORQUE": -0.125, "FAILSAFE_THR": 0.25}
    assert values(result["restarted"]) == {"RC_TYPE": 1, "X_EQ_TORQUE": -0.125, "FAILSAFE_THR": -1}


def test_files_are_saved_compared_and_loaded(said):
    result = of(said, "files")
    assert result["save"].code == 0
    assert {row["name"] for row in json.loads(result["same"].out)} <= MEASURED
    assert result["text"].count("\n- {name: ") == len(table_rows())
    assert "found a file" in one_line(result["again"])
    assert result["differs"].code == 1
    assert json.loads(result["differs"].out) == [{"name": "RC_TYPE", "file": 1, "vehicle": 0}]
    assert result["load"].lines == ["2 parameters: 1 unchanged, 1 set", "writing parameters: done"]
    assert (result["loaded"].code, result["loaded"].lines) == (0, ["0 of 2 parameters of the file differ"])
    assert (result["unknown"].code, result["unknown"].lines[1:]) == (
        1, ["OF_ANOTHER: no such parameter", "nothing stored"])


@pytest.mark.parametrize("name, text", [
    ("range", "RC_ARM_THRESHOLD: found 0.3, allowed 0.01 .. 0.25 fraction"),
    ("odd", "found 1 words, allowed NAME VALUE"), ("no number", "RC_TYPE: found on, allowed a number"),
    ("no integer", "RC_TYPE: found 0.5, allowed a whole number"), ("unknown", "NO_SUCH: the vehicle has no such parameter"),
    ("unknown get", "NO_SUCH: the vehicle has no such parameter"), ("no file", "none.yaml"), ("no action", "subcommand"),
    ("file range", "bad.yaml:2: "), ("file range", "value: found 3, allowed 0 .. 2 enum"), ("file key", "bad.yaml:1: "),
    ("file key", "value: found nothing, allowed a number"), ("what", "WHAT: found yaw, allowed accel, airspeed, baro, esc, gyro, mag, rc"), ("period", "--period"),
])
def test_bad_input_is_one_line_and_changes_nothing(said, name, text):
    result = of(said, "bad input")
    assert text in one_line(result[name])
    assert values(result["untouched"]) == {"RC_TYPE": 0}


# ---- links -----------------------------------------------------------------------------------------


def test_what_sil_prints_is_a_link(said):
    result = of(said, "other links")
    for name in ("udp", "lean"):
        assert (result[name].code, result[name].lines[:1]) == (0, ["RC_TYPE: set to 1"]), result[name]
    assert result["udp port"].code == 0
    assert "storage" in {row["name"] for row in json.loads(result["lean checks"].out)["checks"]}


@pytest.mark.parametrize("name, text", [
    ("closed", "no answer from tcp:127.0.0.1:9 within 0.5 s: no heartbeat; tcp 127.0.0.1:9: cannot connect"),
    ("device", "no answer from /dev/no_such_device within 0.5 s: no heartbeat; /dev/no_such_device: cannot be opened"),
    ("udp", "no answer from udp:127.0.0.1:9 within 0.5 s"), ("silent", "within 0.5 s: no heartbeat"),
    ("wrong", 'link "usb:3": found "usb", allowed serial:PATH'), ("file", "README.md: is not a serial port"),
])
def test_no_answer_is_one_line_with_link_and_timeout(said, name, text):
    assert text in one_line(of(said, "no answer")[name])


def test_a_vehicle_that_does_not_send_its_table_is_one_line(said):
    assert "no answer" in one_line(of(said, "old firmware")["params"])


# ---- armed -----------------------------------------------------------------------------------------


def test_the_reason_of_an_armed_vehicle_is_shown(said):
    result = of(said, "armed")
    assert result["set"].code == 1
    assert result["set"].lines[0] == 'RC_TYPE: 1 refused, stays at 0 (vehicle: Not while armed, kept: RC_TYPE)'
    assert (result["write"].code, result["write"].lines) == (
        1, ["PID_ROLL_ANG_P: set to 1.1", "writing parameters: refused: the vehicle is armed"])
    for what in ("gyro", "accel", "baro", "airspeed", "mag", "rc", "esc"):
        assert result[what].code == 1 and "the vehicle is armed" in result[what].lines[-1], result[what]
    assert result["preflight"].code == 1
    assert any(re.match(r"FAIL +disarmed +the vehicle is armed", line) for line in result["preflight"].lines)


# ---- calibration -----------------------------------------------------------------------------------


@pytest.mark.parametrize("what, figures", [
    ("gyro", ["gyro before: standard deviation", "gyro after: offset left"]),
    ("accel", ["accel before: tilt", "accel after: residual against g", "accel after: tilt"]),
    ("baro", ["baro before: noise", "ground: "]), ("airspeed", ["airspeed before: noise", "airspeed after: offset left"])])
def test_a_vehicle_at_rest_is_calibrated_with_its_figures_and_stored(said, what, figures):
    done = of(said, what)["first"]
    assert (done.code, done.err) == (0, ""), done
    for figure in figures:
        assert any(line.startswith(figure) for line in done.lines), (figure, done)
    assert "writing parameters: done" in done.lines
    for value, limit in re.findall(r" (-?[\d.e-]+) \S+, limit ([\d.]+)", done.out):
        assert abs(float(value)) <= float(limit)


@pytest.mark.parametrize("name, text", [
    ("shaken gyro", r"standard deviation 0\.\d+ rad/s, limit 0.05 rad/s; .*nothing changed"),
    ("turning gyro", r"Gyro calibration refused: mean 0\.50 rad/s"), ("tilted accel", r"tilt 11\.\d deg, limit 5 deg"),
    ("noisy baro", r"noise \d+(\.\d)? Pa, limit 5 Pa"), ("noisy airspeed", r"noise \d+(\.\d)? Pa, limit 10 Pa"),
    ("resting mag", r"coverage: 0 of 6 faces, limit 6"),
    ("resting sticks", r"roll stick \(channel 0\): 1500 \.\. 1500 us, limit 1100 \.\. 1900 us")])
def test_bad_data_are_refused_with_figure_and_limit(said, name, text):
    result = of(said, name)
    assert result["calibrate"].code == 1
    assert re.search(text, result["calibrate"].lines[-1]), result["calibrate"]
    changed = {line.split()[1] for line in result["params"].lines[1:-1]}
    assert changed <= MEASURED


def test_a_magnetometer_that_is_turned_on_all_faces_is_calibrated(said):
    result = of(said, "turned by hand")
    done = result["calibrate"]
    assert done.code == 0 and result["stored"], done
    assert re.search(r"mag: fit residual 0\.\d+ % of the field, limit 5 %; \d\d % of the sphere; field 50\.0 uT", done.out)
    for axis, wanted in zip("XYZ", result["hard_iron_T"]):
        assert result["values"][f"MAG_{axis}_BIAS"] == pytest.approx(wanted, abs=0.2e-6)


def test_a_sensor_that_is_not_there_is_one_line(said):
    done = of(said, "no baro")["calibrate"]
    assert done.code == 2 and "baro: no samples from tcp:127.0.0.1:" in done.err


def test_ranges_centres_and_trims_of_a_transmitter_are_found(said):
    done = of(said, "transmitter")["calibrate"]
    assert done.code == 0, done
    for k, stick in ((0, "roll"), (1, "pitch"), (3, "yaw"), (2, "throttle")):
        assert f"{stick} stick (channel {k}): 1000 .. 2000 us" in done.lines
    assert "pitch centre 1500 us" in done.lines and "roll centre 1530 us" in done.lines and "throttle low 1000 us" in done.lines
    trim = float(re.search(r"trim X_EQ_TORQUE: 0\.0 -> (\S+)", done.out)[1])
    assert trim > 0.001
    assert "trim Y_EQ_TORQUE: 0.0 -> 0.0" in done.lines


def test_a_stick_that_rests_off_its_centre_is_refused(said):
    done = of(said, "off centre")["calibrate"]
    assert done.code == 1
    assert done.lines[-1].startswith("rc calibration refused: roll centre 1650 us, moving by 0 us; limits 1400 .. 1600 us")


def test_both_ends_reach_the_speed_controllers_and_the_mixer_comes_back(said):
    result = of(said, "speed controllers")
    done = result["calibrate"]
    assert done.code == 0, done
    assert "endpoints sent: 0.000 and 1.000 on 10 outputs" in done.lines
    assert done.lines[-1] == "former mixer put back and stored"
    before, now = values(of(said, "stopped speed controllers")["before"]), values(result["restarted"])
    assert now["PRIMARY_MIXER"] == 2
    assert [name for name in now if "MIXER" in name and now[name] != before[name]] == []


def test_speed_controllers_need_a_confirmation_and_ctrl_c_puts_the_mixer_back(said):
    result = of(said, "stopped speed controllers")
    assert result["no flag"].code == 1 and "--props-off" in result["no flag"].out
    assert result["stopped"].code == 130 and "former mixer put back and stored" in result["stopped"].lines
    assert values(result["mixer"]) == {"PRIMARY_MIXER": 2}


def test_ctrl_c_puts_the_correction_of_the_magnetometer_back(said):
    result = of(said, "stopped mag")
    assert result["stopped"].code == 130
    assert "magnetometer calibration: cancelled; old correction put back" in result["stopped"].lines
    assert values(result["bias"])["MAG_X_BIAS"] == pytest.approx(1e-5)


# ---- monitor ---------------------------------------------------------------------------------------


def test_the_monitor_shows_what_arrives(said):
    result = of(said, "watching")
    names = [line.split()[0] for line in result["screen"].lines]
    assert names[:3] == ["firmware", "link", "state"]
    assert {"attitude", "rates", "IMU", "mag", "baro", "GNSS", "battery", "RC", "outputs"} <= set(names)
    now = json.loads(result["json"].out)
    assert now["connected"] and now["state"]["armed"] is False
    assert "invalid mixer" in now["state"]["errors"]
    assert now["imu"]["rate_Hz"] == pytest.approx(400, rel=0.2) and abs(now["imu"]["accel_m_s2"][2] + 9.8) < 1
    assert abs(now["attitude"]["roll_deg"]) < 5 and now["rc"]["pulse_us"][:4] == [1500, 1500, 1000, 1500]
    assert now["battery"]["voltage_V"] > 20 and now["gnss"]["fix"] == 3
    assert now["link"]["loss_percent"] < 1 and now["link"]["synchronised"]


def test_the_monitor_prints_lines_or_draws_in_place_and_ends_with_ctrl_c(said):
    result = of(said, "watching")
    assert result["lines"].code == 0 and len(result["lines"].lines) >= 3
    assert all(re.match(r"roll .* V \| 3D, \d+ sat \| RC 1500 .* disarmed", line) for line in result["lines"].lines)
    assert "\x1b" not in result["lines"].out
    assert result["terminal"].code == 0 and "\x1b[H" in result["terminal"].out and "Ctrl-C ends" in result["terminal"].out


def test_the_monitor_says_when_the_vehicle_is_gone(said):
    assert of(said, "watching")["lost"] == (False, 0)


# ---- checks before arming --------------------------------------------------------------------------


def test_checks_that_fail_are_told_with_their_reason(said):
    result = of(said, "checks")
    assert result["fails"].code == 1
    rows = {row["name"]: row for row in json.loads(result["json"].out)["checks"]}
    assert rows["mixer"] == {"name": "mixer", "result": "fail", "text": "invalid mixer"}
    assert rows["calibration"]["result"] == "fail" and rows["failsafe throttle"]["result"] == "fail"
    assert rows["parameters stored"]["result"] == "not_told"
    assert rows["storage"]["result"] == rows["IMU samples"]["result"] == "pass"
    assert len(rows) > 35


def test_a_vehicle_that_is_ready_ends_with_0(said):
    done = of(said, "checks")["passes"]
    assert done.code == 0, done
    assert not [line for line in done.lines if line.startswith("FAIL")] and done.lines[-1].startswith("ready: ")


def test_what_an_older_firmware_does_not_tell_is_not_guessed(said):
    done = of(said, "old firmware")["preflight"]
    assert done.code == 1
    rows = {row["name"]: row for row in json.loads(done.out)["checks"]}
    assert rows["RC lost"]["result"] == "fail" and rows["invalid mixer"]["result"] == "pass"
    for name in ("throttle low", "level", "stored parameters", "failsafe throttle", "battery volts", "gyro calibrated"):
        assert rows[name]["result"] == "not_told", rows[name]
    assert rows["RC channels"]["result"] == "fail"


# ---- documents -------------------------------------------------------------------------------------


def test_the_commands_of_the_page_work_as_written(said):
    for command, done in of(said, "documented").items():
        # The fresh vehicle is not ready, nobody moves its sticks, and it still measures the pressure of the ground.
        wanted = (0, 1) if re.search(r"preflight| rc | diff ", command) else (0,)
        assert done.code in wanted and done.err == "" and done.out, (command, done)
