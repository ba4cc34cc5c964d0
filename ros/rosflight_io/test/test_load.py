# SPDX-License-Identifier: BSD-3-Clause
"""Everything at once for 20 s: nothing is lost and memory stays. ./rosflight bench load.* does the same for 10 minutes."""

import signal
import time

import ros_demo_load

SECONDS = 20.0
# Of IMU and temperature: the firmware rejects up to so many samples where the machine stood still (firmware/core/imu_clock.hpp).
REJECTED_IN_A_PAUSE = 2 * 3


def test_all_streams_and_offboard_at_100_Hz_lose_nothing(rig):
    told = ros_demo_load.measure(rig, SECONDS)
    assert told["missing"] <= REJECTED_IN_A_PAUSE * told["pauses"], str(told)
    assert told["sequence_gaps"] == 0 and told["frames_dropped"] == 0 and told["send_failures"] == 0, str(told)
    assert told["commands"] > 50 * SECONDS, str(told)
    assert abs(told["topics"]["imu/data"]["period_ms"] - 2.5) < 0.1, str(told)
    assert told["memory_growth_kB"] < 2048, str(told)


def test_a_reader_that_stands_still_for_half_a_second_loses_nothing(rig):
    """What the machine has no time for meanwhile is missing for the reader beside it too, and is no loss."""
    beside, stopped = ros_demo_load.start_watch(rig, 8.0), ros_demo_load.start_watch(rig, 4.0)
    time.sleep(1.0)
    stopped.send_signal(signal.SIGSTOP)
    time.sleep(0.5)
    stopped.send_signal(signal.SIGCONT)
    found, all_of_it = ros_demo_load.end_watch(stopped, 4.0), ros_demo_load.end_watch(beside, 8.0)
    assert found["pauses"] <= all_of_it["pauses"] and found["missing"] <= all_of_it["missing"], (found, all_of_it)


def test_twenty_late_subscribers_all_hear(rig):
    from rosflight_msgs.msg import Attitude
    from ros_rig import Peer, wait_for
    from std_msgs.msg import String
    late = Peer()
    try:
        received = []
        for _ in range(20):
            messages = []
            late.node.create_subscription(Attitude, "attitude", messages.append, 10)
            received.append(messages)
        versions = late.listen(String, "version", depth=1, latched=True)
        wait_for(lambda: all(len(messages) >= 20 for messages in received) and versions, "20 messages each",
                 lambda: [len(messages) for messages in received])
    finally:
        late.close()
    assert ros_demo_load.memory_kB(rig.io.process.pid) < 500_000
