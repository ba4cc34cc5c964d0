# SPDX-License-Identifier: BSD-3-Clause
"""What viz shows of an attitude and a field."""

import math
import subprocess
from pathlib import Path

import pytest
from geometry_msgs.msg import PoseStamped
from ros_launch.packages import Packages
from ros_launch.reader import Reader
from ros_rig import Peer, program, stop, wait_for
from rosflight_msgs.msg import Attitude
from sensor_msgs.msg import MagneticField
from visualization_msgs.msg import Marker


@pytest.fixture(scope="module")
def viz():
    process = subprocess.Popen([str(program("rosflight_gcs", "viz")), "--ros-args", "-r", "__ns:=/red"])
    peer = Peer("/red")
    yield peer
    peer.close()
    assert stop(process) == 0


def publish_until(peer, kind, topic, message, received):
    publisher = peer.node.create_publisher(kind, topic, 1)
    timer = peer.node.create_timer(0.05, lambda: publisher.publish(message))
    wait_for(lambda: received, f"an answer to {topic}")
    peer.node.destroy_timer(timer)


def test_attitude_is_shown_as_it_is(viz):
    received = viz.listen(PoseStamped, "viz/attitude")
    attitude = Attitude()
    attitude.header.stamp.sec = 7
    attitude.attitude.w, attitude.attitude.y = 0.8, 0.6
    publish_until(viz, Attitude, "attitude", attitude, received)
    pose = received[0][1]
    assert pose.header.frame_id == "fixed_frame" and pose.header.stamp.sec == 7
    assert (pose.pose.orientation.w, pose.pose.orientation.y) == (0.8, 0.6)


def rotated_x_axis(q):
    return (1 - 2 * (q.y ** 2 + q.z ** 2), 2 * (q.x * q.y + q.w * q.z), 2 * (q.x * q.z - q.w * q.y))


def test_arrow_points_along_the_field_and_samples_become_points(viz):
    arrows, clouds = viz.listen(PoseStamped, "viz/magnetometer"), viz.listen(Marker, "viz/cloud")
    field = MagneticField()
    field.magnetic_field.x, field.magnetic_field.y, field.magnetic_field.z = 2e-5, -1e-5, 4e-5
    publish_until(viz, MagneticField, "magnetometer", field, clouds)
    norm = math.sqrt(4 + 1 + 16)
    assert rotated_x_axis(arrows[0][1].pose.orientation) == pytest.approx((2 / norm, -1 / norm, 4 / norm), abs=1e-9)
    cloud = clouds[0][1]
    assert cloud.type == Marker.POINTS and cloud.header.frame_id == "fixed_frame"
    point = cloud.points[0]
    assert (point.x, point.y, point.z) == pytest.approx((2.0, -1.0, 4.0))


@pytest.mark.parametrize("name", ["viz_att", "viz_mag"])
def test_a_launch_file_starts_the_node(name):
    """Programs and files are looked for when the file is read."""
    file = Path(__file__).resolve().parents[1] / f"launch/{name}.launch.xml"
    assert "rosflight_gcs/viz" in {node.what for node in Reader(Packages.of_environment(), {"gui": "false"}, {}).read(file).nodes}
