# SPDX-License-Identifier: BSD-3-Clause
"""Our vehicles fly in JSBSim as they do here."""

import subprocess
import sys
import xml.etree.ElementTree as xml
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(FOLDER))

import jsbsim_compare  # noqa: E402
import jsbsim_model  # noqa: E402
import jsbsim_plot  # noqa: E402

ROOT = FOLDER.parents[1]


@pytest.mark.parametrize("name", ["anaconda", "multirotor"])
def test_differences_stay_within_what_halved_steps_explain(name, tmp_path):
    comparison = jsbsim_compare.compare(name, tmp_path)
    assert len(comparison.ours.position) == len(comparison.theirs.position) == 8001
    assert comparison.passes(), jsbsim_compare.table(comparison)
    # The bounds say something: in the first ten seconds less than the motion by four orders.
    for quantity, most in (("position_m", 0.03), ("velocity_m_s", 0.01), ("attitude_rad", 5e-4), ("rates_rad_s", 5e-3)):
        assert comparison.bound[quantity][:4001].max() < most
    drawing = xml.fromstring(jsbsim_plot.svg([comparison]))
    assert len(drawing.findall("{http://www.w3.org/2000/svg}polyline")) == 14


def spoil_product_of_inertia(vehicle):
    vehicle["body"]["inertia_kg_m2"]["xz"] *= -1.0


def spoil_roll_damping(vehicle):
    vehicle["aero"]["roll"]["p"] *= 1.01


def spoil_spin(vehicle):
    vehicle["rotors"]["layout"][0]["spin"] *= -1


@pytest.mark.parametrize("spoil", [spoil_product_of_inertia, spoil_roll_damping, spoil_spin])
def test_a_model_with_one_number_changed_does_not_pass(spoil, tmp_path):
    assert not jsbsim_compare.compare("anaconda", tmp_path, spoil).passes()


def tool(*words):
    return subprocess.run([sys.executable, FOLDER / "jsbsim_model.py", *words], capture_output=True, text=True)


@pytest.mark.parametrize("name", ["anaconda", "openvsp_anaconda", "xflr5_anaconda", "aerosonde", "multirotor"])
def test_the_tool_writes_every_vehicle(name, tmp_path):
    air = ["environment.atmosphere.model=constant", "environment.atmosphere.density_kg_m3=1.1"]
    done = tool(ROOT / "vehicles" / f"{name}.yaml", tmp_path, *air, *(["aero.ground_effect=none"] * (name == "multirotor")))
    assert done.returncode == 0, done.stderr
    file = Path(done.stdout.strip())
    assert file == tmp_path / "aircraft" / name / f"{name}.xml"
    assert xml.parse(file).getroot().tag == "fdm_config"


@pytest.mark.parametrize(("words", "said"), [
    (["vehicles/anaconda.yaml"], "environment.atmosphere.model: found standard, allowed constant"),
    (["vehicles/nothing.yaml"], "No such file"),
    (["vehicles/multirotor.yaml", "environment.atmosphere.model=constant", "environment.atmosphere.density_kg_m3=1.1"],
     "aero.ground_effect: found cheeseman_bennett, allowed none"),
])
def test_bad_input_is_one_line_and_exit_code_2(words, said, tmp_path):
    done = tool(ROOT / words[0], tmp_path, *words[1:])
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1 and said in done.stderr
    assert not (tmp_path / "aircraft").exists()


def test_a_file_without_extends_is_taken_as_it_is():
    data = {"a": {"b": 1, "c": [1, 2]}}
    jsbsim_model.override(data, "a.c.1=5")
    jsbsim_model.override(data, "a.d=[3]")
    assert data == {"a": {"b": 1, "c": [1, 5], "d": [3]}}
    assert jsbsim_model.merge(data, {"a": {"b": 2}})["a"] == {"b": 2, "c": [1, 5], "d": [3]}
