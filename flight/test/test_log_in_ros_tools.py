# SPDX-License-Identifier: BSD-3-Clause
"""What tools that do not know ROSflight draw of a log: frames, poses, positions on the globe, the vehicle. Compared with the
truth in the same log by formulas that are written down here, not by ours."""

import json
import math
import os
import re
import subprocess
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = ROOT / os.environ.get("ROSFLIGHT_BUILD", "build/release") / "apps" / "rosflight"
LAYOUT = ROOT / "docs" / "foxglove" / "rosflight.json"
EVERY = {"/sim/truth_state": 10, "/tf_static": 1, "/autonomy/estimate": 1, "/autonomy/path": 1, "/robot_description": 1,
         "/tf": 2, "/sim/pose": 1, "/sim/odometry": 1, "/autonomy/odometry": 1, "/gnss/fix": 1, "/gnss": 1}
STANDARD = {"/tf": 20, "/sim/pose": 10, "/sim/odometry": 5, "/autonomy/odometry": 5, "/gnss/fix": 10}  # Hz
ENU = np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, -1]])
FLU = np.diag([1.0, -1, -1])
# WGS-84 (NIMA TR8350.2, 3rd edition, table 3.1) and its radii of curvature.
SEMI_MAJOR_M, ECCENTRICITY_SQ = 6378137.0, 6.69437999014e-3


class Log:
    """Messages of the topics that are compared, and every fiftieth of the others."""

    def __init__(self, folder):
        self.folder = folder
        decoders, factory = {}, DecoderFactory()
        self.vehicle = yaml.safe_load((folder / "vehicle.yaml").read_text())
        self.messages = {}  # topic -> [(time in ns, message)]
        with (folder / "flight.mcap").open("rb") as file:
            for schema, channel, record in make_reader(file).iter_messages():
                if record.sequence % EVERY.get(channel.topic, 50):
                    continue
                if schema.id not in decoders:
                    decoders[schema.id] = factory.decoder_for("cdr", schema)
                self.messages.setdefault(channel.topic, []).append((record.log_time, decoders[schema.id](record.data)))

    def pairs(self, topic, other):
        """Messages of two topics with the same time."""
        by_time = dict(self.messages[other])
        found = [(message, by_time[t]) for t, message in self.messages[topic] if t in by_time]
        assert len(found) > 150, (topic, len(found))
        return found


@pytest.fixture(scope="module", params=["multirotor", "anaconda"])
def log(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("fly") / request.param
    subprocess.run([PROGRAM, "fly", "--vehicle", request.param, "--out", folder], check=True, capture_output=True, timeout=300)
    return Log(folder)


def numbers(v):
    return np.array([v.x, v.y, v.z])


def rotation(q):
    w, x, y, z = q.w, q.x, q.y, q.z
    assert math.isclose(w * w + x * x + y * y + z * z, 1.0, abs_tol=1e-9)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def headers(message):
    if hasattr(message, "header"):
        yield message.header
    for one in getattr(message, "transforms", None) or getattr(message, "poses", None) or []:
        yield from headers(one)


def test_every_header_names_a_frame_of_the_tree(log):
    frames = {"map"} | {edge.child_frame_id for topic in ("/tf", "/tf_static") for edge in log.messages[topic][0][1].transforms}
    assert frames == {"map", "odom", "NED", "body", "base_link"}
    for topic, found in log.messages.items():
        for _, message in found:
            assert {header.frame_id for header in headers(message)} <= frames, topic


def test_standard_topics_have_their_rate(log):
    seconds = len(log.messages["/sim/truth_state"]) * EVERY["/sim/truth_state"] / 100
    for topic, rate in STANDARD.items():
        count = len(log.messages[topic]) * EVERY[topic]
        assert 0.7 * rate * seconds < count < 1.05 * rate * seconds + 2, topic


def test_poses_are_the_truth_in_east_north_up(log):
    for topic, pose_of in (("/sim/pose", lambda m: m.pose), ("/sim/odometry", lambda m: m.pose.pose)):
        for message, truth in log.pairs(topic, "/sim/truth_state"):
            pose = pose_of(message)
            assert np.array_equal(numbers(pose.position), ENU @ numbers(truth.pose.position))
            assert np.allclose(rotation(pose.orientation), ENU @ rotation(truth.pose.orientation) @ FLU, atol=1e-9)
    for message, truth in log.pairs("/sim/odometry", "/sim/truth_state"):
        assert np.array_equal(numbers(message.twist.twist.linear), FLU @ numbers(truth.twist.linear))
        assert np.array_equal(numbers(message.twist.twist.angular), FLU @ numbers(truth.twist.angular))


def test_the_tree_leads_to_the_same_pose(log):
    fixed = {(edge.header.frame_id, edge.child_frame_id): rotation(edge.transform.rotation)
             for edge in log.messages["/tf_static"][0][1].transforms}
    to_map = fixed["map", "odom"] @ fixed["odom", "NED"]
    for message, pose in log.pairs("/tf", "/sim/pose"):
        (edge,) = message.transforms
        assert (edge.header.frame_id, edge.child_frame_id) == ("NED", "body")
        assert np.allclose(to_map @ numbers(edge.transform.translation), numbers(pose.pose.position), atol=1e-9)
        attitude = to_map @ rotation(edge.transform.rotation) @ fixed["body", "base_link"]
        assert np.allclose(attitude, rotation(pose.pose.orientation), atol=1e-9)


def test_odometry_of_the_estimate_is_the_estimate(log):
    for message, estimate in log.pairs("/autonomy/odometry", "/autonomy/estimate"):
        assert np.allclose(numbers(message.pose.pose.position), ENU @ estimate.position, atol=1e-12)
        cov = np.array(message.pose.covariance).reshape(6, 6)
        assert np.allclose(cov, cov.T, atol=1e-12) and np.linalg.eigvalsh(cov).min() > 0
        assert np.allclose(np.diag(cov)[:3], (ENU @ np.array(estimate.position_sigma)) ** 2, rtol=1e-9)
        attitude = rotation(message.pose.pose.orientation)
        assert np.allclose(attitude @ numbers(message.twist.twist.linear), ENU @ estimate.velocity, atol=1e-5)


def test_a_fix_is_where_the_truth_is_on_the_globe(log):
    origin = log.vehicle["environment"]["origin"]
    lat0 = math.radians(origin["latitude_deg"])
    w = math.sqrt(1 - ECCENTRICITY_SQ * math.sin(lat0) ** 2)
    meridian, normal = SEMI_MAJOR_M * (1 - ECCENTRICITY_SQ) / w**3, SEMI_MAJOR_M / w
    truth = log.messages["/sim/truth_state"]
    times = np.array([t for t, _ in truth])
    errors = []
    for (_, fix), (_, gnss) in zip(log.messages["/gnss/fix"], log.messages["/gnss"], strict=True):
        assert (fix.latitude, fix.longitude, fix.altitude) == (gnss.lat, gnss.lon, gnss.alt)
        assert (fix.header.stamp.sec, fix.header.stamp.nanosec) == (gnss.header.stamp.sec, gnss.header.stamp.nanosec)
        assert fix.status.status == 0 and fix.position_covariance_type == 1
        at = np.searchsorted(times, fix.header.stamp.sec * 10**9 + fix.header.stamp.nanosec)
        north, east, down = numbers(truth[min(at, len(truth) - 1)][1].pose.position)
        height = origin["altitude_m"] - down
        lat = origin["latitude_deg"] + math.degrees(north / (meridian + height))
        lon = origin["longitude_deg"] + math.degrees(east / ((normal + height) * math.cos(math.radians(lat))))
        errors.append((math.radians(fix.latitude - lat) * meridian, math.radians(fix.longitude - lon) * normal * math.cos(lat0),
                       fix.altitude - height))
    rms = np.sqrt(np.mean(np.square(errors), axis=0))
    assert (rms < (3.0, 3.0, 6.0)).all(), rms  # what the simulated receiver errs by


def test_the_description_is_the_geometry_of_the_vehicle_file(log):
    robot = ET.fromstring(log.messages["/robot_description"][0][1].data)
    links = {link.get("name"): link for link in robot.iter("link")}
    assert float(links["base_link"].find("inertial/mass").get("value")) == log.vehicle["body"]["mass_kg"]
    origins = {joint.find("child").get("link"): joint.find("origin") for joint in robot.iter("joint")}
    assert origins.keys() == links.keys() - {"base_link"}
    rotors = log.vehicle["rotors"]["layout"]
    for k, rotor in enumerate(rotors):
        origin = origins[f"rotor_{k}"]
        assert np.allclose([float(x) for x in origin.get("xyz").split()], FLU @ rotor["position_m"], atol=1e-6)
        roll, pitch, _ = (float(x) for x in origin.get("rpy").split())
        axis = [math.cos(roll) * math.sin(pitch), -math.sin(roll), math.cos(roll) * math.cos(pitch)]
        assert np.allclose(axis, FLU @ rotor["thrust_direction"], atol=1e-5)
        radius = float(links[f"rotor_{k}"].find("visual/geometry/cylinder").get("radius"))
        assert math.isclose(2 * radius, log.vehicle["rotors"]["propeller"]["diameter_m"], rel_tol=1e-5)
    ground = log.vehicle["ground"]
    assert f"rotor_{len(rotors)}" not in links and len(ground["contacts_m"]) + len(ground.get("wheels_m", [])) == sum("contact" in x for x in links)
    if log.vehicle["type"] == "fixedwing":
        chord, span, _ = (float(x) for x in links["wing"].find("visual/geometry/box").get("size").split())
        wing = log.vehicle["aero"]["wing"]
        assert (chord, span) == (wing["chord_m"], wing["span_m"])
        length, width, height = (float(x) for x in links["base_link"].find("visual/geometry/box").get("size").split())
        assert max(width, height) < chord < length  # a fuselage, not all between the tips
    else:
        assert "wing" not in links


def test_the_path_leads_past_the_waypoints(log):
    paths = [message for _, message in log.messages["/autonomy/path"]]
    points = np.array([numbers(pose.pose.position) for path in paths for pose in path.poses])
    waypoints = [ENU @ item["w"] for item in yaml.safe_load((log.folder / "mission.yaml").read_text())["mission"]]
    if log.vehicle["type"] == "multirotor":
        assert np.allclose(points, waypoints)
    truth = np.array([numbers(m.pose.position) for _, m in log.messages["/sim/pose"]])
    for corner in points[:: max(1, len(points) // 20)]:
        assert np.linalg.norm(truth[:, :2] - corner[:2], axis=1).min() < 25.0


def value_at(message, path):
    for name, index in re.findall(r"\.(\w+)(?:\[(\d+)\])?", path):
        message = getattr(message, name)
        if index:
            message = message[int(index)]
    return message


def test_the_layout_names_only_what_a_log_has(log):
    layout = json.loads(LAYOUT.read_text())
    panels = layout["configById"]

    def shown(node):
        return [node] if isinstance(node, str) else shown(node["first"]) + shown(node["second"])

    assert sorted(shown(layout["layout"])) == sorted(panels)
    assert {name.split("!")[0] for name in panels} == {"3D", "map", "Plot", "RosOut"}
    frames = {"map", "odom", "NED", "body", "base_link"}
    scene = panels["3D!scene"]
    assert {scene["followTf"], scene["fixedFrame"], *(key.removeprefix("frame:") for key in scene["transforms"])} <= frames
    topics = {*scene["topics"], scene["layers"]["vehicle"]["topic"], panels["map!track"]["followTopic"],
              panels["RosOut!texts"]["topicToRender"]}
    assert topics <= log.messages.keys()
    values = [path["value"] for name, panel in panels.items() if name.startswith("Plot") for path in panel["paths"]]
    assert len(values) >= 10
    for value in values:
        topic, path = re.fullmatch(r"(/[\w/]+)((?:\.\w+(?:\[\d+\])?)+)", value).groups()
        assert isinstance(value_at(log.messages[topic][-1][1], path), (int, float)), value
