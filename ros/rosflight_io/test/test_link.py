# SPDX-License-Identifier: BSD-3-Clause
"""What happens when the link, the firmware or a publisher misbehaves; and bad command lines."""

import math
import signal
import subprocess
import time

import pytest
from ros_rig import NODE, TIMEOUT_S, Rig, start_ready, wait_for
from rclpy.qos import QoSProfile
from rosflight_msgs.msg import AuxCommand, Command, Status
from std_msgs.msg import Bool
from std_srvs.srv import Trigger


@pytest.fixture(scope="module")
def status(rig):
    return rig.peer.listen(Status, "status")


@pytest.fixture(scope="module")
def command(rig):
    publisher = rig.peer.node.create_publisher(Command, "command", QoSProfile(depth=1))
    wait_for(lambda: publisher.get_subscription_count() > 0, "the node's subscription")
    return publisher


def offboard_after(status, publish, seconds):
    """Whether the firmware follows, after publishing at 50 Hz for a while."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        publish()
        time.sleep(0.02)
    wait_for(lambda: status, "a status")
    return status[-1][1].offboard


def test_commands_reach_the_firmware_and_time_out(status, command):
    good = Command(mode=Command.MODE_ROLL_PITCH_YAWRATE_THROTTLE)
    good.u[2] = 0.3
    wait_for(lambda: (command.publish(good), status and status[-1][1].offboard)[1], "offboard control")
    wait_for(lambda: not status[-1][1].offboard, "the timeout")


@pytest.mark.parametrize("make", [
    lambda: Command(mode=2, u=[0.0, 0.0, math.nan, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    lambda: Command(mode=2, u=[0.0, 0.0, 0.0, math.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    lambda: Command(mode=77),
    lambda: Command(mode=2, ignore=0xFFFF),
], ids=["NaN", "infinity", "mode", "mask"])
def test_nonsense_is_refused_with_a_warning_and_reaches_nothing(rig, status, command, make):
    wait_for(lambda: status and not status[-1][1].offboard, "no offboard control")
    told = len([line for line in rig.io.lines if "command not sent" in line])
    assert not offboard_after(status, lambda: command.publish(make()), 0.5)
    time.sleep(1.2)  # the warning is throttled
    command.publish(make())
    wait_for(lambda: len([line for line in rig.io.lines if "command not sent" in line]) > told, "a warning")


def test_bytes_that_are_no_message_do_not_stop_the_node(rig, status, command):
    for data in (b"", b"\x00", b"\x00\x01\x00\x00", b"\x00\x01\x00\x00" + b"\xff" * 9):
        command.publish(data)
    aux = rig.peer.node.create_publisher(AuxCommand, "aux_command", 1)
    aux.publish(AuxCommand(type_array=[9] * 14))
    count = len(status)
    wait_for(lambda: len(status) > count + 5, "status going on")
    assert rig.io.process.poll() is None


def test_reboot_answers_when_the_firmware_is_back(rig):
    restarted = rig.peer.listen(Bool, "status/restarted")
    answer = rig.peer.call(Trigger, "reboot")
    assert answer.success, answer.message
    assert [message.data for _, message in restarted] == [True]


def test_firmware_that_dies_is_reported_and_found_again(rig, status):
    rig.sil.stop(signal.SIGKILL)
    rig.io.wait_line("silent")
    rig.sil.start()
    count = len(status)
    wait_for(lambda: len(status) > count + 10, "status of the new firmware")
    wait_for(lambda: rig.peer.call(Trigger, "all_params_received").success, "all parameters")


def test_node_that_dies_can_be_started_anew(rig, status):
    rig.io.stop(signal.SIGKILL)
    rig.start_io()
    count = len(status)
    wait_for(lambda: len(status) > count + 10, "status from the new node")


def test_node_ends_cleanly_on_ctrl_c(rig):
    assert rig.io.stop(signal.SIGINT) == 0
    rig.start_io()


@pytest.mark.parametrize("arguments, part", [
    (["-p", "port:=/dev/no_such_port"], "/dev/no_such_port"),
    (["-p", "baud_rate:=123", "-p", "port:=/dev/null"], "/dev/null"),
    (["-p", "udp:=maybe"], "udp"),
    (["-p", "udp:=true", "-p", "remote_port:=99999"], "remote_port"),
    (["-p", "link:=carrier_pigeon:3"], "carrier_pigeon"),
    (["-p", "udp:=true", "-p", "remote_host:=no.such.host.invalid"], "no.such.host.invalid"),
])
def test_a_link_that_cannot_be_ends_with_one_line_and_code_2(arguments, part):
    done = subprocess.run([NODE, "--ros-args", *arguments], capture_output=True, text=True, timeout=TIMEOUT_S)
    assert done.returncode == 2, done.stdout + done.stderr
    lines = [line for line in done.stderr.strip().splitlines() if line.startswith("rosflight_io:")]
    assert len(lines) == 1 and part in lines[0], done.stderr


def test_a_rig_whose_node_does_not_start_leaves_no_firmware_running(tmp_path, monkeypatch):
    firmware = []
    monkeypatch.setattr("ros_rig.start_ready", lambda *words: firmware.append(start_ready(*words)) or firmware[-1])
    with pytest.raises(AssertionError, match="the node ended before"):
        Rig(tmp_path, node_arguments=["-p", "link:=carrier_pigeon:3"])
    (process, _), = firmware
    assert process.poll() is not None
