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
def received(simulator, watcher):
    """All that the modules say, by topic."""
    received = {topic: watcher.listen(out.kind, topic) for name in ("board", "forces", "dynamics", "sensors", "rc")
             for topic, out in MODULES[name].outputs.items()}
    watcher.wait(lambda: all(received.values()), "a message on every topic")
    return received


@pytest.fixture
def paused(watcher):
    """The world stands during a test, and runs after it."""
    pause(watcher, "paused")
    yield
    pause(watcher, "running")


def pause(peer, wanted):
    """Paused or running, whatever it was."""
    if peer.call(Trigger, "time_manager/toggle_pause").message != wanted:
        assert peer.call(Trigger, "time_manager/toggle_pause").message == wanted


def rate_Hz(peer, module, wanted):
    """Messages a second: a number, or the parameter of the module that has it."""
    if not isinstance(wanted, str):
        return wanted
    return peer.call(GetParameters, f"{MODULES[module].node}/get_parameters", names=[wanted]).values[0].double_value


@pytest.mark.parametrize("name", MODULES)
def test_every_module_is_there(simulator, watcher, name):
    check_module(watcher, name)


def test_single_steps_move_the_whole_world_once_each(simulator, watcher, received, paused):
    truth = received["sim/truth_state"]

    def quiet():
        count = len(truth)
        try:
            watcher.wait(lambda: len(truth) > count, "more truth", timeout_s=0.5)
        except AssertionError:
            return True
        return False
    watcher.poll(quiet, "the world to stand")
    assert not watcher.call(Trigger, "rosflight_sil/take_sim_step").message  # by hand: the board runs, time stands
    watcher.poll(quiet, "the world to stand")
    for messages in received.values():
        messages.clear()
    steps = 400
    rates_Hz = {topic: rate_Hz(watcher, name, out.rate_Hz) / out.every for name in ("board", "forces", "dynamics", "sensors", "rc")
                for topic, out in MODULES[name].outputs.items() if out.rate_Hz is not None}
    of_each_step = [received[topic] for topic, per_second in rates_Hz.items() if per_second == steps]
    take_step = watcher.node.create_client(Trigger, "time_manager/take_step")
    for count in range(1, steps + 1):
        done = take_step.call_async(Trigger.Request())
        # A module takes the newest state: one that is late on a loaded machine would miss a step.
        watcher.wait(lambda c=count: all(len(messages) >= c - 1 for messages in of_each_step) and len(truth) >= c,
                     f"all of step {count}")
        wait_for(done.done, "the answer")
    assert len(truth) == steps
    stamps = [stamp_ns(message) for message in truth]
    assert {later - earlier for earlier, later in zip(stamps, stamps[1:])} == {TICK_NS}
    # In this one second each topic has the rate of the contract.
    for name in ("board", "forces", "dynamics", "sensors", "rc"):
        for topic, out in MODULES[name].outputs.items():
            if topic in rates_Hz:
                watcher.poll(lambda t=topic: abs(len(received[t]) - rates_Hz[t]) <= 1, f"{rates_Hz[topic]} messages of {topic}, has {len(received[topic])}")
            check_headers(received[topic], out)


def test_a_state_can_be_imposed_and_reset(simulator, watcher, received):
    truth = received["sim/truth_state"]
    up = SimState()
    up.pose.orientation.w, up.pose.position.z = 1.0, -50.0
    assert watcher.call(SetSimState, "dynamics/set_sim_state", state=up).success
    watcher.wait(lambda: truth[-1].pose.position.z < -40.0, "the height")
    watcher.wait(lambda: truth[-1].twist.linear.z > 1.0, "the fall")
    assert watcher.call(Trigger, "dynamics/reset").success
    watcher.wait(lambda: -1.0 < truth[-1].pose.position.z, "the ground")


def test_time_is_the_clock_of_all(simulator, watcher, received):
    clock = watcher.listen(Clock, "/clock", ALL_BEST_EFFORT)
    watcher.wait(lambda: len(clock) > 100, "time")
    stamp = stamp_ns(received["sim/truth_state"][-1])
    now = clock[-1].clock.sec * 1_000_000_000 + clock[-1].clock.nanosec
    assert abs(now - stamp) < 60_000_000_000  # not the wall's, which is half a century away
    assert simulator.process.poll() is None
