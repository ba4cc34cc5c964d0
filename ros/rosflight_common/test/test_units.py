# SPDX-License-Identifier: BSD-3-Clause
"""The C++ tests of this package, one case a test."""

import pytest
from ros_units import names, run

PACKAGE = "rosflight_common"


@pytest.mark.parametrize("name", names(PACKAGE))
def test_unit(name):
    run(PACKAGE, name)
