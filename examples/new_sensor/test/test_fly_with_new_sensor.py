# SPDX-License-Identifier: BSD-3-Clause
"""The example as a user flies it, and its size as its page says it: one class, one line of registration, one topic."""
import os
import re
import subprocess
from pathlib import Path

import numpy as np
from mcap_ros2.reader import read_ros2_messages

ROOT = Path(__file__).parents[3]
BUILD = Path(os.environ.get("ROSFLIGHT_BUILD", ROOT / "build" / "release"))
PLUGIN = BUILD / "examples" / "new_sensor" / "libnew_sensor.so"
EXAMPLE = ROOT / "examples" / "new_sensor"
SOURCE = EXAMPLE / "nose_range.cpp"
PAGE = ROOT / "docs" / "simulation" / "new-sensor.md"
WALL_NORTH_M = 12.0
LEVER_M = 0.2


def fly(folder, *arguments):
    done = subprocess.run([BUILD / "apps" / "rosflight", "fly", "--mission", "hop", "--out", folder, *arguments], cwd=ROOT,
                          capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return next(folder.glob("*.mcap"))


def topics(log):
    return {message.channel.topic for message in read_ros2_messages(str(log))}


def test_the_topic_has_the_distance_that_the_truth_gives(tmp_path):
    log = fly(tmp_path / "f", "--plugin", PLUGIN, "--vehicle", EXAMPLE / "nose_range.yaml", "--world", EXAMPLE / "wall.sdf",
              "--log", "full")
    states, ranges = {}, []
    for message in read_ros2_messages(str(log), topics=["/sim/truth_state", "/ahead/range"]):
        stamp = message.ros_msg.header.stamp
        time_ns = stamp.sec * 1_000_000_000 + stamp.nanosec
        if message.channel.topic == "/ahead/range":
            ranges.append((time_ns, message.ros_msg))
        else:
            states[time_ns] = message.ros_msg
    assert len(ranges) > 200
    compared = 0
    for time_ns, message in ranges:
        assert message.header.frame_id == "ahead" and abs(message.max_range - 20.0) < 1e-6
        if time_ns not in states:
            continue
        pose = states[time_ns].pose
        q = pose.orientation
        north = 1.0 - 2.0 * (q.y * q.y + q.z * q.z)  # of the nose
        down = 2.0 * (q.x * q.z - q.w * q.y)
        expected = (WALL_NORTH_M - pose.position.x) / north - LEVER_M
        height = -pose.position.z - (expected + LEVER_M) * down
        if height < 0.1:  # the nose points to the ground in front of the wall
            continue
        assert abs(message.range - expected) < 1e-4
        compared += 1
    assert compared > 200


def test_it_adds_one_topic_to_the_log(tmp_path):
    without = topics(fly(tmp_path / "without"))
    with_it = topics(fly(tmp_path / "with", "--plugin", PLUGIN, "--vehicle", EXAMPLE / "nose_range.yaml", "--world",
                         EXAMPLE / "wall.sdf"))
    assert with_it - without == {"/ahead/range"} and without <= with_it


def test_the_page_counts_its_files_and_lines_and_shows_its_code():
    code = SOURCE.read_text()
    page = PAGE.read_text()
    lines = [line for line in code.splitlines() if line.strip() and not line.lstrip().startswith("//")]
    assert len(re.findall(r"^class \w+", code, re.M)) == 1
    assert len(re.findall(r"registry\.\w+\.add\(", code)) == 1
    assert f"One file, {len(lines)} lines of code: one class, one line of registration, one topic." in page
    for block in re.findall(r"```cpp\n(.*?)```", page, re.S):
        assert block.strip() in code
    assert page.count("```cpp") == 3


def test_bad_keys_and_worlds_are_one_line(tmp_path):
    broken = tmp_path / "torus.sdf"
    broken.write_text((EXAMPLE / "wall.sdf").read_text().replace("<box><size>40 1 20</size></box>", "<torus/>"))
    for words, said in [
            (["--set", "world_sensors.ahead.max_m=-1"], "world_sensors.ahead.max_m: found -1, allowed a number > 0"),
            (["--set", "world_sensors.ahead.rate_Hz=1000"], "rate_Hz: found 1000, allowed a number up to 400"),
            (["--set", "world_sensors.ahead.type=sonar"], "type: found sonar, allowed depth_camera, lidar, motion_capture, nose_range"),
            (["--world", broken], "torus.sdf:10: world, model wall, link link, collision bricks, geometry: found torus, allowed box"),
            (["--world", tmp_path / "none.sdf"], "none.sdf: found no such file")]:
        done = subprocess.run([BUILD / "apps" / "rosflight", "fly", "--plugin", PLUGIN, "--vehicle", EXAMPLE / "nose_range.yaml",
                               "--out", tmp_path / "f", *words], cwd=ROOT, capture_output=True, text=True)
        assert (done.returncode, done.stderr.count("\n")) == (2, 1) and said in done.stderr, done.stderr
        assert not (tmp_path / "f").exists()


def test_numbers_of_the_example_are_those_of_its_files():
    vehicle = (EXAMPLE / "nose_range.yaml").read_text()
    assert f"position_m: [{LEVER_M}, 0, 0]" in vehicle
    pose, size = (np.array(text.split(), dtype=float) for text in re.search(
        r"<pose>(.*?)</pose>.*<size>(.*?)</size>", (EXAMPLE / "wall.sdf").read_text(), re.S).groups())
    assert pose[1] - size[1] / 2 == WALL_NORTH_M
