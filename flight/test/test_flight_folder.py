# SPDX-License-Identifier: BSD-3-Clause
"""A real flight folder read with programs nobody here wrote: the log with mcap and mcap_ros2, the report with an XML
and HTML parser, the summary with json."""
import json
import os
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
    # Guidance runs on the estimate, which is there from the arming on, a hundred times a second.
    assert by_name["autonomy/estimate"] > 100 * (summary["flight_time_s"] - 1)
    estimate = last["/autonomy/estimate"]
    assert all(0 < sigma < 1 for sigma in estimate.position_sigma) and not any(estimate.refusing)
    status = last[next(t for t in counts if t.lstrip("/") == "status")]
    assert not status.armed


def test_report_stands_alone(flight):
    folder, _ = flight
    page = (folder / "report.html").read_text()
    assert "://" not in page.replace("http://www.w3.org/", "")
    HTMLParser().feed(page)
    assert page.count("<svg") >= 8
    assert page.count('class="shade"') == 9, "errors of position, velocity, attitude inside 3 sigma"


def test_report_of_a_fixed_wing_shows_what_it_followed(tmp_path):
    subprocess.run([PROGRAM, "fly", "--vehicle", "anaconda", "--out", tmp_path / "f"], check=True, capture_output=True,
                   timeout=300)
    page = (tmp_path / "f" / "report.html").read_text()
    HTMLParser().feed(page)
    for part in ("Cross-track error", "Wind, to the east", "Touch-down from aim", "pitot", "sideslip"):
        assert part in page, part
    assert page.count('class="shade"') == 9 + 2, "the wind as well"
    assert "no data" not in page


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
    assert abs(counts["/attitude/euler"] - steps / 4) <= 2
    for topic in ("/sim/truth_wind", "/sim/pwm_output", "/imu/temperature"):
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
    assert "flight.mcap" not in (tmp_path / "f" / "report.html").read_text()


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
