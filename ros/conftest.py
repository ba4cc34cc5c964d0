# SPDX-License-Identifier: BSD-3-Clause
import os

import pytest
import rclpy

os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["ROS_LOCALHOST_ONLY"] = "1"  # for Humble, which does not know the line above
os.environ["ROS_DOMAIN_ID"] = str(os.getpid() % 100 + 1)


@pytest.fixture(scope="session", autouse=True)
def ros():
    rclpy.init()
    yield
    rclpy.try_shutdown()


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    from ros_rig import Rig
    rig = Rig(tmp_path_factory.mktemp("io"))
    yield rig
    rig.close()
