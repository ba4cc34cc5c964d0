# SPDX-License-Identifier: BSD-3-Clause
"""The launched simulator as a whole, in simulated time: single steps, rates, pause, reset, scaled time."""

import pytest
from ros_rig import free_udp_port, wait_for
from rosflight_msgs.msg import SimState
from rosflight_msgs.srv import SetSimState
from rosgraph_msgs.msg import Clock
from sim_contract import MODULES, check_headers, check_module
from sim_rig import ALL_BEST_EFFORT, SimPeer, launch, stamp_ns
from rcl_interfaces.srv import GetParameters
from std_srvs.srv import Trigger

TICK_NS = 2_500_000


@pytest.fixture(scope="module")
def simulator(tmp_path_factory):
    place = tmp_path_factory.mktemp("simulator")
    with launch("rosflight_sim", "multirotor_standalone.launch.py", use_sim_time="true", real_time_multiplier="0.5",
                memory_folder=place, simulation_port=free_udp_port(), ROS_port=free_udp_port()) as process:
        process.until("ready: 9 nodes in ")
        yield process


@pytest.fixture(scope="module")
def watcher():
    with SimPeer("watcher") as peer:
        yield peer


@pytest.fixture(scope="module")
def heard(simulator, watcher):
    """All that the modules say, by topic."""
    heard = {topic: watcher.listen(out.kind, topic) for name in ("board", "forces", "dynamics", "sensors", "rc")
             for topic, out in MODULES[name].outputs.items()}
    watcher.wait(lambda: all(heard.values()), "a message on every topic")
    return heard


def pause(peer, wanted):
    """Paused or running, whatever it was."""
    if peer.call(Trigger, "time_manager/toggle_pause").message != wanted:
        assert peer.call(Trigger, "time_manager/toggle_pause").message == wanted


@pytest.mark.parametrize("name", MODULES)
def test_every_module_is_there(simulator, watcher, name):
    check_module(watcher, name)


def test_single_steps_move_the_whole_world_once_each(simulator, watcher, heard):
    pause(watcher, "paused")
    truth = heard["sim/truth_state"]

    def quiet():
        count = len(truth)
        try:
            watcher.wait(lambda: len(truth) > count, "more truth", patience_s=0.5)
        except AssertionError:
            return True
        return False
    watcher.poll(quiet, "the world to stand")
    assert not watcher.call(Trigger, "rosflight_sil/take_sim_step").message  # by hand: the board runs, time stands
    watcher.poll(quiet, "the world to stand")
    for messages in heard.values():
        messages.clear()
    steps = 400
    take_step = watcher.node.create_client(Trigger, "time_manager/take_step")
    for count in range(1, steps + 1):
        done = take_step.call_async(Trigger.Request())
        watcher.wait(lambda c=count: len(truth) >= c, f"truth of step {count}")
        wait_for(done.done, "the answer")
    assert len(truth) == steps
    stamps = [stamp_ns(message) for message in truth]
    assert {later - earlier for earlier, later in zip(stamps, stamps[1:])} == {TICK_NS}
    # In this one second each topic has the rate of the contract.
    for name in ("board", "forces", "dynamics", "sensors", "rc"):
        for topic, out in MODULES[name].outputs.items():
            rate_Hz = out.rate_Hz
            if isinstance(rate_Hz, str):
                rate_Hz = watcher.call(GetParameters, f"{MODULES[name].node}/get_parameters",
                                       names=[rate_Hz]).values[0].double_value
            watcher.poll(lambda t=topic, r=rate_Hz: abs(len(heard[t]) - r) <= 1, f"{rate_Hz} messages of {topic}, has {len(heard[topic])}")
            check_headers(heard[topic], out)
    pause(watcher, "running")


def test_a_state_can_be_imposed_and_reset(simulator, watcher, heard):
    truth = heard["sim/truth_state"]
    up = SimState()
    up.pose.orientation.w, up.pose.position.z = 1.0, -50.0
    assert watcher.call(SetSimState, "dynamics/set_sim_state", state=up).success
    watcher.wait(lambda: truth[-1].pose.position.z < -40.0, "the height")
    watcher.wait(lambda: truth[-1].twist.linear.z > 1.0, "the fall")
    assert watcher.call(Trigger, "dynamics/reset").success
    watcher.wait(lambda: -1.0 < truth[-1].pose.position.z, "the ground")


def test_time_is_the_clock_of_all(simulator, watcher, heard):
    clock = watcher.listen(Clock, "/clock", ALL_BEST_EFFORT)
    watcher.wait(lambda: len(clock) > 100, "time")
    stamp = stamp_ns(heard["sim/truth_state"][-1])
    now = clock[-1].clock.sec * 1_000_000_000 + clock[-1].clock.nanosec
    assert abs(now - stamp) < 60_000_000_000  # not the wall's, which is half a century away
    assert simulator.process.poll() is None
