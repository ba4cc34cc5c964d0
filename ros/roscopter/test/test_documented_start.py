# SPDX-License-Identifier: BSD-3-Clause
"""The start that ROSflight 2.x documents, step by step: simulator, firmware set, stack, mission, arm, go. What a throttle does is
then the firmware set's, not the vehicle file's."""

import pytest
from copter_flight import Flight
from ros_rig import ROOT
from rosflight_msgs.srv import ParamFile, ParamSet
from sim_rig import launch

SET = str(ROOT / "ros/rosflight_sim/params/multirotor_firmware/multirotor_combined.yaml")
READY = "thrust as the flight controller makes it: USE_MOTOR_PARAM 1, RC_MAX_THR 0.7"
HOP_PLACES = [(4, 0, -3), (4, 4, -3)]


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    with Flight("rosflight_sim", "multirotor_standalone.launch.py", tmp_path_factory.mktemp("memory")) as world:
        world.process.until("ready: ")
        with launch("rosflight_sim", "multirotor_init_firmware.launch.py") as init:
            assert init.end() == 0, init.text()
        with launch("roscopter", "sim.launch.py", use_sim_time="true") as world.stack:
            world.until(lambda: world.states and world.status and world.status[-1].error_code == 0, "a state and no error")
            yield world


@pytest.mark.parametrize("name, wrong, right, why", [
    ("RC_MAX_THR", 0.2, 0.7, "USE_MOTOR_PARAM 1, RC_MAX_THR 0.2"), ("NUM_MOTORS", 6.0, 4.0, "NUM_MOTORS: found 6, allowed 4"),
    ("PRIMARY_MIXER", 4.0, 11.0, "PRIMARY_MIXER: found 4, that of 6 motors")])
def test_it_does_not_take_off_with_motors_that_are_not_the_vehicles(flight, name, wrong, right, why):
    """A throttle that cannot carry it, another number of motors, the mixer of a hexacopter: it says which parameters, and with the
    right ones it is ready again."""
    told = flight.stack.text().count(READY)
    assert flight.peer.call(ParamSet, "param_set", name=name, value=wrong).exists
    flight.stack.until(f"no take-off: {why}")
    flight.pilot("toggle_arm", lambda: flight.status[-1].armed, "being armed")
    flight.pilot("toggle_override", lambda: not flight.status[-1].rc_override & 3, "the override to end")
    start = len(flight.truth)
    flight.until(lambda: len(flight.truth) > start + 2000, "five seconds")
    assert all(m.pose.position.z > -0.2 for m in flight.truth)
    flight.until(lambda: flight.phase() == "disarmed", "the phase disarmed")
    flight.pilot("toggle_override", lambda: flight.status[-1].rc_override & 3, "the override")
    flight.pilot("toggle_arm", lambda: not flight.status[-1].armed, "being disarmed")
    assert flight.peer.call(ParamSet, "param_set", name=name, value=right).exists
    assert flight.peer.call(ParamFile, "param_load_from_file", filename=SET).success  # a predefined mixer has overwritten PRI_MIXER_*
    flight.stack.until(READY, times=told + 1)


def test_the_mission_is_flown(flight):
    assert flight.peer.call(ParamFile, "path_planner/load_mission_from_file", filename=str(ROOT / "missions/hop.yaml")).success
    flight.take_off()
    flight.until_phase("offboard")
    flight.until_phase("landed")
    for place in HOP_PLACES:
        assert flight.nearest_to(place) < 2.0
    assert max(-m.pose.position.z for m in flight.truth) < 4.0
    assert abs(flight.place()[2]) < 0.4
