# SPDX-License-Identifier: BSD-3-Clause
"""rclpy for all tests that need it, on this machine only. ./rosflight ros test chooses the domain."""

import os

import pytest
import rclpy

os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["ROS_LOCALHOST_ONLY"] = "1"  # for Humble, which does not know the line above
os.environ.setdefault("ROS_DOMAIN_ID", str(os.getpid() % 100 + 1))


@pytest.fixture(scope="session", autouse=True)
def ros():
    rclpy.init()
    yield
    rclpy.try_shutdown()
