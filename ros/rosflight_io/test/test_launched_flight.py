# SPDX-License-Identifier: BSD-3-Clause
"""Every topic and service of rosflight_io while the example flies its square in the launched simulator."""

import math
from functools import partial

import pytest
from io_streams import STREAMS
from ros_rig import free_udp_port
from rosflight_msgs.msg import AuxCommand, SimState
from rosflight_msgs.srv import ParamFile, ParamGet, ParamSet
from sim_rig import LATCHED, SimPeer, last_s, launch, set_parameters
from std_msgs.msg import Bool, String
from std_srvs.srv import Trigger

LATCHED_STREAMS = {"version": String, "status/unsaved_params": Bool}
REFUSED_IN_FLIGHT = ("calibrate_imu", "calibrate_baro", "calibrate_rc_trim", "param_write", "reboot",
                     "reboot_to_bootloader")


@pytest.fixture(scope="module")
def world(tmp_path_factory):
    ports = {"simulation_port": free_udp_port(), "ROS_port": free_udp_port()}
    with SimPeer("judge") as peer, launch("rosflight_sim", "multirotor_standalone.launch.xml", use_sim_time="true",
                                          real_time_multiplier="2.0", wait_for="sim/RC judge command",
                                          memory_folder=tmp_path_factory.mktemp("memory"), **ports) as process:
        process.until("ready: ")
        peer.received = {name: peer.listen(kind, name) for name, kind in STREAMS.items()}
        peer.received |= {name: peer.listen(kind, name, LATCHED) for name, kind in LATCHED_STREAMS.items()}
        peer.received["sim/truth_state"] = peer.listen(SimState, "sim/truth_state", progress="judge")
        with launch("rosflight_sim", "multirotor_init_firmware.launch.py") as init:
            assert init.end() == 0, init.text()
        yield peer


def in_flight(peer):
    states = peer.received["sim/truth_state"]
    return states and states[-1].pose.position.z < -1.0


def speed(peer, factor):
    assert set_parameters(peer, "standalone_time_manager", real_time_multiplier=factor)[0].successful


def test_flight(world, tmp_path):
    status = world.received["status"]
    with launch("rosflight_examples", "square.launch.xml", exec="square", use_sim_time="true") as flight:
        simulated = partial(last_s, world.received["sim/truth_state"])
        world.wait_simulated(lambda: in_flight(world), "being in the air", simulated)
        speed(world, 0.1)  # the square takes half a minute of the world, and what follows may take as long on a slow machine
        before = {name: len(world.received[name]) for name in STREAMS}

        refused = {name: world.call(Trigger, name) for name in REFUSED_IN_FLIGHT}
        assert not any(answer.success for answer in refused.values()), refused
        assert all(answer.message for answer in refused.values()), refused
        gain = world.call(ParamGet, "param_get", name="PID_ROLL_ANG_P")
        assert gain.exists and world.call(ParamSet, "param_set", name="PID_ROLL_ANG_P", value=gain.value).exists
        assert not world.call(ParamSet, "param_set", name="PRIMARY_MIXER", value=3.0).exists, "locked while armed"
        assert world.call(Trigger, "all_params_received").success
        assert world.call(Trigger, "print_mixing_matrix").success
        world.publisher(AuxCommand, "aux_command").publish(AuxCommand())
        assert in_flight(world)

        speed(world, 2.0)
        world.wait_simulated(lambda: all(len(world.received[name]) > count + 3 for name, count in before.items()), "all streams",
                             simulated)
        assert status[-1].armed and status[-1].offboard and not status[-1].failsafe
        assert flight.end() == 0, flight.text()
    truth, q = world.received["sim/truth_state"], [message.attitude for message in world.received["attitude"]]
    assert min(state.pose.position.z for state in truth) < -1.5
    assert max(abs(2 * math.asin(max(-1.0, min(1.0, math.hypot(a.x, a.y))))) for a in q) > 0.03, "it leaned"
    assert any(max(m.values[:4]) > 0.3 for m in world.received["output_raw"])
    assert all(len(world.received[name]) > 0 for name in LATCHED_STREAMS)


def test_on_the_ground_again_services_do_their_work(world, tmp_path):
    file = str(tmp_path / "parameters.yaml")
    assert world.call(ParamFile, "param_save_to_file", filename=file).success
    assert world.call(ParamFile, "param_load_from_file", filename=file).success
    for name in ("calibrate_imu", "calibrate_baro", "calibrate_rc_trim", "param_write", "reboot"):
        answer = world.call(Trigger, name)
        assert answer.success, (name, answer.message)
