# SPDX-License-Identifier: BSD-3-Clause
"""The peer node and an rclpy node beside it, once for each test file."""

import pytest
from ros_peer import Process, Tester, lite_program


@pytest.fixture(scope="module")
def peer():
    with Process(lite_program("peer_node")) as process:
        yield process


@pytest.fixture(scope="module")
def tester():
    with Tester() as tester:
        yield tester
