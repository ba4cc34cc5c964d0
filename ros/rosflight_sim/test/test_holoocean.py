# SPDX-License-Identifier: BSD-3-Clause
"""The node that shows the truth in HoloOcean, against the stand-in engine: topics, stamps, frames, faults."""

import itertools
import json
import math
import subprocess

import pytest
from rosflight_msgs.msg import RangeFinderSensor, RGBCamera, SimState
from ros_rig import ROOT
from sensor_msgs.msg import CameraInfo, Image, LaserScan
from sim_rig import ALL, LATCHED, executable, node, stamp_ns
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage

START_NS = 100 * 10 ** 9 + 456_789  # not a whole number of microseconds
STANDIN = ROOT / "viewer/holoocean/test/standin_engine.py"
SENSORS = [
    {"sensor_type": "RGBCamera", "sensor_name": "rgb_camera_sensor", "location": [0.2, 0, 0.1],
     "configuration": {"CaptureWidth": 32, "CaptureHeight": 16}},
    {"sensor_type": "RGBCamera", "sensor_name": "slow", "Hz": 10, "configuration": {"CaptureWidth": 4, "CaptureHeight": 2}},
    {"sensor_type": "DepthCamera", "sensor_name": "depth", "configuration": {"CaptureWidth": 4, "CaptureHeight": 2}},
    {"sensor_type": "RangeFinderSensor", "sensor_name": "range_finder_sensor", "configuration": {"LaserMaxDistance": 50, "LaserCount": 6}},
    {"sensor_type": "RangeFinderSensor", "sensor_name": "ground_range_sensor", "configuration": {"LaserMaxDistance": 100, "LaserAngle": -90}}]


def behave(program, options=""):
    program.write_text(f'#!/bin/sh\nexec python3 "{STANDIN}" --record "{program.parents[3]}/record.jsonl" {options} -- "$@"\n')
    program.chmod(0o755)


@pytest.fixture
def holoocean(tmp_path, monkeypatch):
    """Package Land, whose program is the stand-in; a scenario."""
    land = tmp_path / "2.3.0" / "worlds" / "Land"
    land.mkdir(parents=True)
    (land / "config.json").write_text(json.dumps({"path": "engine", "worlds": [{"name": "Meadow", "pre_start_steps": 1}]}))
    behave(land / "engine")
    scenario = tmp_path / "scenario.json"
    scenario.write_text(json.dumps({"frames_per_sec": False, "agents": [{"agent_type": "FixedWing", "sensors": SENSORS}]}))
    monkeypatch.setenv("HOLODECKPATH", str(tmp_path))
    return scenario


def truth(time_ns, north_m, height_m, speed_m_s=0.0):
    """A vehicle with its nose to the east."""
    state = SimState()
    state.header.stamp.sec, state.header.stamp.nanosec = divmod(time_ns, 10 ** 9)
    state.pose.position.x, state.pose.position.z = float(north_m), -float(height_m)
    state.pose.orientation.w = state.pose.orientation.z = math.sqrt(0.5)  # heading east
    state.twist.linear.x = float(speed_m_s)
    return state


def shown(peer, states, topics):
    """Publishes until there is a message of each topic for each of these states."""
    out = peer.publisher(SimState, "sim/truth_state", ALL)
    before = itertools.count(1)  # tenths of a second, until the node and the peer know each other
    for topic in topics:
        peer.introduce(lambda: out.publish(truth(next(before) * 100_000_000, 0, 30)), topic, "a topic of the node")
    for topic in topics:  # what came while others were introduced
        topic.clear()
    for count, state in enumerate(states, 1):
        out.publish(state)
        peer.wait(lambda: all(len(topic) >= count for topic in topics), f"messages of state {count}")


def test_images_ranges_and_scans_carry_the_stamp_of_the_truth(peer, holoocean):
    with node("holoocean_node", scenario_file=holoocean, show_viewport="false") as process:
        process.until("the engine has loaded its world")
        old = peer.listen(RGBCamera, "rgb_camera_sensor")
        image, info = peer.listen(Image, "rgb_camera_sensor/image_raw"), peer.listen(CameraInfo, "rgb_camera_sensor/camera_info")
        depth = peer.listen(Image, "depth/image_raw")
        down, down_scan = peer.listen(RangeFinderSensor, "ground_range_sensor"), peer.listen(LaserScan, "ground_range_sensor/scan")
        around, scan = peer.listen(RangeFinderSensor, "range_finder_sensor"), peer.listen(LaserScan, "range_finder_sensor/scan")
        topics = (old, image, info, depth, down, down_scan, around, scan)
        times = [START_NS + n * 100_000_000 for n in range(5)]
        shown(peer, [truth(t, 0.0, 40 + n) for n, t in enumerate(times)], topics)
        assert [stamp_ns(message) for message in image] == times == [message.timestamp for message in old]
        assert [stamp_ns(message) for message in scan] == times
        assert (old[0].width, old[0].height, old[0].channels, len(old[0].image)) == (32, 16, 4, 32 * 16 * 4)
        assert (image[0].encoding, image[0].step, image[0].header.frame_id) == ("bgra8", 128, "rgb_camera_sensor_optical")
        assert list(image[0].data[4 * 37:4 * 37 + 2]) == [5, 1]  # column 5 of row 1
        assert list(info[0].k) == [16.0, 0.0, 15.5, 0.0, 16.0, 7.5, 0.0, 0.0, 1.0]  # 90 degrees wide
        assert stamp_ns(info[0]) == stamp_ns(image[0]) and info[0].header.frame_id == image[0].header.frame_id
        assert depth[0].encoding == "32FC1" and memoryview(bytes(depth[0].data)).cast("f")[1] == pytest.approx(20.0, abs=1e-4)
        assert [message.ranges[0] for message in down_scan] == pytest.approx([40, 41, 42, 43, 44], abs=1e-3)
        assert down_scan[0].header.frame_id == "ground_range_sensor_rays"
        assert list(down[0].distances) == pytest.approx([40], abs=1e-3)
        assert all(math.isinf(value) for value in scan[0].ranges) and set(around[0].distances) == {-1.0}
        assert scan[0].angle_increment == pytest.approx(math.pi / 3) and scan[0].range_max == 50.0


def test_a_slow_camera_carries_the_stamp_of_the_tick_of_its_picture(peer, holoocean):
    with node("holoocean_node", scenario_file=holoocean, show_viewport="false") as process:
        process.until("the engine has loaded its world")
        fast, slow = peer.listen(Image, "rgb_camera_sensor/image_raw"), peer.listen(Image, "slow/image_raw")
        times = [START_NS + n * 100_000_000 for n in range(12)]
        shown(peer, [], [fast, slow])
        shown(peer, [truth(t, 0.0, 40) for t in times], [fast])
        tick_at = {stamp_ns(image): image.data[2] for image in fast}  # the stand-in shows it as red
        assert list(tick_at) == times

        def slow_ones():
            return {stamp_ns(image): image.data[2] for image in slow if stamp_ns(image) >= START_NS}

        peer.wait(lambda: len(slow_ones()) == 4, "a third of the pictures")
        assert slow_ones() == {t: tick for t, tick in tick_at.items() if tick % 3 == 0}  # since the camera was added


def test_the_engine_gets_world_velocity_and_the_frames_are_told(peer, holoocean, tmp_path):
    with node("holoocean_node", scenario_file=holoocean, show_viewport="false") as process:
        process.until("the engine has loaded its world")
        frames = peer.listen(TFMessage, "/tf_static", LATCHED)
        down = peer.listen(LaserScan, "ground_range_sensor/scan")
        shown(peer, [truth(START_NS, 5.0, 40, speed_m_s=12.0)], [down])
        states = [event for line in (tmp_path / "record.jsonl").read_text().splitlines()
                  if (event := json.loads(line))["event"] == "state"]
        numbers = states[-1]["numbers"]
        assert numbers[6:9] == pytest.approx([0, -12, 0], abs=1e-4)  # east is -y
        assert numbers[0:3] == pytest.approx([5, 12 / 30, 40], abs=1e-4)  # one step before
        assert numbers[5] == pytest.approx(-90, abs=1e-4)
        peer.wait(lambda: frames, "the frames")
        children = {t.child_frame_id: t for t in frames[0].transforms}
        assert children["rgb_camera_sensor"].header.frame_id == "base_link"
        assert children["rgb_camera_sensor"].transform.translation.x == pytest.approx(0.2)
        turn = children["ground_range_sensor_rays"].transform.rotation
        assert (turn.w, turn.y) == pytest.approx((math.sqrt(0.5), math.sqrt(0.5)))  # x turned down


def test_reset_loads_the_level_again(peer, holoocean, tmp_path):
    with node("holoocean_node", scenario_file=holoocean, show_viewport="false") as process:
        process.until("the engine has loaded its world")
        assert peer.call(Trigger, "holoocean/holoocean_reset").success
        down = peer.listen(LaserScan, "ground_range_sensor/scan")
        shown(peer, [truth(START_NS, 0, 40)], [down])
        assert (tmp_path / "record.jsonl").read_text().count('"event": "reset"') == 2


def test_a_dead_engine_is_one_warning_and_a_reset_that_fails(peer, holoocean, tmp_path):
    behave(tmp_path / "2.3.0/worlds/Land/engine", "--die-at 6")
    with node("holoocean_node", scenario_file=holoocean, show_viewport="false") as process:
        process.until("the engine has loaded its world")
        out = peer.publisher(SimState, "sim/truth_state", ALL)
        times = itertools.count(START_NS, 100_000_000)
        said = "holoocean: its program ended with status 1; its last output: Fatal error: out of video memory"

        def died():
            out.publish(truth(next(times), 0, 40))
            return said + "; the flight goes on without it" in process.text()

        peer.poll(died, "the warning")
        answer = peer.call(Trigger, "holoocean/holoocean_reset")
        assert (answer.success, answer.message) == (False, said)


def refused(*words):
    done = subprocess.run([executable("rosflight_sim", "holoocean_node"), "--ros-args", *words], capture_output=True, text=True)
    assert done.returncode == 2
    return done.stderr.splitlines()[-1]


def test_bad_input_is_one_line_and_exit_code_2(holoocean, monkeypatch, tmp_path):
    assert refused("-p", "agent:=boat").endswith("parameter agent: found 'boat', allowed fixedwing or multirotor")
    assert refused("-p", "env:=Moon").endswith("world: found Moon, allowed Meadow, the worlds of package Land")
    holoocean.write_text(json.dumps({"weather": "rain", "agents": [{"agent_type": "UavAgent"}]}))
    assert "scenario.json:1: weather: found an unknown key, allowed " in refused("-p", f"scenario_file:={holoocean}")
    monkeypatch.setenv("HOLODECKPATH", str(tmp_path / "nowhere"))
    assert "found no HoloOcean package Land in " in refused() and "to install it, " in refused()
