# SPDX-License-Identifier: BSD-3-Clause
"""The node in simulated time: nothing is sent before there is a time to send."""

import socket
import struct

import pytest
from ros_rig import TIMEOUT_S, free_udp_port
from rosgraph_msgs.msg import Clock
from sim_rig import Process, SimPeer, executable, node

FIRST_S = 103  # simulated time when the node is started again in a flight
TIMESYNC = 111  # message number; tc1 and ts1, both int64 [ns] (MAVLink, common.xml)


def timesync_requests(datagram):
    """Time [ns] of each request in the MAVLink 1 frames of a datagram."""
    found = []
    while datagram:
        assert datagram[0] == 0xFE
        length, number = datagram[1], datagram[5]
        if number == TIMESYNC:
            answer, asked = struct.unpack("<qq", datagram[6:22])
            if answer == 0:
                found.append(asked)
        datagram = datagram[length + 8:]
    return found


def test_nothing_is_sent_before_the_first_tick():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as board, SimPeer() as peer:
        board.bind(("127.0.0.1", 0))
        clock = peer.publisher(Clock, "/clock")
        with node("rosflight_io", package="rosflight_io", use_sim_time="true", udp="true", bind_port=free_udp_port(),
                  remote_port=board.getsockname()[1]) as io:
            io.until("use_sim_time is true and no /clock came for 5 s")
            board.setblocking(False)
            try:
                early = board.recv(2048)
            except BlockingIOError:
                early = None
            assert early is None
            board.settimeout(0.1)
            asked, tick = [], Clock()

            def time_goes_on():
                tick.clock.sec, tick.clock.nanosec = divmod(
                    max(FIRST_S * 1_000_000_000, tick.clock.sec * 1_000_000_000 + tick.clock.nanosec) + 20_000_000,
                    1_000_000_000)
                clock.publish(tick)
                try:
                    asked.extend(timesync_requests(board.recv(2048)))
                except TimeoutError:
                    pass
                return len(asked) >= 5
            peer.poll(time_goes_on, f"five requests for the time within {TIMEOUT_S} s")
            assert min(asked) >= FIRST_S * 1_000_000_000


@pytest.mark.parametrize("package, program, words", [
    ("roscopter", "controller", []), ("rosflight_common", "compose", ["rosplane/path_follower", "rosplane/controller"])])
def test_every_program_says_that_no_clock_comes(package, program, words):
    """One node and several in a process; the I/O node is above."""
    with Process(executable(package, program), *words, "--ros-args", "-p", "use_sim_time:=true") as process:
        process.until("use_sim_time is true and no /clock came for 5 s")
