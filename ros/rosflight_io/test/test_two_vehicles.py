# SPDX-License-Identifier: BSD-3-Clause
"""Two vehicles in two namespaces on one machine do not receive each other's messages."""

import pytest
from ros_rig import Rig, wait_for
from rosflight_msgs.msg import Command, Status
from rosflight_msgs.srv import ParamGet, ParamSet

NAMES = ("/alpha", "/beta")


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    rigs = []
    try:
        for name in NAMES:
            rigs.append(Rig(tmp_path_factory.mktemp(name.strip("/")), namespace=name))
        yield rigs
    finally:
        for rig in rigs:
            rig.close()


def test_parameters_and_commands_reach_one_only(pair):
    for rig, value in zip(pair, (0.25, 0.5)):
        assert rig.peer.call(ParamSet, "param_set", name="PID_ROLL_RATE_P", value=value).exists
    for rig, value in zip(pair, (0.25, 0.5)):
        assert rig.peer.call(ParamGet, "param_get", name="PID_ROLL_RATE_P").value == value

    _, beta = pair
    received = [rig.peer.listen(Status, "status") for rig in pair]
    publisher = beta.peer.node.create_publisher(Command, "command", 1)
    beta.peer.node.create_timer(0.02, lambda: publisher.publish(Command(mode=Command.MODE_PASS_THROUGH)))
    wait_for(lambda: received[1] and received[1][-1][1].offboard, "beta under command")
    count = len(received[0])
    wait_for(lambda: len(received[0]) > count + 20, "states of alpha")
    assert not any(message.offboard for _, message in received[0])


def test_one_that_ends_does_not_take_the_other_along(pair):
    alpha, beta = pair
    alpha.close()
    received = beta.peer.listen(Status, "status")
    count = len(received)
    wait_for(lambda: len(received) > count + 20, "states of beta")
