# SPDX-License-Identifier: BSD-3-Clause
"""roscopter_gcs.launch.xml under the name that ROSflight 2.x gives it."""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch_xml.launch_description_sources import XMLLaunchDescriptionSource


def generate_launch_description():
    data = Path(__file__).with_suffix(".xml")
    return LaunchDescription([IncludeLaunchDescription(XMLLaunchDescriptionSource(str(data)))])
