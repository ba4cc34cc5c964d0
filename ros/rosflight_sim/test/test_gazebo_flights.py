# SPDX-License-Identifier: BSD-3-Clause
"""Mode dynamics_only as it is launched: Gazebo in place of the dynamics node, all other nodes of the simulator unchanged. Armed and
driven by a few lines of rclpy over topics, judged by the truth. In Gazebo Fortress too, where it is installed (gazebo_rig)."""

import math
import re

import pytest
from flight_rig import STEP_NS, FlightRig
from gazebo_rig import SERVERS, world
from geometry_msgs.msg import WrenchStamped
from ros_rig import ROOT, free_udp_port
from rosflight_msgs.msg import Command, SimState
from sensor_msgs.msg import Imu
from sim_rig import launch, stamp_ns

GRAVITY = 9.80665  # of both vehicle files
MASS = 3.5         # of vehicles/multirotor.yaml
HZ = 400
EVERY = 4  # truths for one command: 100 Hz


def idle(truth):
    return Command(mode=Command.MODE_PASS_THROUGH)


class Hover:
    """A height above the start, over the start: from the truth to angles and a throttle."""

    def __init__(self, start):
        self.start, self.height, self.throttle = start, 2.0, 0.2

    def __call__(self, truth):
        p, v = truth.pose.position, truth.twist.linear
        wanted = max(-0.5, min(1.0, self.height - self.height_of(truth)))  # climb [m/s]
        error = wanted + v.z
        self.throttle = max(0.0, min(0.6, self.throttle + 0.15 * error * EVERY / HZ))
        command = Command(mode=Command.MODE_ROLL_PITCH_YAWRATE_THROTTLE)
        command.u[2] = max(0.0, min(1.0, self.throttle + 0.15 * error))
        command.u[3] = max(-0.2, min(0.2, -0.1 * (p.y - self.start.y) - 0.15 * v.y))
        command.u[4] = max(-0.2, min(0.2, 0.1 * (p.x - self.start.x) + 0.15 * v.x))
        return command

    def height_of(self, truth):
        return self.start.z - truth.pose.position.z


class GazeboFlight(FlightRig):
    """The launch file of a kind of vehicle with a pilot, who is a function from the truth to a command."""

    def __init__(self, kind, folder, server, **arguments):
        super().__init__(None, "rosflight_sim", f"gazebo_{kind}.launch.xml", folder, "sim/RC command", shows=False, environment=server,
                         gui="false", **arguments)
        self.kind, self.pilot_law, self.turn = kind, idle, 0
        self.imu = self.peer.listen(Imu, "sim/sensors/imu/data")
        self.commands = self.peer.publisher(Command, "command")
        self.peer.node.create_subscription(SimState, "sim/truth_state", self.command, 10)

    def command(self, truth):
        self.turn += 1
        if self.turn % EVERY == 0:
            command = self.pilot_law(truth)
            command.header = truth.header
            self.commands.publish(command)

    def after(self, seconds):
        """What the truth is for so long."""
        count = len(self.truth)
        self.until(lambda: len(self.truth) >= count + seconds * HZ, f"{seconds} s of truth")
        return list(self.truth)[count:]

    def stand(self):
        """Ready to be armed. The truth is Gazebo's; the sensors measure it. @returns where it stands"""
        self.process.until("ready: ")
        # Until then time runs on without samples: in a second of the wall ten of those that a calibration has.
        self.until(lambda: self.truth, "Gazebo's truth")
        with launch("rosflight_sim", f"{self.kind}_init_firmware.launch.xml") as init:
            assert init.end() == 0, init.text() + self.process.text()[-4000:]
        self.until(lambda: self.status and self.status[-1].error_code == 0, "no error")
        count = len(self.imu)
        rest = self.after(1.0)
        assert [end.node_name for end in self.peer.node.get_publishers_info_by_topic("sim/truth_state")] == ["gazebo_dynamics"]
        assert "standalone_dynamics" not in self.peer.node.get_node_names()
        gaps = [stamp_ns(b) - stamp_ns(a) for a, b in zip(rest, rest[1:])]
        assert sorted(gaps)[len(gaps) // 2] == STEP_NS  # each of them: judge_steps, when the nodes have found each other
        weight = [m.linear_acceleration.z for m in list(self.imu)[count:]]
        assert len(weight) > HZ // 2 and sum(weight) / len(weight) == pytest.approx(-GRAVITY, abs=0.2)
        return rest[-1].pose.position


@SERVERS
def test_a_multirotor_takes_off_holds_and_lands(tmp_path, server):
    with GazeboFlight("multirotor", tmp_path, server()) as flight:
        start = flight.stand()
        flight.arm()
        hover = flight.pilot_law = Hover(start)
        flight.let_go()
        flight.until(lambda: hover.height_of(flight.truth[-1]) > 1.8, "1.8 m of height")
        flight.after(2.0)
        wrenches = flight.peer.listen(WrenchStamped, "sim/forces_and_moments")
        held = flight.after(3.0)
        assert flight.status[-1].offboard and not flight.status[-1].failsafe
        lift = [-m.wrench.force.z for m in list(wrenches)]
        heights = [hover.height_of(m) for m in held]
        aside = [math.hypot(m.pose.position.x - start.x, m.pose.position.y - start.y) for m in held]
        hover.height = -1.0  # comes down at 0.5 m/s
        flight.until(lambda: hover.height_of(flight.truth[-1]) < 0.02 and abs(flight.truth[-1].twist.linear.z) < 0.1, "touchdown")
        flight.pilot_law = idle
        flight.after(0.5)
        flight.disarm()
        rest = flight.after(1.0)
        flight.judge_errors()
        flight.judge_steps()
    assert 1.9 < min(heights) and max(heights) < 2.1 and max(aside) < 0.1, (min(heights), max(heights), max(aside))
    assert len(lift) > HZ and sum(lift) / len(lift) == pytest.approx(MASS * GRAVITY, rel=0.01)
    assert all(abs(hover.height_of(m)) < 0.01 for m in rest)
    assert abs(rest[-1].pose.orientation.x) < 0.01 and abs(rest[-1].pose.orientation.y) < 0.01  # on its feet


@SERVERS
def test_a_fixed_wing_rolls_along_the_ground(tmp_path, server):
    with GazeboFlight("fixedwing", tmp_path, server()) as flight:
        start = flight.stand()
        flight.arm()

        def roll(truth):
            command = idle(truth)
            command.u[0] = 0.5
            return command
        flight.pilot_law = roll
        held = flight.after(1.0)[-1].pose.position  # by the pilot's switch
        flight.let_go()
        flight.until(lambda: flight.truth[-1].pose.position.x > start.x + 5.0, "5 m along the ground")
        count = len(flight.truth)
        flight.pilot_law = idle
        flight.disarm()
        flight.judge_errors()
        flight.judge_steps()
    assert math.hypot(held.x - start.x, held.y - start.y) < 0.01
    rolled = [m.pose.position for m in flight.truth[:count]]
    assert all(abs(p.y - start.y) < 0.1 and abs(p.z - start.z) < 0.02 for p in rolled)  # straight, on its wheels
    assert flight.truth[count - 1].twist.linear.x > 3.0


PLATFORM = """    <model name="platform"><static>true</static><pose>0 0 0.5 0 0 0</pose>
      <link name="link"><collision name="box"><geometry><box><size>4 4 1</size></box></geometry></collision></link></model>
  </world>"""


@SERVERS
@pytest.mark.parametrize("kind, vehicle", [("multirotor", "multirotor"), ("fixedwing", "anaconda")])
def test_a_world_of_ones_own_has_the_vehicle_where_it_says(tmp_path, server, kind, vehicle):
    """On a platform of 1 m; in the project's world it stands on the ground."""
    variables = server()
    file = world(tmp_path / "a world.sdf", vehicle=ROOT / f"vehicles/{vehicle}.yaml")
    text = file.read_text()
    height_m = float(re.search(r"<pose>0 0 (\S+) 0 0 1\.57", text)[1])
    raised = text.replace(f"<pose>0 0 {height_m:.9g} 0 0 ", f"<pose>0 0 {height_m + 1.0} 0 0 ").replace("  </world>", PLATFORM)
    assert raised.count(f"<pose>0 0 {height_m + 1.0} ") == 1
    file.write_text(raised)
    with GazeboFlight(kind, tmp_path, variables, world_file=file) as flight:
        flight.process.until("ready: ")
        rest = flight.after(2.0)[-1]
        # Our ground gives way by 5 mm and 1 cm, which is in the height of the world that is made; Gazebo's does not.
        assert -rest.pose.position.z == pytest.approx(1.0 + height_m, abs=0.015)
        assert abs(rest.twist.linear.z) < 0.01


@pytest.mark.parametrize("file", ["gazebo_multirotor", "gazebo_fixedwing", "multirotor_gazebo", "fixedwing_gazebo"])
def test_a_world_file_that_is_missing_is_refused_with_one_line(tmp_path, file):
    missing = tmp_path / "no such.sdf"
    ports = {"simulation_port": free_udp_port(), "ROS_port": free_udp_port()}
    with launch("rosflight_sim", f"{file}.launch.xml", world_file=missing, memory_folder=tmp_path, **ports) as world_:
        assert world_.end() == 2, world_.text()
        assert world_.lines[-1].startswith("launch: gazebo (")
        assert f"world_file: found {missing}, allowed a file that is there (SDF)" in world_.lines[-1]
