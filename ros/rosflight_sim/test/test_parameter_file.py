# SPDX-License-Identifier: BSD-3-Clause
"""Parameter files of ROSflight 2.x in place of a vehicle file, and those that are made from the vehicle files."""

import subprocess

import pytest
import yaml
from ros_rig import ROOT, free_udp_port
from sim_rig import Process, executable, launch, node, parameter
from ros_launch.packages import Packages

PARAMETERS = Packages.of_environment().share("rosflight_sim") / "params"
VEHICLES = ("aerosonde", "anaconda", "multirotor", "openvsp_anaconda", "xflr5_anaconda")
# Numbers of ROSflight 2.x's parameter files.
FACTS = {
    "multirotor": {"num_rotors": 4, "CT_0": 0.08729101, "CT_1": -0.11006411, "CQ_0": 0.00428594, "CQ_2": -0.01440988, "KQ": 0.028937,
                   "D_prop": 0.381, "R_motor": 0.042, "I_0": 1.5, "CD": 2.05, "A_c": 0.04, "CD_induced": 0.05,
                   "rotor_rotation_directions": [-1, 1, -1, 1], "mass": 3.5, "Jxx": 0.08, "Jyy": 0.08, "Jzz": 0.12},
    "anaconda": {"wing_s": 0.52, "wing_b": 2.08, "wing_c": 0.235, "C_L_O": 0.506, "C_L_alpha": 5.61, "C_D_p": 0.043, "C_m_q": -38.21,
                 "C_ell_delta_a": 0.17, "C_n_delta_r": -0.069, "CT_2": -0.31320732, "KQ": 0.01705, "servo_tau": 0.01,
                 "mass": 4.5, "Jxx": 0.24855, "Jxz": 0.06},
    "aerosonde": {"wing_s": 0.55, "wing_b": 2.8956, "C_L_alpha": 5.61, "C_n_r": -0.095, "D_prop": 0.508, "mass": 11.0, "Jyy": 1.135},
    "openvsp_anaconda": {"wing_s": 0.474, "C_L_alpha": 5.06686, "C_Y_r": 0.1296921, "mass": 4.524},
    "xflr5_anaconda": {"wing_s": 0.485, "C_L_delta_e": -0.47351, "C_ell_delta_a": -0.34438, "C_n_beta": 0.07602},
}


def forces_of(vehicle):
    return f"{'multirotor' if vehicle == 'multirotor' else 'fixedwing'}_forces_and_moments"


def read(name):
    document = yaml.safe_load((PARAMETERS / name).read_text())
    return {node.lstrip("/"): section["ros__parameters"] for node, section in document.items()}


def write(folder, **sections):
    file = folder / "dynamics.yaml"
    file.write_text(yaml.safe_dump({f"/{node}": {"ros__parameters": values} for node, values in sections.items()}))
    return file


@pytest.mark.parametrize("vehicle", VEHICLES)
def test_made_files_have_the_numbers_of_rosflight_2(vehicle):
    sections = read(f"{vehicle}_dynamics.yaml")
    assert sections.keys() == {forces_of(vehicle), "standalone_dynamics"}
    values = sections[forces_of(vehicle)] | sections["standalone_dynamics"]
    assert {name: values[name] for name in FACTS[vehicle]} == pytest.approx(FACTS[vehicle], rel=1e-4)


def test_the_made_file_of_the_sensors_has_the_errors_that_were_in_force_in_rosflight_2():
    sections = read("standalone_sim_params.yaml")
    wanted = {"gyro_stdev": 0.00226, "gyro_bias_range": 0.25, "gyro_bias_walk_stdev": 0.033, "acc_stdev": 0.2, "acc_bias_range": 0.6,
              "acc_bias_walk_stdev": 1e-5, "mag_stdev": 3e-6, "k_mag": 7.0, "baro_stdev": 4.0, "baro_bias_range": 500.0,
              "baro_bias_walk_stdev": 0.1, "airspeed_stdev": 1.15, "range_stdev": 0.03, "range_min_range": 0.25, "range_max_range": 8.0,
              "horizontal_gnss_stdev": 0.21, "vertical_gnss_stdev": 0.4, "k_gnss": 1 / 1100, "gnss_velocity_stdev": 0.01,
              "origin_altitude": 1387.0, "origin_latitude": 40.2463724, "origin_longitude": -111.6474138,
              "baro_update_frequency": 100.0, "mag_update_frequency": 50.0, "battery_update_frequency": 200.0}
    values = sections["standalone_sensors"]
    assert {name: values[name] for name in wanted} == pytest.approx(wanted, rel=1e-6)


@pytest.mark.parametrize("vehicle", ["multirotor", "anaconda"])
def test_a_made_file_is_the_vehicle_again(peer, vehicle):
    """All its names are parameters, with the values of the vehicle file; nothing is without effect."""
    file = PARAMETERS / f"{vehicle}_dynamics.yaml"
    for name in (forces_of(vehicle), "standalone_dynamics"):
        with node(name, at_launch=name, vehicle_file=file) as process:
            assert f"ROS parameter file, on top of {PARAMETERS.parent}/vehicles/{vehicle}.yaml" in process.text()
            assert "without effect" not in process.text()
            own = read(f"{vehicle}_dynamics.yaml")[name]
            number = "KQ" if "forces" in name else "mass"
            assert parameter(peer, name, number).double_value == own[number]


def test_values_of_a_file_reach_the_nodes_they_are_for(peer, tmp_path):
    """Sections for all and for one node, numbers as YAML writes them; what is on the command line counts more."""
    file = tmp_path / "own.yaml"
    file.write_text("/**:\n  ros__parameters:\n    mass: 4.\n    rho: 1.2\n/fixedwing_forces_and_moments:\n  ros__parameters:\n"
                    "    C_L_O: .6\n    C_D_O: 0.1\n    rho: 1.1\n    KV: 500.0\n    wing_s: 0.6\n    wing_alpha0: 0.05236\n"
                    "/standalone_dynamics:\n  ros__parameters: {Jxx: 0.3, sim_has_wind: true, steady_state_wind: [1.0, 2, 0]}\n")
    name = "fixedwing_forces_and_moments"
    with node(name, at_launch=name, vehicle_file=file, wing_s=0.7) as process:
        assert "/vehicles/anaconda.yaml; without effect: C_D_O, KV, wing_alpha0" in process.text()
        values = {key: parameter(peer, name, key).double_value for key in ("C_L_O", "rho", "wing_s", "C_L_alpha")}
        assert values == {"C_L_O": 0.6, "rho": 1.1, "wing_s": 0.7, "C_L_alpha": 5.61}
    with node("standalone_dynamics", at_launch="standalone_dynamics", vehicle_file=file):
        values = {key: parameter(peer, "standalone_dynamics", key).double_value for key in ("mass", "Jxx", "Jyy")}
        assert values == {"mass": 4.0, "Jxx": 0.3, "Jyy": 0.3784}
        assert parameter(peer, "standalone_dynamics", "sim_has_wind").bool_value
        assert list(parameter(peer, "standalone_dynamics", "steady_state_wind").double_array_value) == [1.0, 2.0, 0.0]


@pytest.mark.parametrize("text, said", [
    ("/standalone_dynamics:\n  ros__parameters:\n    mass: heavy\n", "own.yaml:3: /standalone_dynamics.ros__parameters.mass: found"),
    ("/standalone_dynamics:\n  ros__parameters:\n    mass: -1.0\n", "mass"),
    ("/standalone_dynamics:\n  ros__parameters:\n    sim_has_wind: 3\n", "sim_has_wind: found 3, allowed true or false"),
    ("/standalone_dynamics:\n  ros_parameters:\n    mass: 1.0\n", "own.yaml")])
def test_a_wrong_file_is_one_line(tmp_path, text, said):
    file = tmp_path / "own.yaml"
    file.write_text(text)
    with Process(executable("rosflight_sim", "standalone_dynamics"), "--ros-args", "-r", "__node:=standalone_dynamics", "-p",
                 f"vehicle_file:={file}") as process:
        assert process.end() == 2
        assert said in process.lines[-1], process.text()


def test_a_launch_takes_such_a_file(peer, tmp_path):
    file = write(tmp_path, multirotor_forces_and_moments={"CD": 1.0}, standalone_dynamics={"mass": 4.25},
                 standalone_sensors={"baro_stdev": 2.5})
    with launch("rosflight_sim", "multirotor_standalone.launch.py", dynamics_param_file=file, memory_folder=tmp_path,
                simulation_port=free_udp_port(), ROS_port=free_udp_port()) as process:
        process.until("ready: ")
        assert parameter(peer, "standalone_dynamics", "mass").double_value == 4.25
        assert parameter(peer, "standalone_sensors", "baro_stdev").double_value == 2.5
        assert parameter(peer, "multirotor_forces_and_moments", "CD").double_value == 1.0


def test_the_program_that_makes_them_refuses_in_one_line():
    program = executable("rosflight_sim", "vehicle_parameters")
    for words, said in ((["dynamics"], "found 1 words, allowed dynamics|sensors VEHICLE_FILE"),
                        (["dynamics", "/no/such.yaml"], "/no/such.yaml: found no such file")):
        done = subprocess.run([program, *words], capture_output=True, text=True)
        assert done.returncode == 2 and said in done.stderr.splitlines()[-1]
    done = subprocess.run([program, "dynamics", ROOT / "vehicles/anaconda.yaml"], capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout == (PARAMETERS / "anaconda_dynamics.yaml").read_text()
