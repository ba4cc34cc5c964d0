# SPDX-License-Identifier: BSD-3-Clause
"""The way of docs/learned-controller.md: the commands of the page, with fewer steps, then a mission by the policy inside the firmware, judged
by the truth. And a policy of motors whose law is written down here."""

import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import onnx
import pytest
import rosflight
from onnx import TensorProto, helper, numpy_helper
from onnx.reference import ReferenceEvaluator

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build/release"
LIBRARY = "firmware/core/librosflight_policy.a"
PAGE = ROOT / "docs/learned-controller.md"
STEPS = "500000"  #: A quarter of the page's: it flies, less precisely.
TRACKING_M = 1.0  #: The angle loops have 0.12, a policy of all steps too, this one 0.24; another processor may round otherwise.


def blocks():
    """Commands of the page, block by block."""
    found = re.findall(r"(?:^    [^\n]+\n)+", PAGE.read_text(), re.M)
    return [[line.strip() for line in block.splitlines()] for block in found]


def run_python(command, folder, *further):
    """A line ./rosflight python ..., files of /tmp in the folder."""
    words = [word.replace("/tmp", str(folder)) for word in shlex.split(command)]
    assert words[:2] == ["./rosflight", "python"]
    # One thread: more would wait for each other busily beside other tests.
    subprocess.run([sys.executable, *words[2:], *further], cwd=ROOT, check=True, env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})


def program_with(policy: Path, folder: Path) -> Path:
    """The program `./rosflight fly` with a policy inside: what ROSFLIGHT_POLICY makes, but one file is compiled and the program linked in a
    folder of its own, so that build/release stays as it is."""
    source, compiled, program = folder / "policy.cpp", folder / "policy.o", folder / "rosflight"
    subprocess.run([sys.executable, ROOT / "firmware/core/policy/generate.py", policy, source], check=True)
    subprocess.run(["c++", "-std=c++17", "-O2", "-ffp-contract=off", "-fno-math-errno", "-fPIC", f"-I{ROOT}", "-isystem", "/usr/include/eigen3",
                    "-c", source, "-o", compiled], check=True)
    steps = subprocess.run(["ninja", "-C", BUILD, "-t", "commands", "-s", "apps/rosflight"], capture_output=True, text=True, check=True)
    link = steps.stdout.splitlines()[-1]
    assert link.count(f" {LIBRARY} ") >= 1 and link.count(" -o apps/rosflight ") == 1, link
    subprocess.run(["bash", "-c", link.replace(LIBRARY, str(compiled), 1).replace(f" {LIBRARY} ", " ")
                    .replace(" -o apps/rosflight ", f" -o {program} ")], cwd=BUILD, check=True)
    return program


def fly(policy, folder, *options):
    """@returns the summary of the default mission, and what the firmware said."""
    program, out = program_with(policy, folder), folder / "flight"
    done = subprocess.run([program, "fly", "--json", "--out", out, *options], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads(done.stdout), list(rosflight.read(out)["/rosout"]["msg"])


def expect_flown(policy, summary, texts, tracking_m):
    """By the truth, and by the policy to the end."""
    assert summary["success"] and summary["tracking_rms_m"] < tracking_m
    assert f"Learned controller: {policy.name}" in texts
    assert not any(text.startswith("Learned control off") for text in texts)


def flown_command(line, folder):
    """@returns the file and the options of a line ROSFLIGHT_POLICY=FILE ./rosflight fly ..."""
    words = shlex.split(line.replace("/tmp", str(folder)))
    assert words[0].startswith("ROSFLIGHT_POLICY=") and words[1:3] == ["./rosflight", "fly"], line
    return folder / words[0].rpartition("/")[2], words[3:]


def test_a_policy_learned_by_the_page_flies_the_default_mission(tmp_path):
    learn, export, line = blocks()[0]
    run_python(learn, tmp_path, "--steps", STEPS, "--threads", "1")
    run_python(export, tmp_path)
    policy, options = flown_command(line, tmp_path)
    summary, texts = fly(policy, tmp_path, *options)
    expect_flown(policy, summary, texts, TRACKING_M)
    expect_same_outputs(policy, shlex.split(learn.replace("/tmp", str(tmp_path)))[-1])


def expect_same_outputs(policy, saved):
    """The file computes what PPO's network did, for inputs as they are, and limits it as the environment does."""
    with np.load(saved) as known:
        parameters = [known[f"arr_{k}"].astype(float) for k in range(6)]
        mean, spread = known["mean"], known["spread"]
    model = onnx.load(policy)
    onnx.checker.check_model(model)
    assert {entry.key: entry.value for entry in model.metadata_props} == {"rate_hz": "50"}
    random = np.random.default_rng(1)
    limited = 0
    for x in mean + 2 * spread * random.standard_normal((200, 12)):
        y = np.tanh((x - mean) / (spread + 1e-6) @ parameters[0] + parameters[1])
        y = np.tanh(y @ parameters[2] + parameters[3]) @ parameters[4] + parameters[5]
        limited += int(np.abs(y).max() > 1)
        found = ReferenceEvaluator(model).run(None, {"observation": x[None].astype(np.float32)})[0][0]
        assert found == pytest.approx(np.clip(y, -1, 1), abs=1e-4)
    assert 10 < limited < 200


def test_an_imitation_by_the_page_flies_the_default_mission(tmp_path):
    learn, line = blocks()[1]
    run_python(learn, tmp_path, "--samples", "100000")
    policy, options = flown_command(line, tmp_path)
    summary, texts = fly(policy, tmp_path, *options)
    expect_flown(policy, summary, texts, 0.25)


def of_motors(file):
    """The angle loops and the mixer of vehicles/multirotor.yaml as one layer: throttle, proportional terms and damping, gain by gain."""
    vehicle = rosflight.Simulation().parameters
    roll, pitch, yaw = (np.array([vehicle[f"PRI_MIXER_{axis}_{k}"] for k in range(4)]) for axis in (3, 4, 5))
    motors = np.zeros((14, 4))
    motors[13] = vehicle["RC_MAX_THR"]
    motors[6], motors[1], motors[3] = roll * np.array([[1], [-1], [0]]) * vehicle["PID_ROLL_ANG_P"] + roll * [[0], [0], [-vehicle["PID_ROLL_ANG_D"]]]
    motors[7], motors[0], motors[4] = pitch * np.array([[1], [1], [0]]) * vehicle["PID_PITCH_ANG_P"] + pitch * [[0], [0], [-vehicle["PID_PITCH_ANG_D"]]]
    motors[8], motors[5] = vehicle["PID_YAW_RATE_P"] * yaw * np.array([[1], [-1]])
    constants = {"gains": 2 * motors, "bias": -np.ones(4), "low": np.array(-1), "high": np.array(1)}
    graph = helper.make_graph(
        [helper.make_node("Gemm", ["x", "gains", "bias"], ["sum"]), helper.make_node("Clip", ["sum", "low", "high"], ["y"])], "motors",
        [helper.make_tensor_value_info("x", TensorProto.FLOAT, [1, 14])], [helper.make_tensor_value_info("y", TensorProto.FLOAT, [1, 4])],
        [numpy_helper.from_array(value.astype(np.float32), name) for name, value in constants.items()])
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)])
    helper.set_model_props(model, {"outputs": "motors"})
    onnx.save(model, file)


def test_a_policy_of_motors_flies_the_default_mission(tmp_path):
    policy = tmp_path / "motors.onnx"
    of_motors(policy)
    summary, texts = fly(policy, tmp_path)
    expect_flown(policy, summary, texts, 0.25)


@pytest.mark.parametrize("written", [b"", b"text", "other"])
def test_what_is_no_policy_is_one_line_and_leaves_no_file(tmp_path, written):
    given, out = tmp_path / "policy.npz", tmp_path / "policy.onnx"
    if written == "other":
        np.savez(given, np.zeros(3), np.zeros(3))
    else:
        given.write_bytes(written)
    done = subprocess.run([sys.executable, ROOT / "python/examples/export_policy.py", given, out], capture_output=True, text=True)
    assert done.returncode == 2 and list(tmp_path.iterdir()) == [given]
    assert done.stderr == f"export_policy: {given}: found no policy, allowed a file that ppo.py --out has written\n"


def test_a_missing_policy_is_one_line(tmp_path):
    done = subprocess.run([sys.executable, ROOT / "python/examples/export_policy.py", tmp_path / "none.npz", tmp_path / "policy.onnx"],
                          capture_output=True, text=True)
    assert done.returncode == 2 and "No such file" in done.stderr and done.stderr.count("\n") == 1
