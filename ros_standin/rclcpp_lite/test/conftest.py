# SPDX-License-Identifier: BSD-3-Clause
"""The peer node and an rclpy node beside it, once for each test file."""

import pytest
from ros_peer import Process, Tester, lite_program, until


@pytest.fixture(scope="module")
def peer(tester):
    with Process(lite_program("peer_node")) as process:
        # One that does not come up fails here, and not once in each test.
        until(lambda: tester.node.count_publishers("reply") or process.process.poll() is not None,
              "the peer is up")
        assert process.process.poll() is None, process.said()
        yield process


@pytest.fixture(scope="module")
def tester():
    with Tester() as tester:
        yield tester
