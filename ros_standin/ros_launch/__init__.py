# SPDX-License-Identifier: BSD-3-Clause
"""Runs launch files of the XML front end of ROS 2 where `ros2 launch` is missing; see README.md."""
