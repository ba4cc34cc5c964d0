# SPDX-License-Identifier: BSD-3-Clause
"""What ./rosflight prints about itself, and about what was requested."""
import csv
import json
import os
import re
import signal
import subprocess
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROGRAM = Path(os.environ.get("ROSFLIGHT_BUILD", ROOT / "build" / "release")) / "apps" / "rosflight"
COMMANDS = ["fly", "view", "replay", "sil", "mixer", "trim", "sdf", "params", "calibrate", "monitor", "preflight", "blackbox"]


@pytest.fixture(scope="module")
def clone(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fresh") / "clone"
    subprocess.run(["git", "clone", "--quiet", "--no-hardlinks", ROOT, folder], check=True)
    for name in ["rosflight", "tools/ready.sh", "tools/log_table.py", *(f"apps/help/{command}.txt" for command in COMMANDS)]:
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes((ROOT / name).read_bytes())  # as they are here, committed or not
    return folder


@pytest.mark.parametrize("command", COMMANDS)
def test_the_text_is_what_the_program_says(command):
    said = subprocess.run([PROGRAM, command, "--help"], check=True, capture_output=True, text=True).stdout
    assert (ROOT / f"apps/help/{command}.txt").read_text() == said, f"write it again: {PROGRAM} {command} --help"


@pytest.mark.parametrize("command", [*COMMANDS, "log", "test", "bench", "ros"])
def test_help_needs_no_build_and_makes_no_file(clone, command):
    def files():
        return {str(path.relative_to(clone)) for path in clone.rglob("*") if ".git" not in path.relative_to(clone).parts}

    before, start = files(), time.monotonic()
    run = subprocess.run([clone / "rosflight", command, "--help"], capture_output=True, text=True, cwd=clone)
    assert (run.returncode, run.stderr) == (0, "") and len(run.stdout) > 100
    assert time.monotonic() - start < 5  # under a second; the machine may be busy
    assert files() == before


def test_version_names_the_commit(clone):
    commit = subprocess.run(["git", "-C", clone, "rev-parse", "HEAD"], check=True, capture_output=True, text=True).stdout.strip()
    said = subprocess.run([clone / "rosflight", "--version"], check=True, capture_output=True, text=True).stdout
    assert re.fullmatch(rf"rosflight \d+\.\d+\.\d+, commit {commit[:12]}\n", said)
    assert not (clone / "build").exists()
    built = subprocess.run([PROGRAM, "--version"], check=True, capture_output=True, text=True).stdout
    assert built.split(",")[0] == said.split(",")[0].strip()


def test_a_fault_after_the_end_is_a_warning(tmp_path):
    run = subprocess.run([PROGRAM, "fly", "--json", "--no-log", "--mission", "hop", "--fault", "mag@20", "--fault", "baro@500:2",
                          "--out", tmp_path / "f"], capture_output=True, text=True)
    assert run.returncode == 0
    assert json.loads(run.stdout)["faults_too_late"] == ["baro@500:2"]
    warnings = [line for line in run.stderr.splitlines() if "warning" in line]
    assert len(warnings) == 1
    assert re.fullmatch(r"rosflight: warning: --fault baro@500:2 did not happen: the flight ended at \d+\.\d s", warnings[0])


@pytest.mark.parametrize("vehicle, mission, kinds", [
    ("multirotor", "fixedwing", ("fixed wing", "multirotor")), ("multirotor", "racetrack", ("fixed wing", "multirotor")),
    ("anaconda", "square", ("multirotor", "fixed wing"))])
def test_a_mission_for_the_other_kind_of_aircraft_says_so(tmp_path, vehicle, mission, kinds):
    run = subprocess.run([PROGRAM, "fly", "--vehicle", vehicle, "--mission", mission, "--out", tmp_path / "f"],
                         capture_output=True, text=True)
    assert (run.returncode, run.stdout, len(run.stderr.splitlines())) == (2, "", 1)
    assert run.stderr.endswith("; this mission is for a {}, the vehicle is a {}\n".format(*kinds))
    assert not (tmp_path / "f").exists()


def test_a_summary_tells_where_a_flight_comes_from(tmp_path):
    words = ["fly", "--json", "--no-log", "--mission", "hop", "--seed", "3", "--wind", "2,90", "--fault", "mag@20",
             "--set", "vehicle.body.mass_kg=3.4", "--out", str(tmp_path / "f")]
    run = subprocess.run([PROGRAM, *words], capture_output=True, text=True)
    summary = json.loads(run.stdout)
    assert summary["arguments"] == words
    assert (summary["seed"], summary["wind"], summary["faults"], summary["pilot"]) == (3, "2,90", ["mag@20"], "hover")
    assert summary["overrides"] == ["vehicle.body.mass_kg=3.4"] and summary["score_radius_m"] == 2.0
    assert re.fullmatch(r"\d+\.\d+\.\d+", summary["version"])
    assert summary["commit"] is None or re.fullmatch(r"[0-9a-f]{40}", summary["commit"])
    assert isinstance(summary["changed_since_commit"], bool)
    assert summary == json.loads((tmp_path / "f" / "summary.json").read_text())


def test_many_seeds_are_a_row_each(tmp_path):
    file = tmp_path / "rows.csv"
    words = ["fly", "--seeds", "1:4", "--no-log", "--mission", "hop", "--out", file]
    run = subprocess.run([PROGRAM, *words], capture_output=True, text=True, cwd=tmp_path)
    assert (run.returncode, run.stderr) == (0, "")
    assert re.match(r"4 of 4 flights in \d+\.\d s, \d+ times real time\n", run.stdout) and "mission_done" in run.stdout
    rows = list(csv.DictReader(file.open()))
    assert [row["seed"] for row in rows] == ["1", "2", "3", "4"]
    alone = subprocess.run([PROGRAM, "fly", "--json", "--no-log", "--mission", "hop", "--seed", "3", "--out", tmp_path / "f"],
                           capture_output=True, text=True)
    summary = json.loads(alone.stdout)
    for key in ("outcome", "tracking_rms_m", "touchdown_distance_m", "flight_time_s"):
        assert rows[2][key] == summary[key] or abs(float(rows[2][key]) - summary[key]) < 1e-3, key
    again = subprocess.run([PROGRAM, *words], capture_output=True, text=True)
    assert (again.returncode, again.stderr) == (2, f"rosflight: --out: found {file}, allowed a new file\n")


def test_seeds_that_fail_are_listed_with_the_command_that_repeats_them(tmp_path):
    run = subprocess.run([PROGRAM, "fly", "--seeds", "5:6", "--no-log", "--fault", "motor0_dead@20", "--out", tmp_path / "r.csv"],
                         capture_output=True, text=True)
    assert run.returncode == 1
    repeat = re.search(r"seed 5: Crash.*\n  \./rosflight (fly .*)", run.stdout)[1].split()
    once = subprocess.run([PROGRAM, *repeat, "--json", "--no-log", "--out", tmp_path / "f"], capture_output=True, text=True)
    row = next(csv.DictReader((tmp_path / "r.csv").open()))
    assert abs(json.loads(once.stdout)["touchdown_speed_m_s"] - float(row["touchdown_speed_m_s"])) < 1e-3


@pytest.mark.parametrize("words, said", [
    (["--seeds", "4:1", "--out", "r.csv"], "--seeds: found '4:1', allowed FIRST:LAST"),
    (["--seeds", "1:2"], "--out: found nothing, allowed a CSV file with --seeds"),
    (["--seeds", "1:2", "--log", "full", "--out", "r.csv"], "--log: found full with --seeds, allowed none"),
    (["--seeds", "1:2", "--json", "--out", "r.csv"], "--json: found with --seeds, allowed with one flight"),
    (["--seeds", "1:2", "--vehicle", "none", "--out", "r.csv"], "vehicle: found none"),
    (["--seeds", "1:2", "--out", "nowhere/r.csv"], "nowhere/r.csv"),
])
def test_bad_campaigns_are_one_line_and_leave_no_file(tmp_path, words, said):
    run = subprocess.run([PROGRAM, "fly", *words], capture_output=True, text=True, cwd=tmp_path)
    assert (run.returncode, run.stdout, len(run.stderr.splitlines())) == (2, "", 1)
    assert said in run.stderr
    assert not list(tmp_path.iterdir())


def test_a_campaign_that_is_stopped_keeps_its_rows(tmp_path):
    file = tmp_path / "rows.csv"
    run = subprocess.Popen([PROGRAM, "fly", "--seeds", "1:100000", "--mission", "hop", "--no-log", "--out", file],
                           stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    time.sleep(2)
    run.send_signal(signal.SIGINT)
    out, _ = run.communicate(timeout=60)
    assert run.returncode == 130
    rows = list(csv.DictReader(file.open()))
    assert len(rows) > 1 and f"{len(rows)} of 100000 flights" in out
    assert [int(row["seed"]) for row in rows] == sorted(int(row["seed"]) for row in rows)
