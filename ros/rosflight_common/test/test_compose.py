# SPDX-License-Identifier: BSD-3-Clause
"""Nodes of several packages in one process."""

import os

import pytest
from rclpy.parameter import Parameter
from ros_launch.packages import Packages
from ros_launch.reader import Reader
from ros_rig import PREFIXES, ROOT, free_udp_port, program
from rosflight_msgs.msg import SimState, Status
from sim_rig import VEHICLE, Process, SimPeer, executable
from std_srvs.srv import Trigger

SIMULATOR = ["rosflight_sim/sil_board", "rosflight_sim/rosflight_sil_manager", "rosflight_sim/standalone_sensors",
             "rosflight_sim/rc", "rosflight_sim/multirotor_forces_and_moments", "rosflight_sim/standalone_dynamics"]


def compose(*components, environment=None, **parameters):
    words = [word for key, value in parameters.items() for word in ("-p", f"{key}:={value}")]
    return Process(executable("rosflight_common", "compose"), *components, "--ros-args", *words, env=environment)


def test_simulator_and_io_node_run_in_one_process(tmp_path):
    """The world moves, and the board answers a request of the I/O node."""
    here, there = free_udp_port(), free_udp_port()
    with SimPeer("watcher") as watcher, compose(
            *SIMULATOR, "rosflight_io/rosflight_io", vehicle_file=VEHICLE, memory_folder=tmp_path, simulation_port=there,
            ROS_port=here, udp="true", bind_port=here, remote_port=there) as process:
        process.until("ready: 7 nodes in one process")
        truth, status = watcher.listen(SimState, "sim/truth_state"), watcher.listen(Status, "status")
        watcher.wait(lambda: len(truth) > 200 and len(status) > 5, "truth and status")
        watcher.poll(lambda: watcher.call(Trigger, "all_params_received").success, "all parameters")
        names = {name for name, _ in watcher.node.get_node_names_and_namespaces()}
        assert {"sil_board", "rosflight_io", "dynamics", "sensors", "rc"} <= names
        assert len(os.listdir(f"/proc/{process.process.pid}/task")) > 7  # the threads of all nodes are in this process


@pytest.mark.parametrize("package, state_topic, controller", [
    ("roscopter", "state_topic", "roscopter/controller:controller"), ("rosplane", "state_topic_remap", "rosplane/controller:controller")])
def test_a_flight_is_one_process(package, state_topic, controller):
    """Simulator, firmware, I/O node and stack, with the mission and the remappings of the stack."""
    packages = Packages.of_environment()
    given = {state_topic: "sim/state", "mission_file": "/m.yaml"}
    plan = Reader(packages, given, {"ROSFLIGHT_GUI": "false"}).read(packages.share(package) / "launch/fly.launch.xml")
    process, = (node for node in plan.nodes if node.what == "rosflight_common/compose")
    assert {node.what for node in plan.nodes} == {process.what, "rosflight_sim/init_firmware"}
    assert {controller, "rosflight_sim/sil_board", "rosflight_io/rosflight_io:rosflight_io"} <= {
        word.removesuffix(":sil_board") for word in " ".join(process.command).split()}
    assert "mission_file:='/m.yaml'" in process.parameters
    assert ("controller:estimated_state", "sim/state") in process.remappings


@pytest.mark.parametrize("words", [["rosflight_gcs/viz:left", "rosflight_gcs/viz:right"],
                                   [" rosflight_gcs/viz:left rosflight_gcs/viz:right"]])
def test_a_component_can_have_another_name(words):
    """In words of their own or in one, as `ros2 launch` passes on the value of a variable."""
    with SimPeer("watcher") as watcher, compose(*words) as process:
        process.until("ready: 2 nodes in one process")
        watcher.poll(lambda: {"left", "right"} <= {name for name, _ in watcher.node.get_node_names_and_namespaces()},
                     "both names")


@pytest.mark.parametrize("words, says", [
    ([], "component: found none, allowed PACKAGE/NODE[:NAME]..."),
    (["viz"], "component: found 'viz', allowed PACKAGE/NODE or PACKAGE/NODE:NAME"),
    (["rosflight_gcs/vis"], "component: found rosflight_gcs/vis, allowed a node of an installed package"),
    (["rosflight_sim/multirotor_forces_and_moments"], "parameter vehicle_file: found nothing, allowed a vehicle file: "
     "-p vehicle_file:=FILE, or -r __node:=multirotor_forces_and_moments")])
def test_what_cannot_be_composed_is_one_line(words, says):
    process = compose(*words)
    assert process.end() == 2
    assert process.lines[-1] == f"compose: {says}"


def test_arguments_that_ros_refuses_are_one_line():
    process = compose("rosflight_gcs/viz", mission_file="")
    assert process.end() == 2
    assert process.lines[-1].startswith("compose: ") and "'-p mission_file:='" in process.lines[-1]


def test_an_exception_ends_the_process_before_all_threads_run(tmp_path):
    """The first thread throws while the others are being started."""
    (tmp_path / "lib").symlink_to(PREFIXES[0].parent / "build/rosflight_common")
    environment = {**os.environ, "AMENT_PREFIX_PATH": f"{os.environ['AMENT_PREFIX_PATH']}:{tmp_path}"}
    component = "rosflight_common/throws_at_once"
    for _ in range(8):
        process = compose(f"{component}:throws", *(f"{component}:waits_{i}" for i in range(8)), environment=environment)
        assert process.end() == 2
        assert process.lines[-1] == "compose: thrown by a timer"


@pytest.mark.parametrize("intra_process", [False, True])
def test_a_container_of_ros_loads_our_nodes(tmp_path, intra_process):
    """With rclcpp_components. Each library of a node stands in the index under its class."""
    container = program("rclcpp_components", "component_container")
    if not container:
        pytest.skip("rclcpp_components is not installed")
    from composition_interfaces.srv import LoadNode
    nodes = {}
    for package in ("rosflight_io", "rosflight_sim", "rosflight_gcs", "roscopter", "rosplane"):
        prefix = next(prefix for prefix in PREFIXES if (prefix / "share" / package).is_dir())
        lines = (prefix / "share/ament_index/resource_index/rclcpp_components" / package).read_text().split()
        nodes[package], libraries = zip(*(line.split(";") for line in lines))
        made = {f"lib{package}_{file.name}.so" for file in (prefix / "lib" / package).iterdir()}
        assert set(libraries) == {f"lib/{name}" for name in made if (prefix / "lib" / name).exists()}
    with SimPeer("loader") as peer, Process(container) as process:
        for package, names in nodes.items():
            vehicle = ROOT / "vehicles/anaconda.yaml" if package == "rosplane" else VEHICLE
            given = [Parameter(name, value=value).to_parameter_msg() for name, value in
                     {"vehicle_file": str(vehicle), "memory_folder": str(tmp_path), "wait_for_port": True}.items()]
            for name in dict.fromkeys(names):
                answer = peer.call(LoadNode, "/ComponentManager/_container/load_node", package_name=package, plugin_name=name,
                                   node_namespace=f"/{package}", parameters=given,
                                   extra_arguments=[Parameter("use_intra_process_comms", value=intra_process).to_parameter_msg()])
                assert answer.success, f"{package} {name}: {answer.error_message}\n{process.text()}"
