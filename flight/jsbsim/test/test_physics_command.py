# SPDX-License-Identifier: BSD-3-Clause
"""`fly --physics ENGINE` as a person starts it: the result, the same bits again, and how it ends when the engine does."""

import json
import os
import signal
import subprocess
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
PROGRAM = ROOT / os.environ.get("ROSFLIGHT_BUILD", "build/release") / "apps" / "rosflight"
HOP = [PROGRAM, "fly", "--mission", "hop"]
GAZEBO = ROOT / "build/gazebo/flight/gazebo/engine/gazebo_engine"
WITH_GAZEBO = pytest.mark.skipif(not GAZEBO.exists(), reason="gazebo_engine is not built")
ENGINES = ["jsbsim", pytest.param("gazebo", marks=WITH_GAZEBO)]


def fly(folder: Path, *words):
    return subprocess.run([*HOP, "--out", folder, "--json", *words], cwd=ROOT, capture_output=True, text=True)


@pytest.mark.parametrize("engine", ENGINES)
def test_two_flights_have_the_same_log_to_the_bit(engine, tmp_path):
    flights = [fly(tmp_path / name, "--physics", engine) for name in "ab"]
    assert [done.returncode for done in flights] == [0, 0], flights[0].stderr
    results = [json.loads(done.stdout) for done in flights]
    assert results[0]["physics"] == engine
    logs = [(tmp_path / name / "flight.mcap").read_bytes() for name in "ab"]
    assert logs[0] == logs[1]


def children_of(process: int) -> list[int]:
    return [int(word) for word in Path(f"/proc/{process}/task/{process}/children").read_text().split()]


def start(engine: str, folder: Path):
    """The program, flying in real time, and the process of the engine."""
    flying = subprocess.Popen([*HOP, "--physics", engine, "--out", folder, "--realtime"], cwd=ROOT, stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE, text=True, process_group=0)
    while "stage configure" not in (line := flying.stderr.readline()):
        assert line, flying.wait()
    (process,) = children_of(flying.pid) or [None]
    return flying, process


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGTERM])
def test_an_engine_that_ends_in_flight_ends_the_flight_with_one_line(end, engine, tmp_path):
    flying, process = start(engine, tmp_path / "flight")
    os.kill(process, end)
    said = flying.communicate(timeout=20)[1]
    assert flying.returncode == 1, said
    last = said.splitlines()[-1]
    assert last.startswith("rosflight: ")
    assert last.endswith(f" s: --physics {engine}: its program was ended by signal {int(end)}; it printed nothing")
    assert not Path(f"/proc/{process}").exists()


@pytest.mark.parametrize("engine", ["runge_kutta", *ENGINES])
@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_to_the_whole_process_group_leaves_a_whole_flight_folder(end, engine, tmp_path):
    """Ctrl-C in a terminal signals every process of the foreground group."""
    folder = tmp_path / "flight"
    flying, _ = start(engine, folder)
    os.killpg(flying.pid, end)
    said = flying.communicate(timeout=20)[1]
    assert flying.returncode == 128 + end, said
    files = {path.name for path in folder.iterdir()}
    assert {"flight.mcap", "summary.json"} <= files
    assert not [name for name in files if name.endswith(".part")]


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGINT])
def test_no_process_is_left_behind(end, engine, tmp_path):
    flying, process = start(engine, tmp_path / "flight")
    flying.send_signal(end)
    flying.communicate(timeout=20)
    deadline = time.monotonic() + 5.0
    while Path(f"/proc/{process}/exe").exists() and time.monotonic() < deadline:
        time.sleep(0.02)
    assert not Path(f"/proc/{process}/exe").exists()


@pytest.mark.parametrize(("words", "said"), [
    (["--physics", "bullet"], "--physics: found bullet, allowed runge_kutta, runge_kutta_held, jsbsim, gazebo"),
    (["--physics", "jsbsim", "--set", "body.integration=frozen_forces"],
     "body.integration: found frozen_forces with a physics engine, allowed rk4"),
    (["--world", "field.sdf"], "--world: found field.sdf with --physics runge_kutta, allowed with gazebo"),
    pytest.param(["--physics", "gazebo", "--world", "/nowhere/field.sdf"], "--physics gazebo: /nowhere/field.sdf: found no such file",
                 marks=WITH_GAZEBO),
])
def test_bad_input_is_one_line_and_exit_code_2(words, said, tmp_path):
    done = subprocess.run([PROGRAM, "fly", "--out", tmp_path / "flight", *words], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1 and said in done.stderr, done.stderr
    assert not (tmp_path / "flight").exists()


@pytest.mark.parametrize(("engine", "file", "made"), [("jsbsim", ".venv-jsbsim/bin/python3", "makes"),
                                                     ("gazebo", "build/gazebo/flight/gazebo/engine/gazebo_engine", "builds")])
def test_a_tree_without_an_engine_says_what_makes_one(engine, file, made, tmp_path):
    for name in ("vehicles", "missions"):
        (tmp_path / name).symlink_to(ROOT / name)
    done = subprocess.run([*HOP, "--physics", engine], cwd=tmp_path, env={"ROSFLIGHT_DATA_DIR": str(tmp_path)},
                          capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr == (f"rosflight: --physics: found {engine} without {tmp_path}/{file}, "
                           f"which ./rosflight fly --physics {engine} {made}\n")


@WITH_GAZEBO
def test_a_library_of_gazebo_that_is_missing_is_one_line_and_exit_code_2(tmp_path):
    # The dynamic linker finds an empty file in place of Gazebo's library of SDF.
    for name in ("libsdformat12.so.12", "libsdformat14.so.14"):
        (tmp_path / name).touch()
    done = subprocess.run([*HOP, "--physics", "gazebo", "--out", tmp_path / "flight"], cwd=ROOT, capture_output=True, text=True,
                          env={**os.environ, "LD_LIBRARY_PATH": str(tmp_path)})
    assert done.returncode == 2, done.stderr
    assert done.stderr.count("\n") == 1 and "libsdformat1" in done.stderr, done.stderr
    assert not (tmp_path / "flight").exists()
