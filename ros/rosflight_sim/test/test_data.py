# SPDX-License-Identifier: BSD-3-Clause
"""Launch files, parameter sets and meshes as data: no node is started."""

import csv
import math
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from plans import nodes_of
from ros_launch.packages import Packages
from ros_launch.reader import Reader

PACKAGE = Path(__file__).resolve().parents[1]
ROOT = PACKAGE.parents[1]
LAUNCH = sorted((PACKAGE / "launch").glob("*.launch.xml"))

# Arguments and defaults of ROSflight 2.x's launch files; ours may have more.
REFERENCE_ARGUMENTS = {
    "multirotor_standalone": {"use_sim_time": "false", "use_vimfly": "false", "rviz2_config_file": None},
    "fixedwing_standalone": {"use_sim_time": "false", "use_vimfly": "false", "rviz2_config_file": None,
                             "dynamics_param_file": None},
    "standalone_sim": {"rviz2_config_file": None, "sim_aircraft_file": None},
    "common_nodes_standalone": {"use_sim_time": "false", "use_vimfly": "false", "dynamics_param_file": ""},
    "multirotor_init_firmware": {},
    "fixedwing_init_firmware": {},
}
COMMON = {"sil_board", "rosflight_sil_manager", "standalone_sensors", "rc", "rosflight_io"}
REFERENCE_NODES = {
    "multirotor_standalone": COMMON | {"multirotor_forces_and_moments", "standalone_dynamics",
                                       "standalone_viz_transcriber"},
    "fixedwing_standalone": COMMON | {"fixedwing_forces_and_moments", "standalone_dynamics",
                                      "standalone_viz_transcriber"},
    "standalone_sim": {"standalone_viz_transcriber"},
    "common_nodes_standalone": COMMON,
}


class AllThere(Packages):
    """Every executable exists; folders are those of the source tree."""

    def executable(self, package, name):
        return Path("/lib") / package / name

    def share(self, package):
        assert package == "rosflight_sim"
        return PACKAGE


def plan(name, **given):
    values = {key: str(value) for key, value in given.items()}
    return Reader(AllThere([]), values, {"ROSFLIGHT_GUI": "false"}).read(
        PACKAGE / f"launch/{name}.launch.xml")


@pytest.mark.parametrize("name", [path.name.removesuffix(".launch.xml") for path in LAUNCH])
def test_a_launch_file_can_be_read_and_has_its_python_name(name):
    assert plan(name).nodes
    script = (Packages.of_environment().share("rosflight_sim") / f"launch/{name}.launch.py").read_text()
    compile(script, name, "exec")
    assert "XMLLaunchDescriptionSource" in script


@pytest.mark.parametrize("name", REFERENCE_ARGUMENTS)
def test_arguments_of_the_reference_are_there(name):
    arguments = plan(name).arguments
    for argument, default in REFERENCE_ARGUMENTS[name].items():
        assert argument in arguments
        assert default is None or arguments[argument].default == default


@pytest.mark.parametrize("name", REFERENCE_NODES)
def test_nodes_of_the_reference_are_there(name):
    assert nodes_of(plan(name)).keys() == REFERENCE_NODES[name]


@pytest.mark.parametrize("time", ["true", "false"])
@pytest.mark.parametrize("name", [name for name in REFERENCE_NODES if "composed" in plan(name).arguments])
def test_nodes_are_the_same_in_one_process_and_in_many(name, time):
    given = {"use_sim_time": time, "seed": 7, "dynamics_param_file": "/x.yaml"}
    shared, apart = nodes_of(plan(name, **given)), nodes_of(plan(name, composed="false", **given))
    assert shared.keys() == apart.keys()
    for node, alone in apart.items():
        expected = dict(alone.parameters)
        if node == "standalone_time_manager":
            expected["wait_for"] += " imu/data"  # of processes that would take half of the speed
        assert expected.items() <= shared[node].parameters.items(), node
        assert alone.remappings == shared[node].remappings, node


@pytest.mark.parametrize("composed", ["true", "false"])
@pytest.mark.parametrize("argument, node", [
    ("forces", "multirotor_forces_and_moments"), ("dynamics", "standalone_dynamics"), ("rc", "rc"),
    ("sensors", "standalone_sensors"), ("io", "rosflight_io"), ("viz", "standalone_viz_transcriber")])
def test_a_module_can_be_left_out(argument, node, composed):
    everything = nodes_of(plan("multirotor_standalone", composed=composed)).keys()
    without = nodes_of(plan("multirotor_standalone", composed=composed, **{argument: "false"})).keys()
    assert everything - without == {node}


@pytest.mark.parametrize("composed, without", [
    ("true", set()), ("false", {"multirotor_forces_and_moments", "standalone_dynamics", "standalone_sensors", "standalone_viz_transcriber"})])
def test_simulated_time_starts_a_time_manager_and_reaches_all_that_read_a_clock(composed, without):
    nodes = nodes_of(plan("multirotor_standalone", composed=composed, use_sim_time="true", real_time_multiplier=2))
    values = {name: node.parameters for name, node in nodes.items()}
    manager = values.pop("standalone_time_manager")
    assert manager["real_time_multiplier"] == 2
    assert {name for name, value in values.items() if "use_sim_time" not in value} == without
    assert all(value["use_sim_time"] is True for name, value in values.items() if name not in without)


WITHOUT_CLOCK = {
    "rosflight_sim": ["forces_node", "forces_and_moments_interface", "sensors_node", "sensor_interface", "viz_transcriber_node"],
    "roscopter": ["sim_state_transcriber_node", "ext_att_transcriber_node", "path_manager_node", "rviz_waypoint_publisher_node"],
    "rosplane": ["sim_state_transcriber_node", "rviz_waypoint_publisher_node"]}


def test_nodes_that_are_given_no_clock_look_at_none():
    """Each message costs a process two wake-ups: what needs no time is not given it by the launch files."""
    files = [ROOT / f"ros/{package}/src/{source}.cpp" for package, sources in WITHOUT_CLOCK.items() for source in sources]
    for file in (*files, ROOT / "ros/rosflight_common/include/rosflight_common/waypoint_markers.hpp"):
        assert not re.search(r"\bnow\(\)|create_timer\(|received_at\(", file.read_text()), file


@pytest.mark.parametrize("composed", ["true", "false"])
@pytest.mark.parametrize("name", ["multirotor_standalone", "fixedwing_standalone", "common_nodes_standalone"])
def test_sensors_have_the_rates_of_rosflight_2_unless_the_vehicle_files_are_asked_for(name, composed):
    def rates(**given):
        return nodes_of(plan(name, composed=composed, **given))["standalone_sensors"].parameters["sensor_rates"]
    assert rates() == "rosflight_2" and rates(sensor_rates="vehicle") == "vehicle"


def ranges():
    with (ROOT / "firmware/core/parameters.csv").open() as file:
        return {row["name"]: row for row in csv.DictReader(file)}


# Numbers of entries of ROSflight 2.x's sets.
SPLIT = {"multirotor_firmware": 18, "multirotor_mixing_matrix_params": 44, "multirotor_motor_params": 8}


@pytest.mark.parametrize("name, entries", [
    ("multirotor_firmware/multirotor_combined", 70), ("fixedwing_firmware", 16),
    *((f"multirotor_firmware/{name}", count) for name, count in SPLIT.items())])
def test_a_firmware_set_is_whole_and_in_range(name, entries):
    known = ranges()
    listed = yaml.safe_load((PACKAGE / f"params/{name}.yaml").read_text())
    assert len({entry["name"] for entry in listed}) == len(listed) == entries
    for entry in listed:
        row = known[entry["name"]]
        assert {"int32": 6, "float": 9}[row["type"]] == entry["type"]
        sentinels = [float(word) for word in row["sentinel"].split()] if row["sentinel"] else []
        value = float(entry["value"])
        assert math.isfinite(value)
        assert float(row["min"]) <= value <= float(row["max"]) or value in sentinels, entry


def test_the_set_in_three_files_is_the_combined_one_but_for_its_gains():
    """ROSflight 2.x has two sets of gains for the same vehicle: 0.5, 0.9, 0.2 and 1.5, 4, 7.5, 1.5."""
    def load(name):
        listed = yaml.safe_load((PACKAGE / f"params/multirotor_firmware/{name}.yaml").read_text())
        return {entry["name"]: entry["value"] for entry in listed}
    combined = load("multirotor_combined")
    split = {name: value for part in SPLIT for name, value in load(part).items()}
    assert split.keys() == combined.keys()
    other = {name: (split[name], combined[name]) for name in split if split[name] != combined[name]}
    assert other == {"PID_ROLL_RATE_P": (0.5, 1.5), "PID_PITCH_RATE_P": (0.5, 1.5), "PID_YAW_RATE_P": (0.5, 4.0),
                     "PID_ROLL_ANG_P": (0.9, 7.5), "PID_PITCH_ANG_P": (0.9, 7.5), "PID_ROLL_ANG_D": (0.2, 1.5),
                     "PID_PITCH_ANG_D": (0.2, 1.5)}


@pytest.mark.parametrize("shape", ["multirotor", "fixedwing"])
def test_a_mesh_is_closed(shape, tmp_path):
    """Every edge belongs to two triangles, once in each direction."""
    file = tmp_path / "m.stl"
    subprocess.run([sys.executable, PACKAGE / "common_resource/make_mesh.py", shape, file], check=True)
    corners = [tuple(line.split()[1:]) for line in file.read_text().splitlines() if "vertex" in line]
    edges = {}
    for i in range(0, len(corners), 3):
        for a, b in ((0, 1), (1, 2), (2, 0)):
            edge = (corners[i + a], corners[i + b])
            edges[edge] = edges.get(edge, 0) + 1
    assert edges and all(edges.get((b, a)) == n for (a, b), n in edges.items())


def test_an_unknown_shape_is_refused(tmp_path):
    done = subprocess.run([sys.executable, PACKAGE / "common_resource/make_mesh.py", "car", tmp_path / "m"],
                          capture_output=True, text=True)
    assert done.returncode == 1 and "allowed one of" in done.stderr


def test_the_layout_of_rviz_shows_what_the_simulator_sends():
    layout = yaml.safe_load((PACKAGE / "rviz/standalone.rviz").read_text())["Visualization Manager"]
    topics = {display["Topic"]["Value"] for display in layout["Displays"] if "Topic" in display}
    assert topics == {"/rviz/mesh", "/rviz/mesh_path", "/rviz/waypoint"}  # as ROSflight 2.x's
    frames = (PACKAGE / "include/rosflight_sim/frames.hpp").read_text()
    assert f'"{layout["Global Options"]["Fixed Frame"]}"' in frames
    assert f'"{layout["Views"]["Current"]["Target Frame"]}"' in frames
