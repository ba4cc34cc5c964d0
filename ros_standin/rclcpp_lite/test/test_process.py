# SPDX-License-Identifier: BSD-3-Clause
"""A program on rclcpp_lite from outside: its log, its end on a signal."""

import signal
import time

import pytest
from rcl_interfaces.msg import Log
from ros_peer import Process, latched, lite_program, until
from std_srvs.srv import Trigger


def log_of_peer(tester, name: str, *words: str):
    """What a node of this name logs when asked twice, as messages on /rosout and as text on its standard error."""
    # /rosout is kept for subscribers that come late, so nothing depends on who knows whom first.
    received = tester.subscribe(Log, "/rosout", latched(100))

    def errors():
        return sum(entry.name == name and entry.msg == "error 4" for entry in received)
    with Process(lite_program("peer_node", "--ros-args", "-r", f"__node:={name}", "-r",
                              f"log:={name}/log", *words)) as process:
        for asked in (1, 2):
            tester.call(Trigger, f"{name}/log")
            until(lambda wanted=asked: errors() >= wanted, f"log {asked} on /rosout")
    return [entry for entry in received if entry.name == name], process.said()


def test_log_comes_on_rosout_with_level_and_place(tester):
    entries, said = log_of_peer(tester, "talker")
    texts = [entry.msg for entry in entries]
    # Once and throttle let one of three through, also when asked again. A request may be sent twice.
    first, again = ["info 2", "warn 3", "error 4", "once", "throttled"], ["info 2", "warn 3", "error 4"]
    assert texts[:8] == first + again
    assert set(texts[8:]) <= set(again)
    levels = {entry.msg: entry.level for entry in entries}
    assert (levels["info 2"], levels["warn 3"], levels["error 4"]) == (20, 30, 40)
    assert entries[0].file.endswith("peer_node.cpp") and entries[0].line > 0
    assert "[talker]: error 4" in said and "debug" not in said


def test_log_level_of_the_command_line_counts(tester):
    entries, said = log_of_peer(tester, "chatty", "--log-level", "chatty:=debug")
    assert entries[0].msg == "debug 1" and entries[0].level == 10
    entries, said = log_of_peer(tester, "quiet", "--log-level", "quiet:=error")
    assert {entry.msg for entry in entries} == {"error 4"}
    assert "warn" not in said


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signal_ends_the_program_cleanly(tester, number):
    with Process(lite_program("peer_node", "--ros-args", "-r", "__ns:=/ended")) as process:
        tester.matched("/ended/reply")
        assert process.end(number) == 0, process.said()
        assert "rror" not in process.said()


@pytest.mark.parametrize("delay_ms", [0, 2, 5, 10, 20, 40, 80])
def test_signal_at_any_moment_of_the_start_ends_the_program(delay_ms):
    with Process(lite_program("peer_node")) as process:
        time.sleep(delay_ms / 1000)
        # Before the handler stands, the signal's own way of ending is right.
        code = process.end()
        assert code in (0, -signal.SIGINT), process.said()
        assert "rror" not in process.said() and "FATAL" not in process.said()
        process.process.returncode = 0


@pytest.mark.parametrize("waits", ["sleep", "sim_sleep", "service", "rate", "future", "threads"])
def test_signal_ends_every_kind_of_waiting(waits):
    with Process(lite_program("waiting_program", waits)) as process:
        until(lambda: "waiting" in process.said(), "the program waits")
        assert process.end() == 0, process.said()
        assert "interrupted" in process.said()
