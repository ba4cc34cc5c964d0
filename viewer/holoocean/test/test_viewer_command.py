# SPDX-License-Identifier: BSD-3-Clause
"""`fly --viewer holoocean` as a person starts it: the flight is the same to the bit whatever the engine does; bad input."""

import hashlib
import json
import os
import signal
import subprocess
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
PROGRAM = ROOT / os.environ.get("ROSFLIGHT_BUILD", "build/release") / "apps" / "rosflight"
STANDIN = Path(__file__).with_name("standin_engine.py")
GAZEBO = ROOT / "build/gazebo/flight/gazebo/engine/gazebo_engine"
FLY = [PROGRAM, "fly", "--mission", "hop"]
VIEWER = ["--viewer", "holoocean", "--viewer-offscreen"]
AS_ROOT = " (run by root, which Unreal's programs refuse)" if os.geteuid() == 0 else ""
SCENARIO = {"ticks_per_sec": 30, "frames_per_sec": False, "agents": [{"agent_type": "UavAgent", "sensors": [
    {"sensor_type": "RGBCamera", "Hz": 10, "configuration": {"CaptureWidth": 16, "CaptureHeight": 16}},
    {"sensor_type": "RangeFinderSensor", "configuration": {"LaserMaxDistance": 100, "LaserAngle": -90}}]}]}


class Installed:
    """HoloOcean with package Land, whose program is the stand-in engine."""

    def __init__(self, folder: Path):
        self.packages, self.record, self.folder = folder / "packages", folder / "record.jsonl", folder
        self.land = self.packages / "2.3.0" / "worlds" / "Land"
        self.land.mkdir(parents=True)
        (self.land / "config.json").write_text(json.dumps(
            {"name": "Land", "path": "engine", "worlds": [{"name": "Meadow", "pre_start_steps": 1}]}))
        self.scenario = folder / "scenario.json"
        self.scenario.write_text(json.dumps(SCENARIO))
        self.behave("")

    def behave(self, options: str, start: str = "exec "):
        program = self.land / "engine"
        program.write_text(f'#!/bin/sh\n{start}python3 "{STANDIN}" --record "{self.record}" {options} -- "$@"\n')
        program.chmod(0o755)

    def environment(self) -> dict:
        return os.environ | {"HOLODECKPATH": str(self.packages)}

    def fly(self, name: str, *words):
        return subprocess.run([*FLY, "--out", self.folder / name, *words], cwd=ROOT, capture_output=True, text=True,
                              env=self.environment())

    def view(self, name: str, *words):
        return self.fly(name, *VIEWER, "--viewer-scenario", self.scenario, *words)

    def log_hash(self, name: str) -> str:
        return hashlib.sha256((self.folder / name / "flight.mcap").read_bytes()).hexdigest()

    def events(self, kind: str) -> list[dict]:
        return [event for line in self.record.read_text().splitlines() if (event := json.loads(line))["event"] == kind]


@pytest.fixture
def installed(tmp_path):
    return Installed(tmp_path)


@pytest.fixture(scope="module")
def hash_without(tmp_path_factory):
    plain = Installed(tmp_path_factory.mktemp("plain"))
    assert plain.fly("flight").returncode == 0
    return plain.log_hash("flight")


def viewer_lines(done) -> list[str]:
    prefix = "rosflight: --viewer holoocean: "
    return [line.removeprefix(prefix) for line in done.stderr.splitlines() if line.startswith(prefix)]


def left_in_shared_memory() -> list[str]:
    return [path.name for path in Path("/dev/shm").iterdir() if "HOLODECK" in path.name and "rosflight_" in path.name]


def test_the_flight_is_the_same_and_every_thirtieth_of_a_second_is_a_tick(installed, hash_without):
    done = installed.view("flight", "--json")
    assert done.returncode == 0, done.stderr
    assert installed.log_hash("flight") == hash_without
    states = installed.events("state")
    simulated_s = json.loads(done.stdout)["sim_time_s"]
    assert abs(len(states) - 30 * simulated_s) <= 1
    assert {state["flag"] for state in states} == {15}
    assert max(state["numbers"][2] for state in states) > 1  # up is positive there
    pictures = (len(states) + 2) // 3  # every third tick since the camera was added, two of which were before the first state
    assert viewer_lines(done) == ["the engine has loaded its world", f"{len(states)} ticks, {pictures} pictures, "
                                  f"0 states skipped, {viewer_lines(done)[-1].split(', ')[-1]}"]


def test_two_flights_send_the_engine_the_same_numbers(installed):
    for name in "ab":
        assert installed.view(name).returncode == 0
    states = installed.events("state")
    half = len(states) // 2
    assert half > 100 and states[:half] == states[half:]


@pytest.mark.parametrize(("behaviour", "words", "said"), [
    ("--die-at 100", [], "warning: holoocean: its program ended with status 1; its last output: Fatal error: out of video memory"),
    ("--broken", [], "warning: holoocean: its program ended with status 1; its last output: error while loading shared libraries: "
                     "libvulkan.so.1"),
    ("--silent", ["--viewer-timeout", "0.5"], f"warning: holoocean: waited 0.5 s for its world to load{AS_ROOT}; it "
                                                  "printed nothing"),
    ("--hang-at 100", ["--viewer-timeout", "3"], "warning: holoocean: waited 3 s for a tick; it printed nothing"),
    ("--slow 0.002", [], None),
])
def test_an_engine_that_fails_or_is_slow_does_not_change_the_flight(installed, hash_without, behaviour, words, said):
    installed.behave(behaviour)
    before = set(left_in_shared_memory())
    done = installed.view("flight", *words)
    assert done.returncode == 0, done.stderr
    assert installed.log_hash("flight") == hash_without
    warnings = [line for line in viewer_lines(done) if line.startswith("warning")]
    assert warnings == ([said + "; the flight goes on without it"] if said else [])
    assert set(left_in_shared_memory()) <= before


def test_a_slow_engine_does_not_hold_up_a_flight_in_real_time(installed, hash_without):
    installed.behave("--slow 0.3")
    started = time.monotonic()
    done = installed.view("flight", "--speed", "10", "--json")
    assert done.returncode == 0, done.stderr
    assert installed.log_hash("flight") == hash_without
    skipped = int(viewer_lines(done)[-1].split(", ")[2].split()[0])
    assert skipped > 100
    assert time.monotonic() - started < 0.3 * skipped  # waiting for them would have taken that long


def ends_soon(process: int) -> bool:
    deadline = time.monotonic() + 10.0
    while (runs := Path(f"/proc/{process}/exe").exists()) and time.monotonic() < deadline:
        time.sleep(0.02)
    return not runs


@pytest.mark.parametrize("start", ["exec ", ""], ids=["program", "behind_a_script"])
def test_ctrl_c_in_a_terminal_leaves_a_whole_folder_no_engine_and_no_shared_memory(installed, start):
    installed.behave("", start)
    before = set(left_in_shared_memory())
    flying = subprocess.Popen([*FLY, "--out", installed.folder / "flight", *VIEWER, "--viewer-scenario", installed.scenario,
                               "--realtime"], cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                              env=installed.environment(), process_group=0)
    while "stage configure" not in (line := flying.stderr.readline()):
        assert line, flying.wait()
    engine = installed.events("start")[0]["process"]
    os.killpg(flying.pid, signal.SIGINT)
    said = flying.communicate(timeout=20)[1]
    assert flying.returncode == 130
    assert "warning" not in said
    assert ends_soon(engine)
    assert (installed.folder / "flight" / "flight.mcap").exists()
    assert set(left_in_shared_memory()) <= before


def test_an_engine_that_loads_can_be_interrupted(installed):
    installed.behave("--silent")
    waiting = subprocess.Popen([*FLY, "--out", installed.folder / "flight", *VIEWER, "--viewer-scenario", installed.scenario],
                               cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=installed.environment())
    while not installed.record.exists() or not installed.events("start"):
        assert waiting.poll() is None
        time.sleep(0.02)
    waiting.send_signal(signal.SIGINT)
    waiting.communicate(timeout=20)
    assert waiting.returncode == 130
    assert not (installed.folder / "flight").exists()


def assert_refused(done, said: str, folder: Path):
    assert done.returncode == 2, done.stderr
    assert done.stderr.count("\n") == 1 and said in done.stderr, done.stderr
    assert not folder.exists()


def test_a_missing_engine_says_what_to_install(tmp_path):
    done = subprocess.run([*FLY, "--out", tmp_path / "flight", *VIEWER], cwd=ROOT, capture_output=True, text=True,
                          env=os.environ | {"HOLODECKPATH": str(tmp_path)})
    assert_refused(done, f"rosflight: --viewer: found no HoloOcean package Land in {tmp_path}/VERSION/worlds; to install it, link your "
                   "GitHub account to Epic Games, clone https://github.com/byu-holoocean/HoloOcean, in its folder client run "
                   "python3 -m venv .venv && .venv/bin/pip install . && .venv/bin/python -c "
                   "'import holoocean; holoocean.install(\"Land\")'\n", tmp_path / "flight")


@pytest.mark.parametrize(("change", "said"), [
    ({"weather": "rain"}, "scenario.json:1: weather: found an unknown key, allowed name, package_name,"),
    ({"ticks_per_sec": "30"}, 'scenario.json:1: ticks_per_sec: found "30", allowed an integer from 1 to 1000'),
    ({"ticks_per_sec": 25}, "scenario.json:1: agents.0.sensors.0.Hz: found 10, allowed 25 (ticks_per_sec) divided by a whole number"),
    ({"world": "Moon"}, "--viewer: world: found Moon, allowed Meadow, the worlds of package Land"),
])
def test_a_bad_scenario_is_one_line_and_exit_code_2(installed, change, said):
    installed.scenario.write_text(json.dumps(SCENARIO | change))
    assert_refused(installed.view("flight"), said, installed.folder / "flight")


@pytest.mark.parametrize(("words", "said"), [
    (["--viewer", "rviz"], "--viewer: found rviz, allowed holoocean"),
    (["--viewer-offscreen"], "--viewer-offscreen requires --viewer"),
    ([*VIEWER, "--viewer-engine", "/nowhere"], "--viewer-engine: found /nowhere, allowed attach or a program"),
    ([*VIEWER, "--viewer-engine", "/bin/sh"], "--viewer-engine: found a program and no world, allowed with `world` in --viewer-scenario"),
    ([*VIEWER, "--viewer-name", "a/b"], "--viewer-name: found 'a/b', allowed letters, digits, _ and -"),
    ([*VIEWER, "--viewer-engine", "attach", "--viewer-name", "nobody"],
     "found no running engine to attach to, allowed one that has loaded its world"),
    ([*VIEWER, "--seeds", "1:2", "--no-log"], "--viewer: found with --seeds, allowed with one flight"),
])
def test_bad_options_are_one_line_and_exit_code_2(installed, words, said):
    assert_refused(installed.fly("flight", *words), said, installed.folder / "flight")


@pytest.mark.parametrize(("words", "said"), [
    (["--set", "vehicle.body.mass_kg=-1"], "body.mass_kg: found -1, allowed "),
    (["--world", "field.sdf"], "--world: found field.sdf with --physics runge_kutta, allowed with gazebo"),
    pytest.param(["--physics", "gazebo", "--world", "/nowhere/field.sdf"],
                 "--physics gazebo: /nowhere/field.sdf: found no such file",
                 marks=pytest.mark.skipif(not GAZEBO.exists(), reason="gazebo_engine is not built")),
])
def test_bad_input_of_the_flight_is_found_before_the_engine_starts(installed, words, said):
    assert_refused(installed.view("flight", *words), said, installed.folder / "flight")
    assert not installed.record.exists()


def test_a_flight_folder_in_use_is_found_before_the_engine_starts(installed):
    (installed.folder / "flight").mkdir()
    (installed.folder / "flight" / "note").touch()
    done = installed.view("flight")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "flight with something in it, allowed a new or empty folder" in done.stderr
    assert not installed.record.exists()


def test_without_a_scenario_nothing_is_rendered_that_nobody_takes(installed):
    done = installed.fly("flight", *VIEWER)
    assert done.returncode == 0, done.stderr
    (spawn,) = [event["text"] for event in installed.events("commands") if "SpawnAgent" in event["text"]]
    assert spawn.count("AddSensor") == 1 and "CollisionSensor" in spawn
    assert " 0 pictures, " in viewer_lines(done)[-1]


def test_two_engines_of_one_name_are_refused(installed):
    name = f"rosflight_{os.getpid()}_both"
    first = subprocess.Popen([*FLY, "--out", installed.folder / "first", *VIEWER, "--viewer-name", name, "--realtime"], cwd=ROOT,
                             stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=installed.environment())
    try:
        while "loaded its world" not in (line := first.stderr.readline()):
            assert line, first.wait()
        assert_refused(installed.view("second", "--viewer-name", name),
                       f"there is an engine named '{name}' already; if none runs, remove /dev/shm/", installed.folder / "second")
    finally:
        first.send_signal(signal.SIGINT)
        first.communicate(timeout=20)
