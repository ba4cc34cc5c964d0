# SPDX-License-Identifier: BSD-3-Clause
"""Every line of docs/commands-of-rosflight-2.md, as a user types it, on a machine with or without `ros2`."""

import importlib
import re
import shlex
import time
from pathlib import Path

import pytest
import yaml
from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters
from rclpy.parameter import Parameter, parameter_value_to_python
from plans import nodes_of
from ros_launch.packages import Packages
from ros_launch.reader import Reader, find
from ros_rig import ROOT, TIMEOUT_S, free_udp_port
from sim_rig import VEHICLE, Process, SimPeer, executable, launch

DOCUMENT = ROOT / "docs/commands-of-rosflight-2.md"
PACKAGES = Packages.of_environment()
ROWS = re.findall(r"^\| `(ros2 [^`]+)` \| ([^|]+) \|$", DOCUMENT.read_text(), re.M)
# Files that a user has from ROSflight 2.x: names of its nodes, names and numbers of its parameters.
FILES = {
    "multirotor.yaml": {
        "/**": {"gravity": 9.81, "mass": 3.5, "tau": 0.05, "equilibrium_throttle": 0.65},
        "/controller": {"roll_to_torque_kp": 5.0, "roll_to_torque_kd": 0.8, "yaw_to_rate_kp": 4.0, "yaw_to_rate_kd": 2.0,
                        "vel_n_to_accel_kp": 0.1, "pos_n_to_vel_kp": 0.5, "max_roll_deg": 25.0, "max_pitch_deg": 25.0,
                        "max_throttle": 0.85, "min_throttle": 0.4, "takeoff_d_pos": -2.0, "takeoff_d_vel": -0.5},
        "/trajectory_follower": {"u_n_kp": 1.5, "u_n_ki": 0.01, "u_n_kd": 1.0, "u_d_kp": 4.0, "down_command_window": 3.0},
        "/path_manager": {"default_altitude": 10.0, "waypoint_tolerance": 1.0, "hold_last": False, "max_velocity": 3.0,
                          "max_acceleration": 5.0, "do_linear_interpolation": False}},
    "anaconda_autopilot_params.yaml": {
        "controller": {"alt_hz": 20.0, "alt_toz": 5.0, "tau": 50.0, "c_kp": 2.0, "c_ki": 0.0025, "c_kd": 0.0, "r_kp": 0.55,
                       "r_kd": 0.2, "p_kp": 4.25, "p_kd": 0.6, "p_ff": 0.0, "a_t_kp": 0.1, "a_t_ki": 0.02, "trim_e": 0.075,
                       "max_e": 0.61, "max_t": 1.0, "max_takeoff_throttle": 1.0, "takeoff_airspeed": 25.0, "max_roll": 45.0,
                       "mass": 4.5, "gravity": 9.8, "controller_output_frequency": 100.0},
        "path_manager": {"R_min": 50.0, "orbit_last": False, "default_altitude": 50.0, "default_airspeed": 15.0,
                         "current_path_pub_frequency": 100.0},
        "path_follower": {"controller_commands_pub_frequency": 10.0, "chi_infty": 1.2, "k_orbit": 0.5, "k_path": 0.0175,
                          "gravity": 9.81}},
    "estimator.yaml": {
        "estimator": {"estimator_update_frequency": 390.0, "rho": 1.225, "gravity": 9.81, "sigma_n_gps": 0.01,
                      "sigma_vn_gps": 0.007, "sigma_static_press": 10.0, "gyro_cutoff_freq": 20.0,
                      "bias_process_noise": 1e-12, "num_propagation_steps": 1, "convert_to_gauss": True}},
}


def rows(start):
    return [(shlex.split(command)[2:], outcome) for command, outcome in ROWS if command.startswith(start)]


def with_files(words, folder):
    """SHARE and the names of a user's files as paths."""
    out = []
    for word in words:
        word = word.replace("SHARE", str(PACKAGES.share("rosflight_sim")))
        if word in FILES:
            file = folder / word
            file.write_text(yaml.safe_dump({node: {"ros__parameters": values} for node, values in FILES[word].items()}))
            word = str(file)
        out.append(word)
    return out


def refusal(outcome):
    """The part of the line that says what to type; None: it works."""
    return outcome.partition("refused: ")[2] or None


def test_the_table_is_read_and_has_all_packages_of_rosflight_2():
    assert len(ROWS) == DOCUMENT.read_text().count("| `ros2 ") > 110
    named = {words[0] for kind in ("ros2 launch", "ros2 run") for words, _ in rows(kind)}
    assert named == {"rosflight_sim", "rosflight_io", "rosflight_gcs", "roscopter", "roscopter_sim", "roscopter_gcs",
                     "roscopter_tuning", "rosplane", "rosplane_sim", "rosplane_gcs", "rosplane_tuning", "rosplane_extra",
                     "rosflight_rqt_plugins"}
    outcomes = {outcome for _, outcome in ROWS if not outcome.startswith("refused: ")}
    assert outcomes == {"works", "works with rqt_reconfigure"}


# ---- launch files --------------------------------------------------------------------------------


def planned(words):
    file, given = find(words, PACKAGES)
    return file, Reader(PACKAGES, given, {"ROSFLIGHT_GUI": "false"}).read(file)


@pytest.mark.parametrize("words, outcome", [row for row in rows("ros2 launch") if row[1] == "works"])
def test_a_launch_file_names_programs_and_arguments_that_are_there(words, outcome, tmp_path):
    file, plan = planned(with_files(words, tmp_path))
    assert nodes_of(plan)
    assert file.with_suffix(".py").is_file()  # the name that is typed


@pytest.mark.parametrize("words, outcome", [row for row in rows("ros2 launch") if "rqt_reconfigure" in row[1]])
def test_the_tuning_gui_is_rqt_reconfigure(words, outcome):
    if PACKAGES.has("rqt_reconfigure"):
        assert planned(words)[1].nodes[0].what == "rqt_reconfigure/rqt_reconfigure"
        return
    with launch(*words) as process:
        assert process.end() == 2 and "found 'rqt_reconfigure'" in process.lines[-1]


@pytest.mark.parametrize("words", [words for words, outcome in rows("ros2 launch") if outcome == "works"
                                   and words[0].startswith(("roscopter_", "rosplane_")) and len(words) == 2])
def test_a_forwarded_launch_file_brings_its_nodes_up(words):
    with launch(*words) as process:
        process.until("ready: ")
    assert "ERROR" not in process.text()


@pytest.mark.parametrize("words, outcome", [row for row in rows("ros2 launch") if refusal(row[1])])
def test_a_refused_launch_ends_with_what_to_type(words, outcome):
    with launch(*words, environment={"ROSFLIGHT_GAZEBO": "none"}) as process:  # also where Gazebo is installed
        assert process.end() == 2
    assert refusal(outcome) in process.lines[-1], process.text()


# ---- programs ------------------------------------------------------------------------------------


def judge_values(node, file):
    """All values of a parameter file for this node, and for all, are in force where the node has a parameter of the name."""
    sections = {name.strip("/"): section["ros__parameters"] for name, section in yaml.safe_load(file.read_text()).items()}
    given = sections.get("**", {}) | sections.get(node, {})
    with SimPeer("reader") as peer:
        names = sorted(given.keys() & set(peer.call(ListParameters, f"{node}/list_parameters").result.names))
        values = [parameter_value_to_python(value) for value in peer.call(GetParameters, f"{node}/get_parameters", names=names).values]
    assert names or node not in sections
    assert {name: list(value) if isinstance(given[name], list) else value for name, value in zip(names, values)} \
        == {name: given[name] for name in names}


@pytest.mark.parametrize("words, outcome", rows("ros2 run"))
def test_a_program_starts_or_says_what_to_type(words, outcome, tmp_path):
    package, name, *arguments = with_files(words, tmp_path)
    with Process(executable(package, name), *arguments, cwd=tmp_path) as process:
        if refusal(outcome):
            assert process.end() == 2
            assert refusal(outcome) in process.lines[-1], process.text()
            return
        process.until("ready")
        if "--params-file" in arguments:
            named = [word.removeprefix("__node:=") for word in arguments if word.startswith("__node:=")]
            judge_values((named or [name])[0], Path(arguments[arguments.index("--params-file") + 1]))


# ---- services, parameters and topics -------------------------------------------------------------


@pytest.fixture(scope="module")
def everything(tmp_path_factory):
    """All nodes of both stacks and the simulator, in two processes. A name that both stacks have is the multirotor's: two nodes
    of one name would both be asked, and either may answer first."""
    here, there = free_udp_port(), free_udp_port()
    simulator = [f"rosflight_sim/{name}" for name in (
        "standalone_time_manager", "sil_board", "rosflight_sil_manager", "rc", "standalone_sensors",
        "standalone_dynamics:standalone_dynamics")]
    copter = [f"roscopter/{name}" for name in ("estimator", "path_planner", "path_manager", "trajectory_follower", "controller",
                                               "signal_generator")]
    plane = [f"rosplane/{name}" for name in ("path_planner", "path_manager", "path_follower", "controller", "signal_generator",
                                             "input_mapper")]
    both = [name.partition("/")[2] for name in plane if name.replace("rosplane", "roscopter") in copter]
    others = [word for name in both for word in ("-r", f"{name}:__node:=plane_{name}")]
    compose = executable("rosflight_common", "compose")
    given = ["-p", f"simulation_port:={there}", "-p", f"ROS_port:={here}", "-p", f"bind_port:={here}", "-p", "udp:=true",
             "-p", f"remote_port:={there}", "-p", f"memory_folder:={tmp_path_factory.mktemp('memory')}"]
    with Process(compose, *simulator, "rosflight_sim/multirotor_forces_and_moments:multirotor_forces_and_moments",
                 "rosflight_io/rosflight_io", *copter, "--ros-args", *given, "-p", f"vehicle_file:={VEHICLE}") as first, \
            Process(compose, *plane, "--ros-args", *others) as second, SimPeer("typist") as peer:
        first.until("ready: ")
        second.until("ready: ")
        yield peer


def fill(message, values):
    """Sets the fields as `ros2 service call` does; wrong names and types are errors of rclpy."""
    for name, value in values.items():
        assert name in message.get_fields_and_field_types(), name
        if isinstance(value, dict):
            fill(getattr(message, name), value)
        else:
            setattr(message, name, value)


def type_of_service(peer, name):
    end = time.monotonic() + TIMEOUT_S
    while time.monotonic() < end:
        if found := dict(peer.node.get_service_names_and_types()).get(name):
            return found
        time.sleep(0.05)
    return []


@pytest.mark.parametrize("words, outcome", rows("ros2 service call"))
def test_a_service_is_there_with_its_type_and_fields(everything, words, outcome):
    _, name, kind, *request = words
    assert type_of_service(everything, name) == [kind]
    if request:
        package, _, short = kind.split("/")
        fill(getattr(importlib.import_module(f"{package}.srv"), short).Request(), yaml.safe_load(request[0]))


@pytest.mark.parametrize("words, outcome", rows("ros2 param set"))
def test_a_parameter_can_be_set(everything, words, outcome):
    _, node, name, text = words
    everything.poll(lambda: name in everything.call(ListParameters, f"{node}/list_parameters").result.names, name)
    new = Parameter(name, value=yaml.safe_load(text)).to_parameter_msg()  # as `ros2 param set` reads it
    result, = everything.call(SetParameters, f"{node}/set_parameters", parameters=[new]).results
    assert result.successful, result.reason
    value, = everything.call(GetParameters, f"{node}/get_parameters", names=[name]).values
    assert value == new.value


@pytest.mark.parametrize("words, outcome", rows("ros2 topic echo"))
def test_a_topic_is_published(everything, words, outcome):
    everything.poll(lambda: everything.node.count_publishers(words[1]) > 0, f"a publisher of {words[1]}")
