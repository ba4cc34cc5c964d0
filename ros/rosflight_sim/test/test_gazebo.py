# SPDX-License-Identifier: BSD-3-Clause
"""The plugin for Gazebo over real topics, with dartsim in place of Gazebo's server (gazebo_rig): mode dynamics_only against
the contract of the dynamics and Newton, mode whole_loop, bad input. The missions are flown in Gazebo Fortress too, where it is
installed."""

import dataclasses
import math
import re
import time

import pytest
from body_rig import TICK_NS, Body
from gazebo_rig import SERVERS, Server, world
from ros_rig import ROOT, free_udp_port
from rosflight_msgs.msg import SimState
from sensor_msgs.msg import Imu
from sim_contract import MODULES, check_headers, check_module
from sim_rig import SimPeer, launch, sim_state, stamp_ns
from std_srvs.srv import Trigger

GRAVITY = 9.80665  # of vehicles/multirotor.yaml
MASS = 3.5
DT = 0.0025
DYNAMICS = dataclasses.replace(MODULES["dynamics"], node="gazebo_dynamics")


@pytest.fixture
def body(peer, tmp_path):
    with Server(world(tmp_path / "world.sdf")) as server:
        server.until("ready")
        made = Body(peer)
        made.server = server
        yield made


# ---- dynamics only -------------------------------------------------------------------------------


def test_it_is_a_dynamics_module(peer, body):
    check_module(peer, DYNAMICS)
    for _ in range(100):
        assert stamp_ns(body.step()) == body.ns  # the stamp of the wrench
    check_headers(body.truth, DYNAMICS.outputs["sim/truth_state"])
    check_headers(body.wind, DYNAMICS.outputs["sim/truth_wind"])
    at_rest = body.step().pose
    assert abs(at_rest.orientation.w) == pytest.approx(1, abs=1e-3)  # nose to the north
    assert -0.3 < at_rest.position.z < 0.0 and math.hypot(at_rest.position.x, at_rest.position.y) < 0.01


def test_a_body_falls_and_turns_as_newton_says(body):
    assert body.put(sim_state(0, z=-100.0)).success
    first = body.step()
    for _ in range(400):
        last = body.step(roll_Nm=0.08)  # inertia 0.08 kg m^2: 1 rad/s^2
    assert last.twist.angular.x == pytest.approx(1.0, rel=2e-3)  # rotors are part of it
    roll = 0.5
    assert last.acceleration.linear.z == pytest.approx(GRAVITY * math.cos(roll), rel=3e-3)
    assert last.acceleration.linear.y == pytest.approx(GRAVITY * math.sin(roll), rel=5e-3)
    # s = v0 t + g t^2/2 with v0 = g T after the first step; dartsim's position leads by v T/2
    fallen = last.pose.position.z - first.pose.position.z
    assert fallen == pytest.approx(GRAVITY * (DT + 0.5), abs=0.5 * DT * GRAVITY + 1e-3)


def test_a_hovering_body_stays(body):
    assert body.put(sim_state(0, z=-10.0)).success
    start = body.step(up_N=MASS * GRAVITY)
    for _ in range(200):
        last = body.step(up_N=MASS * GRAVITY)
    # The wrench of the step that sets the state is lost: it falls with g T.
    assert last.twist.linear.z == pytest.approx(GRAVITY * DT, rel=1e-3)
    assert last.pose.position.z - start.pose.position.z == pytest.approx(200 * DT * GRAVITY * DT, rel=1e-3)
    assert last.acceleration.linear.z == pytest.approx(0.0, abs=1e-3)


def test_a_state_is_set_in_the_axes_of_rosflight_and_not_held(body):
    wanted = sim_state(0, z=-50.0)
    wanted.pose.position.x, wanted.pose.position.y = 30.0, -20.0
    wanted.pose.orientation.w, wanted.pose.orientation.z = math.cos(0.6), math.sin(0.6)  # yaw 1.2
    wanted.twist.linear.x, wanted.twist.linear.y = 4.0, -1.0
    wanted.twist.angular.z = 0.5
    assert body.put(wanted).success
    first = body.step()
    p, q, v, w = first.pose.position, first.pose.orientation, first.twist.linear, first.twist.angular
    assert (p.x, p.y, p.z) == pytest.approx((30.0, -20.0, -50.0), abs=0.02)
    assert (q.w, q.x, q.y, q.z) == pytest.approx((math.cos(0.6), 0, 0, math.sin(0.6)), abs=2e-3)
    assert (v.x, v.y, v.z) == pytest.approx((4.0, -1.0, GRAVITY * DT), abs=0.01)
    assert (w.x, w.y, w.z) == pytest.approx((0, 0, 0.5), abs=1e-3)
    for _ in range(40):
        last = body.step()
    # Nothing holds it: it falls and turns on, over ground it moves as before.
    assert last.twist.linear.z == pytest.approx(41 * GRAVITY * DT, rel=1e-3)
    assert last.twist.angular.z == pytest.approx(0.5, rel=1e-2)
    assert last.pose.position.x - p.x == pytest.approx(0.1 * (4 * math.cos(1.2) + math.sin(1.2)), abs=2e-3)
    assert last.pose.position.y - p.y == pytest.approx(0.1 * (4 * math.sin(1.2) - math.cos(1.2)), abs=2e-3)


def test_states_that_cannot_be_are_refused_and_zeros_mean_the_start(body):
    start = body.step().pose.position.z
    bad = sim_state(0, z=-10.0)
    bad.twist.linear.x = math.nan
    answer = body.put(bad)
    assert not answer.success and "NaN" in answer.message
    no_rotation = sim_state(0, z=-10.0)
    no_rotation.pose.orientation.w = 0.0
    assert not body.put(no_rotation).success
    assert not body.put(sim_state(0, z=3.0)).success  # under ground
    for back in (lambda: body.put(sim_state(0)), lambda: body.peer.call(Trigger, "dynamics/reset")):
        assert body.put(sim_state(0, z=-10.0)).success
        assert body.step().pose.position.z == pytest.approx(-10.0, abs=0.01)
        assert back().success
        assert body.step().pose.position.z == pytest.approx(start, abs=0.01)


def test_a_wrench_that_is_none_is_not_used_and_a_gap_is_bounded(peer, body):
    assert body.put(sim_state(0, z=-100.0)).success
    before = body.step()
    body.ns += 10_000_000_000
    assert body.step().pose.position.z - before.pose.position.z < 0.1  # not 490 m
    assert body.server.until("s between two wrenches")


def test_time_stands_while_gazebo_is_paused(peer, tmp_path):
    with Server(world(tmp_path / "world.sdf", "wait_s=10")) as server:
        server.until("ready")
        body = Body(peer)
        assert body.put(sim_state(0, z=-100.0)).success
        body.step()
        server.toggle_pause()
        quiet = 0
        for _ in range(1000):  # until a row of wrenches has no answer
            count = len(body.truth)
            body._send(0.0)
            time.sleep(0.02)
            quiet = quiet + 1 if len(body.truth) == count else 0
            if quiet == 20:
                break
        assert quiet == 20
        before = body.truth[-1]
        server.toggle_pause()
        resumed_ns = body.ns
        peer.poll(lambda: body._send(0.0) or len(body.truth) > count, "truth after the pause")
        steps = (body.truth[count].twist.linear.z - before.twist.linear.z) / (GRAVITY * DT)
        assert 1 <= round(steps) <= (body.ns - resumed_ns) / TICK_NS + 1, steps  # the twenty are no time


def test_gazebo_waits_for_wrenches(body):
    """One step more than there were wrenches for; the next one makes up for it."""
    assert body.put(sim_state(0, z=-100.0)).success
    before = body.step()
    time.sleep(1.0)
    for _ in range(20):
        last = body.step()
    assert last.twist.linear.z - before.twist.linear.z == pytest.approx(20 * GRAVITY * DT, abs=1.1 * GRAVITY * DT)
    assert last.pose.position.z - before.pose.position.z < 0.05


def test_one_that_cannot_follow_answers_all_the_same(body):
    """A hundred seconds of wrenches in each second: time must not run away from who waits for the truth."""
    count, end = len(body.truth), time.monotonic() + 20.0
    while len(body.truth) == count:
        assert time.monotonic() < end, "no truth"
        body.ns += 39 * TICK_NS
        body._send(0.0)
        time.sleep(0.0002)


def test_the_wind_is_that_of_the_vehicle_file(peer, tmp_path):
    with Server(world(tmp_path / "world.sdf", "set=environment.wind.steady_W_m_s=[3.0, -2.0, 0.5]")) as server:
        server.until("ready")
        body = Body(peer)
        for _ in range(11):
            body.step()
        peer.wait(lambda: body.wind, "a wind")
        assert (body.wind[-1].vector.x, body.wind[-1].vector.y, body.wind[-1].vector.z) == (3.0, -2.0, 0.5)


def test_smaller_steps_of_gazebo_are_several_for_each_wrench(peer, tmp_path):
    file = world(tmp_path / "world.sdf")
    file.write_text(file.read_text().replace("<max_step_size>0.0025<", "<max_step_size>0.0005<"))
    with Server(file) as server:
        server.until("ready")
        body = Body(peer)
        assert body.put(sim_state(0, z=-100.0)).success
        first = body.step()
        for _ in range(100):
            last = body.step()
        assert last.twist.linear.z - first.twist.linear.z == pytest.approx(100 * GRAVITY * DT, rel=1e-6)


# ---- bad input: one line, the simulator goes on ----------------------------------------------------

PLUGIN = re.compile(r"      <plugin filename=\"rosflight.*?</plugin>\n", re.S)


@pytest.mark.parametrize("old, new, line", [
    ("<mode>dynamics_only</mode>", "<mode>both</mode>", "<mode>: found 'both', allowed dynamics_only, whole_loop"),
    ("<mode>dynamics_only</mode>", "<link>wing</link>", "found no link wing in the model, allowed <link> with one of its links"),
    (str(ROOT / "vehicles/multirotor.yaml"), "/nowhere/kite.yaml", "/nowhere/kite.yaml"),
    ("<max_step_size>0.0025<", "<max_step_size>0.001<", "max_step_size: found 0.001 s, allowed 0.0025 s"),
])
def test_bad_input_is_one_line(tmp_path, old, new, line):
    file = world(tmp_path / "world.sdf", "mode=dynamics_only")
    assert old in file.read_text()
    file.write_text(file.read_text().replace(old, new))
    with Server(file) as server:
        said = server.until("rosflight_gazebo_plugin: multirotor: ")
        assert line in said and "the vehicle is without forces" in said
        time.sleep(0.3)
        assert server.process.poll() is None
        assert server.text().count("rosflight_gazebo_plugin: ") == 1


def test_two_plugins_on_one_body(peer, tmp_path):
    file = world(tmp_path / "world.sdf")
    text = file.read_text()
    plugin = PLUGIN.search(text)[0]
    file.write_text(text.replace(plugin, plugin + plugin.replace("</plugin>", "<namespace>/second</namespace></plugin>")))
    with Server(file) as server:
        server.says("found another plugin of ours on multirotor::base_link, allowed one")
        body = Body(peer)  # the first one works
        assert stamp_ns(body.step()) == body.ns


def test_two_dynamics_are_reported(peer, body):
    other = peer.publisher(SimState, "sim/truth_state")  # a forgotten dynamics:=false
    assert other is not None
    with Server(body.server.process.args[1]) as second:
        second.until("ready")
        peer.poll(lambda: body._send(0.0) or "publishers of sim/truth_state, allowed one" in second.text(), "a report")


# ---- whole loop ----------------------------------------------------------------------------------


def test_the_whole_loop_flies_a_mission(tmp_path):
    log = tmp_path / "hop.mcap"
    file = world(tmp_path / "world.sdf", "mode=whole_loop", "mission=hop", "at_end=stop", f"log={log}")
    file.write_text(file.read_text().replace("<real_time_factor>1<", "<real_time_factor>0<"))
    with Server(file) as server:
        assert server.end() == 0, server.text()
        assert "multirotor: mission_done after " in server.lines[-1]
    assert log.read_bytes()[:5] == b"\x89MCAP"


@SERVERS
@pytest.mark.parametrize("kind, vehicle", [("multirotor", "multirotor"), ("fixedwing", "anaconda")])
def test_launched_the_default_missions_are_flown_in_the_simulator(tmp_path, kind, vehicle, server):
    variables = server()
    file = world(tmp_path / "world.sdf", "mode=whole_loop", "at_end=stop", vehicle=ROOT / f"vehicles/{vehicle}.yaml")
    file.write_text(file.read_text().replace("<real_time_factor>1<", "<real_time_factor>0<"))  # as fast as it goes
    with launch("rosflight_sim", f"gazebo_{kind}.launch.xml", environment=variables, mode="whole_loop", gui="false",
                world_file=file) as world_:
        world_.end()
        assert f"{vehicle}: mission_done after " in world_.text(), world_.text()[-3000:]


@SERVERS
def test_launched_all_other_nodes_follow_gazebos_truth_at_rest(tmp_path, server):
    ports = {"simulation_port": free_udp_port(), "ROS_port": free_udp_port()}
    with SimPeer("watcher") as watcher, launch("rosflight_sim", "gazebo_multirotor.launch.xml", environment=server(), gui="false",
                                               use_sim_time="true", memory_folder=tmp_path, **ports) as world_:
        world_.until("ready: ")
        truth, imu = watcher.listen(SimState, "sim/truth_state"), watcher.listen(Imu, "sim/sensors/imu/data")
        watcher.wait(lambda: len(truth) > 400 and len(imu) > 400, "a second of truth and samples")
        at_rest = [m.linear_acceleration.z for m in list(imu)[-200:]]
        assert sum(at_rest) / len(at_rest) == pytest.approx(-GRAVITY, abs=0.2)
        gaps = [b - a for a, b in zip(map(stamp_ns, truth), map(stamp_ns, list(truth)[1:]))]
        assert sorted(gaps)[len(gaps) // 2] == TICK_NS  # time waits for Gazebo's truth, step by step


def test_without_gazebo_the_launch_ends_with_one_line():
    with launch("rosflight_sim", "multirotor_gazebo.launch.xml", environment={"ROSFLIGHT_GAZEBO": "none"}) as world_:
        assert world_.end() == 2
        assert "ros2 launch rosflight_sim multirotor_standalone.launch.py" in world_.lines[-1]
