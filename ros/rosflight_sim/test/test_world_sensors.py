# SPDX-License-Identifier: BSD-3-Clause
"""Sensors of the world as topics of standalone_sensors: values by hand, stamps of the measured truth, frames."""

import math
import struct

import pytest
from geometry_msgs.msg import PoseStamped
from rosflight_msgs.msg import SimState
from ros_rig import ROOT
from sensor_msgs.msg import CameraInfo, Image, LaserScan
from sim_rig import LATCHED, VEHICLE, node, sim_state, stamp_ns
from tf2_msgs.msg import TFMessage

TICK_NS = 2_500_000
START_NS = 100_000_000_000
FIELD = ROOT / "flight/gazebo/test/worlds/field.sdf"
SENSORS = ("world_sensors={scan: {type: lidar, rays: 3, angle_min_deg: -90, angle_max_deg: 90, max_m: 60}, "
           "depth: {type: depth_camera, width_px: 3, height_px: 3, position_m: [1, 0, 0]}, "
           "mocap: {type: motion_capture, delay_us: 50000}}")
HEIGHT_M = 2.0


@pytest.fixture
def received(peer):
    with node("standalone_sensors", at_launch="standalone_sensors", vehicle_file=VEHICLE, world_file=FIELD,
              vehicle_overrides=f'["{SENSORS}"]'):
        topics = {topic: peer.listen(kind, topic) for topic, kind in [
            ("scan/scan", LaserScan), ("depth/image_raw", Image), ("depth/camera_info", CameraInfo), ("mocap/pose", PoseStamped)]}
        topics["/tf_static"] = peer.listen(TFMessage, "/tf_static", LATCHED)
        truth = peer.publisher(SimState, "sim/truth_state")
        ns = START_NS

        def send():
            nonlocal ns
            ns += TICK_NS
            truth.publish(sim_state(ns, z=-HEIGHT_M))
        peer.poll(lambda: send() or all(topics.values()), "a message of each topic")
        yield topics


def test_a_scan_has_mast_house_and_nothing(received):
    scan = received["scan/scan"][-1]
    right, ahead, left = scan.ranges  # angles from -90 degrees, which is to the right
    assert right == pytest.approx(29.8, abs=1e-4) and ahead == pytest.approx(20.0, abs=1e-4) and left == math.inf
    assert scan.header.frame_id == "scan" and scan.angle_min == pytest.approx(-math.pi / 2)
    assert (stamp_ns(scan) - START_NS) % TICK_NS == 0


def test_a_depth_image_has_the_wall_in_its_middle(received):
    image, info = received["depth/image_raw"][-1], received["depth/camera_info"][-1]
    assert (image.encoding, image.width, image.height, image.step) == ("32FC1", 3, 3, 12)
    assert image.header.frame_id == info.header.frame_id == "depth_optical"
    assert struct.unpack_from("<f", image.data, 16)[0] == pytest.approx(19.0, abs=1e-4)
    assert info.k[0] == pytest.approx(1.5 / math.tan(math.radians(43.5))) and info.k[2] == 1.0


def test_a_pose_is_late_and_stamped_with_its_measurement(received):
    pose = received["mocap/pose"][-1]
    assert pose.header.frame_id == "map"
    assert pose.pose.position.z == pytest.approx(HEIGHT_M)
    assert (stamp_ns(pose) - START_NS) % TICK_NS == 0


def test_frames_of_mounted_sensors_are_below_the_body(received):
    edges = {(t.header.frame_id, t.child_frame_id) for message in received["/tf_static"] for t in message.transforms}
    assert {("aircraft_body", "scan"), ("aircraft_body", "depth"), ("depth", "depth_optical")} <= edges
