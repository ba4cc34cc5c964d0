# SPDX-License-Identifier: BSD-3-Clause
"""The controller with the thrust of the vehicle file on a flight controller with other motors, which it is told not to ask: it climbs
through its hold with next to no thrust, so the controller warns and lands."""

from copter_flight import Flight
from ros_rig import ROOT
from sim_rig import VEHICLE, launch, node


def test_a_vehicle_that_does_not_follow_its_thrust_is_landed_with_a_warning(tmp_path):
    with Flight("rosflight_sim", "multirotor_standalone.launch.py", tmp_path) as world:
        world.process.until("ready: ")
        with launch("rosflight_sim", "multirotor_init_firmware.launch.py") as init:
            assert init.end() == 0, init.text()
        simulated = {"use_sim_time": "true", "vehicle_file": VEHICLE}
        with launch("roscopter", "roscopter.launch.py", controller="false", simulated="true", clock="/clock_steps",
                    mission_file=ROOT / "missions/hop.yaml", **simulated), \
                node("controller", package="roscopter", use_firmware_parameters="false", **simulated) as controller:
            world.until(lambda: world.states and world.status and world.status[-1].error_code == 0, "a state and no error")
            world.take_off()
            world.until_phase("landing")
            assert "[WARN]" in controller.until("does not follow its thrust")
            height = max(-m.pose.position.z for m in world.truth)
            world.until_phase("landed")
            assert 2.0 < height < 15.0  # of the mission's take-off: 3 m
            assert abs(world.place()[2]) < 0.4
