# SPDX-License-Identifier: BSD-3-Clause
"""`fly --physics jsbsim` as a person starts it: the result, the same bits again, and how it ends when JSBSim does."""

import json
import os
import signal
import subprocess
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
PROGRAM = ROOT / os.environ.get("ROSFLIGHT_BUILD", "build/release") / "apps" / "rosflight"
FLY = [PROGRAM, "fly", "--physics", "jsbsim", "--mission", "hop"]


def fly(folder: Path, *words):
    return subprocess.run([*FLY, "--out", folder, "--json", *words], cwd=ROOT, capture_output=True, text=True)


def test_two_flights_have_the_same_log_to_the_bit(tmp_path):
    flights = [fly(tmp_path / name) for name in "ab"]
    assert [done.returncode for done in flights] == [0, 0], flights[0].stderr
    results = [json.loads(done.stdout) for done in flights]
    assert results[0]["physics"] == "jsbsim"
    logs = [(tmp_path / name / "flight.mcap").read_bytes() for name in "ab"]
    assert logs[0] == logs[1]


def children_of(process: int) -> list[int]:
    return [int(word) for word in Path(f"/proc/{process}/task/{process}/children").read_text().split()]


def start(folder: Path):
    """The program, flying in real time, and the process of JSBSim."""
    flying = subprocess.Popen([*FLY, "--out", folder, "--realtime"], cwd=ROOT, stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE, text=True)
    while "stage configure" not in (line := flying.stderr.readline()):
        assert line, flying.wait()
    (jsbsim,) = children_of(flying.pid)
    return flying, jsbsim


@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGTERM])
def test_jsbsim_that_ends_in_flight_ends_the_flight_with_one_line(end, tmp_path):
    flying, jsbsim = start(tmp_path / "flight")
    os.kill(jsbsim, end)
    said = flying.communicate(timeout=20)[1]
    assert flying.returncode == 1, said
    last = said.splitlines()[-1]
    assert last.startswith("rosflight: ")
    assert last.endswith(f" s: --physics jsbsim: its program was ended by signal {int(end)}; it printed nothing")
    assert not Path(f"/proc/{jsbsim}").exists()


@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGINT])
def test_no_process_is_left_behind(end, tmp_path):
    flying, jsbsim = start(tmp_path / "flight")
    flying.send_signal(end)
    flying.communicate(timeout=20)
    deadline = time.monotonic() + 5.0
    while Path(f"/proc/{jsbsim}/exe").exists() and time.monotonic() < deadline:
        time.sleep(0.02)
    assert not Path(f"/proc/{jsbsim}/exe").exists()


@pytest.mark.parametrize(("words", "said"), [
    (["--physics", "bullet"], "--physics: found bullet, allowed runge_kutta, runge_kutta_held, jsbsim"),
    (["--physics", "jsbsim", "--set", "body.integration=frozen_forces"],
     "body.integration: found frozen_forces with a physics engine, allowed rk4"),
])
def test_bad_input_is_one_line_and_exit_code_2(words, said, tmp_path):
    done = subprocess.run([PROGRAM, "fly", "--out", tmp_path / "flight", *words], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1 and said in done.stderr, done.stderr
    assert not (tmp_path / "flight").exists()


def test_a_tree_without_an_environment_says_what_makes_one(tmp_path):
    for name in ("vehicles", "missions"):
        (tmp_path / name).symlink_to(ROOT / name)
    done = subprocess.run(FLY, cwd=tmp_path, env={"ROSFLIGHT_DATA_DIR": str(tmp_path)}, capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr == (f"rosflight: --physics: found jsbsim without {tmp_path}/.venv-jsbsim/bin/python3, "
                           "which ./rosflight fly --physics jsbsim makes\n")
