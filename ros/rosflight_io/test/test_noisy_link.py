# SPDX-License-Identifier: BSD-3-Clause
"""A cable of 921600 baud on which every hundredth byte is damaged."""

import math

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from ros_rig import SIL_TOOLS, Rig, wait_for
from rosflight_msgs.msg import Attitude, Command, OutputRaw, Status
from rosflight_msgs.srv import ParamGet, ParamSet

NOISE = ["--corrupt", "0.01"]
ECHO = SIL_TOOLS / "sil_echo"
ASKED, ANSWERED = 9, 13  # firmware/boards/common/echo_main.hpp
PERIOD_S = 0.08  # OFFBOARD_TIMEOUT is 0.1


@pytest.fixture(scope="module")
def noisy(tmp_path_factory):
    rig = Rig(tmp_path_factory.mktemp("noisy"), kind="cable", cable_options=NOISE)
    yield rig
    rig.close()


def test_parameters_arrive_all_the_same(noisy):
    for value in (0.125, 0.25, 0.375):
        assert noisy.peer.call(ParamSet, "param_set", name="PID_ROLL_RATE_P", value=value).exists
        assert noisy.peer.call(ParamGet, "param_get", name="PID_ROLL_RATE_P").value == value


def test_bad_frames_are_counted_and_none_is_taken_for_good(noisy):
    received = noisy.peer.listen(Attitude, "attitude")
    diagnostics = noisy.peer.listen(DiagnosticArray, "/diagnostics")
    wait_for(lambda: len(received) > 500 and len(diagnostics) > 2, "a lot of frames")
    for _, message in received:
        q = message.attitude
        assert abs(math.sqrt(q.w ** 2 + q.x ** 2 + q.y ** 2 + q.z ** 2) - 1.0) < 1e-3, message
    values = {entry.key: entry.value for status in diagnostics[-1][1].status for entry in status.values}
    assert int(values["frames dropped"]) > 10 and int(values["sequence gaps"]) > 10, values


def test_gaps_hand_over_and_frames_take_over_again(tmp_path):
    """Only the way to the board is noisy, so its answers tell which commands it took. Nearly half are damaged, and one
    that is missing leaves a gap longer than the timeout. flight_noisy_link_test holds every pass to it in lock-step."""
    rig = Rig(tmp_path, kind="cable", cable_options=[*NOISE, "--one-way"], program=ECHO)
    try:
        answers, states = rig.peer.listen(OutputRaw, "output_raw"), rig.peer.listen(Status, "status")
        publisher = rig.peer.node.create_publisher(Command, "command", 1)
        sent = []

        def publish():
            command = Command(mode=Command.MODE_PASS_THROUGH)
            sent.append(len(sent) + 1)
            command.u[ASKED] = float(sent[-1])
            publisher.publish(command)
        rig.peer.node.create_timer(PERIOD_S, publish)
        wait_for(lambda: len(sent) >= 200, "200 commands")
    finally:
        rig.close()
    numbers = [int(message.values[ANSWERED]) for _, message in answers if message.values[ANSWERED] != 0.0]
    assert numbers == sorted(set(numbers)) and set(numbers) <= set(sent), "a frame that was never sent"
    assert 0.2 < len(numbers) / len(sent) < 0.9
    followed = [message.offboard for _, message in states]
    recoveries = sum(now and not before for before, now in zip(followed, followed[1:]))
    assert recoveries >= 5, followed
