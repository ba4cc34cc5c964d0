# SPDX-License-Identifier: BSD-3-Clause
"""Words of the command line for real-time scheduling."""

import os
import subprocess

import pytest
from ros_rig import NODE, TIMEOUT_S, wait_for
from std_msgs.msg import Int32


@pytest.mark.parametrize("words, part", [
    (["--realtime", "--priority:=0"], "--priority: found '0', allowed 1 to 99"),
    (["--priority:=7x"], "--priority: found '7x'"),
    (["--policy:=IDLE"], "--policy: found 'IDLE', allowed RR or FIFO"),
])
def test_wrong_words_end_with_one_line_and_code_2(words, part):
    done = subprocess.run([NODE, *words], capture_output=True, text=True, timeout=TIMEOUT_S)
    assert done.returncode == 2 and part in done.stderr and len(done.stderr.strip().splitlines()) == 1, done.stderr


def test_scheduling_and_context_switches(rig):
    """Where real-time scheduling is not allowed, the node says so instead of flying without it."""
    rig.io.stop()
    words = ["--realtime", "--policy:=FIFO", "--priority:=7", "--publish-context-switches"]
    allowed = subprocess.run(["chrt", "-f", "7", "true"], capture_output=True).returncode == 0
    if not allowed:
        done = subprocess.run([NODE, *words], capture_output=True, text=True, timeout=TIMEOUT_S)
        assert done.returncode == 2 and "--realtime: priority 7 refused" in done.stderr
        return
    rig.start_io(words)
    received = rig.peer.listen(Int32, "rosflight_io/context_switches")
    wait_for(lambda: received, "a count")
    assert received[0][1].data >= 0
    threads = [int(thread) for thread in os.listdir(f"/proc/{rig.io.process.pid}/task")]
    realtime = [thread for thread in threads if os.sched_getscheduler(thread) == os.SCHED_FIFO]
    # The middleware may give some of its own threads another policy.
    assert rig.io.process.pid in realtime and len(realtime) >= 2, (realtime, threads)
    assert os.sched_getparam(rig.io.process.pid).sched_priority == 7
