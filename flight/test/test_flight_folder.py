# SPDX-License-Identifier: BSD-3-Clause
"""A real flight folder read with programs nobody here wrote: the log with mcap and mcap_ros2, the page with an HTML
parser, the summary with json."""
import base64
import gzip
import io
import json
import os
import re
import signal
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

TOOLS = Path(__file__).parents[2] / "tools"
PROGRAM = Path(os.environ.get("ROSFLIGHT_BUILD", Path(__file__).parents[2] / "build" / "release")) / "apps" / "rosflight"


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fly") / "flight"
    run = subprocess.run([PROGRAM, "fly", "--json", "--out", folder], capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stdout + run.stderr
    return folder, json.loads(run.stdout)


def test_summary_tells_of_a_success(flight):
    folder, summary = flight
    assert summary["success"] and summary["landed"] and summary["disarmed"]
    assert summary["waypoints_reached"] == summary["waypoints_total"] >= 5
    assert summary == json.loads((folder / "summary.json").read_text())
    printed = subprocess.run([sys.executable, TOOLS / "log_identity.py", folder / "flight.mcap"], check=True,
                             capture_output=True, text=True).stdout
    assert printed.split()[0] == summary["log_sha256"]
    assert summary["log_bytes"] == (folder / "flight.mcap").stat().st_size <= 8_000_000


def test_summary_has_truth_and_estimate_side_by_side(flight):
    _, summary = flight
    assert (summary["outcome"], summary["pilot"], summary["score_radius_m"]) == ("mission_done", "hover", 2.0)
    for waypoint in summary["waypoints"]:
        assert waypoint.keys() == {"reached", "measure", "truth_distance_m", "estimate_distance_m", "time_s"}
        assert waypoint["reached"] and waypoint["measure"] == "point"
        assert waypoint["estimate_distance_m"] < waypoint["truth_distance_m"] < 2.0
    assert summary["touchdown_speed_m_s"] <= 1.5 and summary["touchdown_distance_m"] <= 3.0
    assert 0 <= summary["touchdown_tilt_deg"] < 15


CHECKS = re.findall(r'\{Check::k\w+, +"([^"]+)"', (Path(__file__).parents[2] / "firmware/core/arming_checks.hpp").read_text())


def test_checks_before_arming_are_those_of_the_firmware(flight):
    folder, summary = flight
    list_ = json.loads((folder / "preflight.json").read_text())
    assert list_["ready"] is True
    assert [check["row"] for check in list_["checks"]] == CHECKS
    for check in list_["checks"]:
        assert check["verdict"] in ("pass", "warning") and (check["reason"] == "") == (check["verdict"] == "pass"), check
    times = [check["time_s"] for check in list_["checks"]]
    armed_s = summary["sim_time_s"] - summary["flight_time_s"]
    assert times == sorted(times) and 1 < times[0] < times[-1] < armed_s + 1 and times[-1] - times[0] < 0.5


def test_checks_of_a_vehicle_that_does_not_arm_say_why(tmp_path):
    code, _ = fly(tmp_path, "--fault", "rc_silence@0")
    assert code == 1
    list_ = json.loads((tmp_path / "f" / "preflight.json").read_text())
    assert list_["ready"] is False
    assert [(check["row"], check["reason"]) for check in list_["checks"] if check["verdict"] == "refuses"][0] == ("receiver", "RC signal lost")


def fly(tmp_path, *arguments):
    run = subprocess.run([PROGRAM, "fly", "--json", "--no-log", "--out", tmp_path / "f", *arguments], capture_output=True,
                         text=True, timeout=300)
    return run.returncode, json.loads(run.stdout)


def test_what_does_not_exist_is_null(tmp_path):
    code, summary = fly(tmp_path, "--fault", "motor0_dead@20")
    assert (code, summary["success"], summary["outcome"]) == (1, False, "crash")
    assert summary["touchdown_speed_m_s"] > 4.0
    assert summary["waypoints"][6] == {"reached": False, "measure": "point", "truth_distance_m": None,
                                       "estimate_distance_m": None, "time_s": None}
    (tmp_path / "g").mkdir()
    code, summary = fly(tmp_path / "g", "--pilot", "idle", "--set", "vehicle.firmware.TAKE_MIN_THR=1")
    assert (code, summary["outcome"], summary["tracking_rms_m"]) == (1, "timeout", None)
    assert (summary["touchdown_speed_m_s"], summary["touchdown_distance_m"]) == (None, None)


def test_the_score_radius_is_that_of_the_mission(tmp_path):
    mission = tmp_path / "m.yaml"
    text = (TOOLS.parent / "missions/default.yaml").read_text()
    mission.write_text("score_radius_m: 0.1\n" + text)
    code, summary = fly(tmp_path, "--mission", str(mission))
    assert (code, summary["outcome"], summary["score_radius_m"]) == (1, "landed_elsewhere", 0.1)
    assert [w["reached"] for w in summary["waypoints"]] == [w["truth_distance_m"] <= 0.1 for w in summary["waypoints"]]
    assert 0 < summary["waypoints_reached"] < 7
    mission.write_text("score_radius_m: -1\n" + text)
    run = subprocess.run([PROGRAM, "fly", "--mission", mission, "--out", tmp_path / "g"], capture_output=True, text=True)
    assert (run.returncode, (tmp_path / "g").exists()) == (2, False)
    assert run.stderr == f"rosflight: {mission}:1: score_radius_m: found -1, allowed a number > 0 and <= 1000\n"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_flight_that_is_stopped_leaves_a_whole_folder(tmp_path, number):
    folder = tmp_path / "f"
    run = subprocess.Popen([PROGRAM, "fly", "--realtime", "--out", folder], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                           text=True)
    for line in run.stderr:  # until it flies, or at least runs
        if "stage" in line:
            break
    run.send_signal(number)
    out, _ = run.communicate(timeout=60)
    assert run.returncode == 128 + number
    assert out.startswith("Interrupted in stage ")
    summary = json.loads((folder / "summary.json").read_text())
    assert (summary["outcome"], summary["success"]) == ("interrupted", False)
    with (folder / "flight.mcap").open("rb") as file:
        assert make_reader(file).get_summary().statistics.message_count == summary["log_messages"] > 0
    assert not list(folder.glob("*.part"))


def test_log_holds_the_whole_flight(flight):
    folder, summary = flight
    counts, last = {}, {}
    with (folder / "flight.mcap").open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for _, channel, message, decoded in reader.iter_decoded_messages():
            counts[channel.topic] = counts.get(channel.topic, 0) + 1
            last[channel.topic] = decoded
    topics = {topic.lstrip("/") for topic in counts}
    for topic in ("sim/truth_state", "imu/data", "attitude", "command", "output_raw", "status", "rc_raw"):
        assert topic in topics, sorted(topics)
    by_name = {topic.lstrip("/"): count for topic, count in counts.items()}
    steps = summary["sim_time_s"] * 400
    assert abs(by_name["sim/truth_state"] - steps / 4) <= 2
    assert abs(by_name["imu/data"] - steps) <= 4
    assert by_name["attitude"] <= steps / 4 + 2
    # Guidance runs on the estimate, which is there from the arming on, a hundred times a second; every second one is here.
    assert by_name["autonomy/estimate"] > 50 * (summary["flight_time_s"] - 1)
    assert by_name["trajectory_command"] <= by_name["autonomy/estimate"] + 2
    estimate = last["/autonomy/estimate"]
    assert all(0 < sigma < 1 for sigma in estimate.position_sigma) and not any(estimate.refusing)
    # As the firmware had them when it armed: those of the vehicle file among the defaults.
    parameters = [line for line in (folder / "parameters.yaml").read_text().splitlines() if line.startswith("- {")]
    assert counts["/parameters"] == len(parameters) > 300
    status = last[next(t for t in counts if t.lstrip("/") == "status")]
    assert not status.armed


class Elements(HTMLParser):
    """Contents of the script elements of a page, by their id."""

    def __init__(self, text):
        super().__init__()
        self.found, self.open = {}, None
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.open = dict(attrs).get("id") if tag == "script" else None

    def handle_endtag(self, tag):
        self.open = None

    def handle_data(self, data):
        if self.open:
            self.found[self.open] = self.found.get(self.open, "") + data


@pytest.fixture
def built(tmp_path):
    """A project folder with a page, which is not the real one: web/test opens that in a browser."""
    root = tmp_path / "root"
    root.mkdir()
    for name in ("vehicles", "missions"):
        (root / name).symlink_to(TOOLS.parent / name)
    (root / "page").mkdir()
    (root / "page/report_page.html").write_text("<html>\n<!-- flight -->\n</html>\n")
    return root


def fly_at(root, folder, *options):
    run = subprocess.run([PROGRAM, "fly", "--mission", "hop", "--out", folder, *options], capture_output=True, text=True, timeout=300,
                         env={**os.environ, "ROSFLIGHT_DATA_DIR": str(root)})
    assert run.returncode == 0, run.stdout + run.stderr
    return run.stdout.splitlines()[-1]


def test_the_page_has_the_flight_inside(built, tmp_path):
    folder = tmp_path / "f"
    assert fly_at(built, folder) == f"flight folder    {folder}  (open report.html)"
    found = Elements((folder / "report.html").read_text()).found
    assert json.loads(found["flight-summary"]) == json.loads((folder / "summary.json").read_text())
    assert json.loads(found["flight-analysis"]) == json.loads((folder / "analysis.json").read_text())
    log = io.BytesIO(gzip.decompress(base64.b64decode(found["flight-log"], validate=True)))
    topics = {channel.topic for _, channel, _ in make_reader(log).iter_messages()}
    assert {"/sim/truth_state", "/rosout", "/parameters", "/imu/data"} <= topics and "/link/raw" not in topics
    assert not list(folder.glob("report.mcap*"))


def test_without_the_page_or_a_log_a_line_says_how_to_get_it(built, tmp_path):
    assert fly_at(built, tmp_path / "f", "--no-log").endswith("  (without a log, which report.html is made from)")
    (built / "page/report_page.html").unlink()
    line = fly_at(built, tmp_path / "g")
    assert line == (f"flight folder    {tmp_path / 'g'}  (./rosflight view {tmp_path / 'g'} shows it, and builds the page that later flights "
                    "leave as report.html)")
    for name in ("f", "g"):
        assert not (tmp_path / name / "report.html").exists()


@pytest.mark.parametrize("command", [["fly", "--view", "--out", "f"], ["view", "flight.mcap"], ["view", "udp:14998", "--out", "f"]])
def test_what_needs_the_page_ends_without_it_with_one_line_and_makes_no_folder(built, tmp_path, command):
    run = subprocess.run([PROGRAM.with_name("rosflight_view"), *command], capture_output=True, text=True, timeout=60, cwd=tmp_path,
                         env={**os.environ, "ROSFLIGHT_DATA_DIR": str(built)})
    assert (run.returncode, run.stdout, (tmp_path / "f").exists()) == (2, "", False)
    assert run.stderr == f"rosflight: page: found none in {built / 'build/web'}, allowed after ./rosflight view has built it\n"


def test_same_seed_same_log_in_another_process(flight, tmp_path):
    _, summary = flight
    run = subprocess.run([PROGRAM, "fly", "--json", "--out", tmp_path / "again"], capture_output=True, text=True,
                         timeout=300, cwd=tmp_path)
    assert json.loads(run.stdout)["log_sha256"] == summary["log_sha256"]


def test_a_full_log_has_every_step(flight, tmp_path):
    _, plot = flight
    run = subprocess.run([PROGRAM, "fly", "--json", "--log", "full", "--out", tmp_path / "f"], check=True,
                         capture_output=True, text=True, timeout=300)
    summary = json.loads(run.stdout)
    with (tmp_path / "f" / "flight.mcap").open("rb") as file:
        found = make_reader(file).get_summary()
    counts = {found.channels[key].topic: count for key, count in found.statistics.channel_message_counts.items()}
    steps = summary["sim_time_s"] * 400
    for topic in ("/sim/truth_state", "/sim/truth_vehicle", "/sim/forces_and_moments", "/imu/data", "/attitude"):
        assert abs(counts[topic] - steps) <= 2, topic
    for topic in ("/autonomy/estimate", "/trajectory_command", "/command"):
        assert counts[topic] > 100 * (summary["flight_time_s"] - 1), topic
    for topic in ("/sim/truth_wind", "/sim/pwm_output", "/imu/temperature", "/attitude/euler"):
        assert abs(counts[topic] - steps / 20) <= 2, topic
    assert summary["log_bytes"] <= 13_000_000
    assert summary["tracking_rms_m"] == plot["tracking_rms_m"] and summary["log_sha256"] != plot["log_sha256"]


@pytest.mark.parametrize("option", [["--no-log"], ["--log", "none"]])
def test_no_log_flies_the_same_and_leaves_none(flight, tmp_path, option):
    _, logged = flight
    run = subprocess.run([PROGRAM, "fly", "--json", *option, "--out", tmp_path / "f"], check=True, capture_output=True,
                         text=True, timeout=300)
    summary = json.loads(run.stdout)
    assert summary.keys() == logged.keys()
    assert (summary["log"], summary["log_sha256"], summary["log_messages"], summary["log_bytes"]) == (None, None, 0, 0)
    for key in ("sim_time_s", "tracking_rms_m", "own_tracking_max_m", "warnings", "counters"):
        assert summary[key] == logged[key], key
    assert not list((tmp_path / "f").glob("*.mcap*"))
    assert not (tmp_path / "f" / "report.html").exists()


@pytest.mark.parametrize("arguments, part", [
    (["--log", "some"], "some"),
    (["--log", "full", "--no-log"], "--no-log"),
    (["--vehicle", "zeppelin"], "zeppelin"),
    (["--mission", "moon"], "moon"),
    (["--fault", "gremlin@1"], "gremlin"),
    (["--seed", "many"], "seed"),
    (["--seed", "-1"], "seed"),
    (["--colour", "red"], "colour"),
    (["--state", "guess"], "guess"),
])
def test_nonsense_ends_with_one_line_and_code_2(arguments, part, tmp_path):
    run = subprocess.run([PROGRAM, "fly", *arguments, "--out", tmp_path / "f"], capture_output=True, text=True, timeout=60)
    assert run.returncode == 2
    assert part in run.stderr and len(run.stderr.strip().splitlines()) == 1, run.stderr
    assert run.stdout == "" and not (tmp_path / "f").exists()
