# SPDX-License-Identifier: BSD-3-Clause
"""The generated types against interfaces.csv, a table of what rosplane of ROSflight 2.x has, and two messages of ours."""

from pathlib import Path

import pytest
from ament_index_python.packages import get_package_share_path
from interface_table import Table

TABLE = Table("rosplane_msgs", Path(__file__).parent / "interfaces.csv")


@pytest.mark.parametrize("name", TABLE.rows)
def test_fields_have_the_types_names_and_order_of_the_table(name):
    TABLE.check_fields(name)


@pytest.mark.parametrize("name", TABLE.rows)
def test_constants_have_the_values_of_the_table(name):
    TABLE.check_constants(name)


def test_no_interface_is_missing_in_the_table():
    TABLE.check_complete(messages=7, services=1)


def test_users_of_the_package_find_sensor_msgs_through_it():
    """rosplane_sim of ROSflight 2.x includes messages of both and names only this one to CMake."""
    exports = get_package_share_path("rosplane_msgs") / "cmake/export_rosplane_msgs__rosidl_generator_cppExport.cmake"
    assert "sensor_msgs::sensor_msgs__rosidl_generator_cpp" in exports.read_text()
