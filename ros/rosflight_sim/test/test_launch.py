# SPDX-License-Identifier: BSD-3-Clause
"""The launch files as a user starts them: ready, death of a node, wrong input."""

import math
import os
import signal
import subprocess
import time

import pytest
from ros_rig import ROOT, TIMEOUT_S, free_udp_port
from rosflight_msgs.msg import PwmOutput, SimState
from sim_rig import SimPeer, executable, last_s, launch, node, pid_of, stamp_ns


def own(tmp_path):
    return {"memory_folder": tmp_path, "simulation_port": free_udp_port(), "ROS_port": free_udp_port()}


@pytest.mark.parametrize("composed, dies, program", [
    ("true", "compose", "rosflight_common/compose"),
    ("false", "standalone_dynamics", "rosflight_sim/standalone_dynamics")])
def test_wall_time_runs_and_a_dead_process_takes_the_launch_down(tmp_path, composed, dies, program):
    with SimPeer("watcher") as watcher, launch("rosflight_sim", "multirotor_standalone.launch.xml", composed=composed,
                                               **own(tmp_path)) as world:
        world.until("ready: 8 nodes in ")
        truth, pulses = watcher.listen(SimState, "sim/truth_state"), watcher.listen(PwmOutput, "sim/pwm_output")
        watcher.wait(lambda: len(truth) > 200 and len(pulses) > 200, "half a second of truth and pulses")
        assert abs(stamp_ns(truth[-1]) - time.time_ns()) < 60e9  # the wall's time

        def pairs():  # truth carries the stamp of the pulses that led to it
            return {stamp_ns(message) for message in truth} & {stamp_ns(message) for message in pulses}
        watcher.wait(lambda: len(pairs()) > 20, "pulses with their truth")
        os.kill(pid_of(world, dies), signal.SIGSEGV)
        assert world.end() == 1
        assert f"launch: {dies} ({program}) ended with signal 11 (SIGSEGV); its last lines:" in world.text()
        assert len(world.text().split("its last lines:")[1].splitlines()) > 2
        assert world.lines[-1] == f"launch: {dies} ({program}) ended with signal 11 (SIGSEGV)"


def test_a_second_simulator_in_the_same_domain_says_so_and_stops(tmp_path):
    """Whatever ports and memory it has; the first runs on. When the first has been killed there is room again."""
    with launch("rosflight_sim", "multirotor_standalone.launch.xml", viz="false", **own(tmp_path / "a")) as world:
        world.until("ready: ")
        with launch("rosflight_sim", "multirotor_standalone.launch.xml", viz="false", **own(tmp_path / "b")) as second:
            assert second.end() == 2, second.text()
            assert "found another simulator in ROS domain " in second.lines[-1] and ", namespace / (process " in second.lines[-1]
            assert f"(process {pid_of(world, 'compose')})" in second.lines[-1] and "allowed one: end it" in second.lines[-1]
        assert world.process.poll() is None
        os.kill(pid_of(world, "compose"), signal.SIGKILL)
        assert world.end() == 1
    with node("sil_board", memory_folder=tmp_path / "c", simulation_port=free_udp_port(), ROS_port=free_udp_port()):
        pass


def test_two_vehicles_have_topics_memories_and_links_of_their_own(tmp_path):
    file = tmp_path / "two.launch.xml"
    vehicle = """<group><push-ros-namespace namespace="{0}"/>
      <include file="$(find-pkg-share rosflight_sim)/launch/multirotor_standalone.launch.xml">
        <arg name="use_sim_time" value="false"/><arg name="viz" value="false"/></include></group>"""
    ports = [free_udp_port() for _ in range(4)]
    lets = '<let name="memory_folder" value="{}"/><let name="simulation_port" value="{}"/><let name="ROS_port" value="{}"/>'
    file.write_text("<launch>" + lets.format(tmp_path, *ports[:2]) + vehicle.format("one")
                    + lets.format(tmp_path, *ports[2:]) + vehicle.format("two") + "</launch>")
    with SimPeer("watcher") as watcher, launch(file) as world:
        world.until("ready: 14 nodes in ")
        for name in ("one", "two"):
            truth = watcher.listen(SimState, f"/{name}/sim/truth_state")
            watcher.wait(lambda: truth, f"truth of {name}")
            assert (tmp_path / name / "multirotor/mem.bin").exists()


def stands(truth):
    """Time, for half a second of the wall's."""
    before = last_s(truth)
    time.sleep(0.5)
    return last_s(truth) - before < 0.02


def test_two_vehicles_fly_in_simulated_time(tmp_path):
    """Each by itself (autofly) from the launch file of the stack. One time manager, in the namespace of one, for both: neither is left
    behind, and it says so when there is a second."""
    file = tmp_path / "two.launch.xml"
    ports = [free_udp_port() for _ in range(4)]
    vehicle = """<group><push-ros-namespace namespace="{0}"/>
      <let name="simulation_port" value="{1}"/><let name="ROS_port" value="{2}"/><let name="time_manager" value="{3}"/>
      <include file="$(find-pkg-share roscopter)/launch/fly.launch.xml">
        <arg name="use_sim_time" value="true"/><arg name="autofly" value="true"/></include></group>"""
    file.write_text(f'<launch><let name="memory_folder" value="{tmp_path}"/><let name="real_time_multiplier" value="10.0"/>'
                    '<let name="viz" value="false"/>'
                    '<let name="wait_for" value="sim/RC command /two/sim/truth_state /two/sim/RC /two/command /judge"/>'
                    + vehicle.format("one", *ports[:2], "true") + vehicle.format("two", *ports[2:], "false") + "</launch>")
    with SimPeer("watcher") as watcher, launch(file) as world:
        one = watcher.listen(SimState, "/one/sim/truth_state", progress="/judge")
        two = watcher.listen(SimState, "/two/sim/truth_state")
        world.until("the autopilot has control", times=2)
        watcher.wait_simulated(lambda: all(truth[-1].pose.position.z < -2.0 for truth in (one, two)), "both at 2 m", lambda: last_s(one))
        assert abs(stamp_ns(one[-1]) - stamp_ns(two[-1])) < 20e6  # a lag, a step of the observer, and what is under way
        other = pid_of(world, "rosflight_common/compose", "__ns:=/two")
        os.kill(other, signal.SIGSTOP)
        try:
            watcher.poll(lambda: stands(one), "time to wait for two")
            before = last_s(one)
        finally:
            os.kill(other, signal.SIGCONT)
        watcher.wait_simulated(lambda: min(last_s(one), last_s(two)) > before + 0.5, "both to go on", lambda: last_s(one))
        assert "publishers of /clock" not in world.text()
        with node("standalone_time_manager", at_launch="another") as another:
            another.until("publishers of /clock, allowed one")


@pytest.mark.parametrize("vehicle", ["anaconda", "aerosonde"])
def test_a_fixed_wing_stands_and_takes_its_set(tmp_path, vehicle):
    """The whole simulator of a fixed wing comes up, stands still, and its firmware takes the set."""
    file = ROOT / f"vehicles/{vehicle}.yaml"
    with SimPeer("watcher") as watcher, launch("rosflight_sim", "fixedwing_standalone.launch.py", use_sim_time="true",
                                               dynamics_param_file=file, **own(tmp_path)) as world:
        world.until("ready: 9 nodes in ")
        truth = watcher.listen(SimState, "sim/truth_state")
        watcher.wait(lambda: len(truth) > 400, "a second of truth")
        assert all(math.isfinite(m.pose.position.z) and abs(m.pose.position.z) < 2 for m in truth)
        assert math.hypot(truth[-1].pose.position.x, truth[-1].pose.position.y) < 1
        with launch("rosflight_sim", "fixedwing_init_firmware.launch.py") as init:
            assert init.end() == 0, init.text() + world.text()
        assert world.process.poll() is None


WRONG_TYPE = "sil_board: {ros__parameters: {simulation_port: abc}}\n"


@pytest.mark.parametrize("words, said", [
    (["rosflight_sim", "multirotor_standalone.launch.xml", "use_vim_fly:=true"], "argument: found 'use_vim_fly', allowed one of "),
    (["rosflight_simm", "multirotor_standalone.launch.xml"], "package: found 'rosflight_simm', allowed "),
    (["rosflight_sim", "quadrotor.launch.xml"], "found 'quadrotor.launch.xml', allowed one of "),
    (["no_such_file.launch.xml"], "found 'no_such_file.launch.xml', allowed a file that is there"),
])
def test_a_wrong_command_is_one_line(words, said):
    with launch(*words) as world:
        assert world.end() == 2
        assert len(world.lines) == 1 and said in world.lines[0]


@pytest.mark.parametrize("words, said", [
    (["multirotor_standalone.launch.xml", "dynamics_param_file:=/no/such.yaml"], "/no/such.yaml: found no such file, allowed a YAML file"),
    (["multirotor_standalone.launch.xml", "seed:=-1"], "seed"),
    (["multirotor_standalone.launch.xml", "simulation_port:=abc"], "_port' has invalid type: "),
    (["multirotor_standalone.launch.xml", "use_sim_time:=true", "real_time_multiplier:=0"], "real_time_multiplier"),
    (["hardware_io.launch.xml", "port:=/dev/no_such_port"], "port: found /dev/no_such_port"),
    (["hardware_io.launch.xml", "port:=/dev/null", "baud_rate:=12345"], "baud"),
    (["hardware_io.launch.xml", "baud_rate:=fast"], "baud_rate"),
])
def test_what_a_node_refuses_is_the_last_line(words, said):
    """One argument can reach several nodes (the port: the board and the I/O node); the first that refuses it ends the launch."""
    with launch("rosflight_sim", *words) as world:
        assert world.end() == 2, world.text()
        assert "refused to start: " in world.lines[-1] and said in world.lines[-1], world.text()


@pytest.mark.parametrize("text, said", [
    (WRONG_TYPE, "parameter 'simulation_port' has invalid type"),
    ("sil_board: {ros__parameters: {simulation_port: 0}}\n", "simulation_port"),
    ("sil_board: [1\n", "params file"),
    (None, "params file"),
])
def test_a_wrong_parameter_file_is_told_by_the_node(tmp_path, text, said):
    file = tmp_path / "parameters.yaml"
    if text is not None:
        file.write_text(text)
    done = subprocess.run([executable("rosflight_sim", "sil_board"), "--ros-args", "--params-file", file], capture_output=True, text=True,
                          timeout=TIMEOUT_S)
    assert done.returncode == 2
    last = done.stderr.strip().splitlines()[-1]
    assert last.startswith("sil_board: ") and said in last, done.stderr


def test_a_wrong_parameter_file_in_a_launch_file(tmp_path):
    for text, code, said in ((WRONG_TYPE, 2, "parameter 'simulation_port' has invalid type"), ("sil_board: 3\n", 2, "found no node with ros__parameters")):
        parameters, file = tmp_path / "p.yaml", tmp_path / "it.launch.xml"
        parameters.write_text(text)
        file.write_text(f'<launch><node pkg="rosflight_sim" exec="sil_board" name="sil_board"><param from="{parameters}"/></node></launch>')
        with launch(file) as world:
            assert world.end() == code
            assert said in world.lines[-1]


def test_init_firmware_without_an_autopilot_tells_what_it_waits_for(tmp_path):
    """Ends with the node's own words when nothing is there: checked with a file that is not."""
    done = subprocess.run([executable("rosflight_sim", "init_firmware")], capture_output=True, text=True, timeout=TIMEOUT_S)
    assert done.returncode == 2 and "found 0 files, allowed one" in done.stderr
