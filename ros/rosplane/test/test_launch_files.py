# SPDX-License-Identifier: BSD-3-Clause
"""The launch files as data, with the packages that are installed: no node is started."""

from pathlib import Path

import pytest
from plans import nodes_of
from ros_launch.packages import Packages
from ros_launch.reader import Reader

FOLDER = Path(__file__).resolve().parents[1] / "launch"
FILES = sorted(FOLDER.glob("*.launch.xml"))
STACK = {"estimator", "path_planner", "path_manager", "path_follower", "controller"}
SIMULATOR = {"sil_board", "rosflight_sil_manager", "standalone_sensors", "rc", "rosflight_io", "fixedwing_forces_and_moments",
             "standalone_dynamics", "standalone_viz_transcriber"}
# Nodes and arguments of rosplane 2.0.0's launch files, and of ours that has no counterpart there: fly.
NODES = {"rosplane": STACK, "sim": STACK | {"rosplane_truth"}, "rosplane_tuning": {"estimator", "controller", "signal_generator"},
         "sim_tuning": {"estimator", "controller", "signal_generator", "rosplane_truth"},
         "rosplane_input_mapper": STACK | {"input_mapper"}, "rosplane_gcs": {"rviz_waypoint_publisher"}, "components": set(),
         "fly": STACK | SIMULATOR | {"init_firmware", "rosplane_truth"}}
COMPOSED = ["true", "false"]
ARGUMENTS = {"use_sim_time": "false", "state_topic_remap": "estimated_state", "command_publisher_remap": "command",
             "controller_command_publisher_remap": "controller_command", "aircraft": "anaconda", "seed_estimator": "false"}


def plan(name, **given):
    return Reader(Packages.of_environment(), given, {"ROSFLIGHT_GUI": "false"}).read(FOLDER / f"{name}.launch.xml")


def test_all_files_are_known():
    assert {path.name.removesuffix(".launch.xml") for path in FILES} == set(NODES)


@pytest.mark.parametrize("name", NODES)
def test_every_file_starts_nodes_that_are_there(name):
    """Programs and files are looked for when the file is read."""
    apart = {"composed": "false"} if "composed" in plan(name).arguments else {}
    assert nodes_of(plan(name)).keys() == nodes_of(plan(name, **apart)).keys() == NODES[name]
    script = (Packages.of_environment().share("rosplane") / f"launch/{name}.launch.py").read_text()
    compile(script, name, "exec")
    assert "XMLLaunchDescriptionSource" in script


def test_arguments_of_the_reference_are_there():
    arguments = plan("rosplane").arguments
    assert {name: arguments[name].default for name in ARGUMENTS} == ARGUMENTS


@pytest.mark.parametrize("composed", COMPOSED)
@pytest.mark.parametrize("module", STACK)
def test_a_module_can_be_left_out(module, composed):
    assert nodes_of(plan("rosplane", composed=composed, **{module: "false"})).keys() == STACK - {module}


@pytest.mark.parametrize("composed", COMPOSED)
def test_remappings_reach_the_nodes(composed):
    nodes = nodes_of(plan("rosplane_input_mapper", state_topic_remap="sim/rosplane/state", composed=composed,
                          control_type="successive_loop", aircraft="aerosonde"))
    state = ("estimated_state", "sim/rosplane/state")
    assert all(state in nodes[name].remappings for name in STACK - {"estimator"} | {"input_mapper"})
    assert state not in nodes["estimator"].remappings
    assert ("controller_command", "follower_command") in nodes["path_follower"].remappings
    assert ("command", "controller_output") in nodes["controller"].remappings
    assert ("mapped_command", "command") in nodes["input_mapper"].remappings
    assert nodes["controller"].parameters["control_type"] == "successive_loop"
    assert Path(nodes["controller"].parameters["vehicle_file"]).name == "aerosonde.yaml"


@pytest.mark.parametrize("autofly, then", [({}, "--wait"), ({"autofly": "true"}, "--fly")])
def test_it_flies_by_itself_where_that_is_asked_for(autofly, then):
    """What --fly does is flown by roscopter in rosflight_sim's test_launch.py."""
    init, = [node for node in plan("fly", **autofly).nodes if node.name == "init_firmware"]
    assert [word for word in " ".join(init.command).split() if word in ("--wait", "--fly")] == [then]
