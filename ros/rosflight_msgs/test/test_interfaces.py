# SPDX-License-Identifier: BSD-3-Clause
"""The generated types against interfaces.csv, a table of what ROSflight 2.x has, and one message of ours."""

from pathlib import Path

import pytest
from interface_table import Table

TABLE = Table("rosflight_msgs", Path(__file__).parent / "interfaces.csv")


@pytest.mark.parametrize("name", TABLE.rows)
def test_fields_have_the_types_names_and_order_of_the_table(name):
    TABLE.check_fields(name)


@pytest.mark.parametrize("name", TABLE.rows)
def test_constants_have_the_values_of_the_table(name):
    TABLE.check_constants(name)


def test_no_interface_is_missing_in_the_table():
    TABLE.check_complete(messages=16, services=4)
