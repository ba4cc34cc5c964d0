# SPDX-License-Identifier: BSD-3-Clause
"""Messages between rclcpp_lite and rclpy, in every form of callback and quality of service."""

import pytest
from rclpy.qos import QoSProfile, qos_profile_sensor_data, qos_profile_system_default
from ros_peer import Process, best_effort, latched, lite_program, until
from std_msgs.msg import Int64, String
from std_srvs.srv import Trigger

pytestmark = pytest.mark.usefixtures("peer")


@pytest.mark.parametrize("form", ["reference", "shared", "const_shared", "unique", "with_info",
                                  "bytes", "member"])
def test_every_form_of_callback_gets_the_message(tester, form):
    received = tester.subscribe(Int64, "reply")
    tester.matched("reply")
    publisher = tester.publisher(Int64, f"echo/{form}")
    until(lambda: publisher.publish(Int64(data=-5)) or received, f"an echo of {form}")
    received.clear()
    for value in range(100, 105):
        publisher.publish(Int64(data=value))
    until(lambda: any(message.data == 104 for message in received), "the last echo")
    assert [message.data for message in received if message.data != -5] == list(range(100, 105))


@pytest.mark.parametrize("name, qos", [
    ("reliable", QoSProfile(depth=10)), ("best_effort", best_effort(5)),
    ("sensor_data", qos_profile_sensor_data), ("system_defaults", qos_profile_system_default)])
def test_every_quality_of_service_matches_both_ways(tester, name, qos):
    received = tester.subscribe(Int64, f"qos/{name}/received", qos)
    publisher = tester.publisher(Int64, f"qos/{name}", qos)
    tester.matched(f"qos/{name}/received")
    until(lambda: publisher.publish(Int64(data=3)) or received, "a message back")
    assert received[0].data == 3
    ours = tester.node.get_publishers_info_by_topic(f"qos/{name}/received")[0].qos_profile
    if name in ("best_effort", "sensor_data"):
        assert ours.reliability.name == "BEST_EFFORT"
    else:
        assert ours.reliability.name == "RELIABLE"
    if name != "system_defaults":  # the middleware's own choice
        assert ours.durability.name == "VOLATILE"


def test_best_effort_publisher_does_not_reach_a_reliable_subscriber(tester):
    received = tester.subscribe(Int64, "qos/best_effort/received", QoSProfile(depth=10))
    sure = tester.subscribe(Int64, "qos/best_effort/received", best_effort())
    publisher = tester.publisher(Int64, "qos/best_effort", best_effort())
    until(lambda: publisher.publish(Int64(data=1)) or len(sure) > 5, "messages at the other one")
    assert not received


def test_transient_local_message_reaches_a_late_subscriber(tester):
    received = tester.subscribe(String, "latched", latched())
    until(lambda: received, "the kept message")
    assert received[0].data == "kept for late ones"


def test_late_subscriber_gets_as_many_kept_messages_as_the_depth_says(tester):
    received = tester.subscribe(Int64, "recent", latched(5))
    until(lambda: len(received) >= 5, "the kept messages")
    assert [message.data for message in received] == [4, 5, 6, 7, 8]


def test_late_node_hears_what_python_has_kept(tester):
    kept = tester.node.create_publisher(Int64, "/late/to_latched", latched(3))
    for value in range(1, 6):
        kept.publish(Int64(data=value))
    received = tester.subscribe(Int64, "/late/reply", latched(10))
    replies = tester.subscribe(Int64, "/late/reply")
    with Process(lite_program("peer_node", "--ros-args", "-r", "__ns:=/late")):
        tester.matched("/late/reply")
        kept.publish(Int64(data=6))
        until(lambda: any(message.data == 6 for message in replies), "the newest")
    # A volatile publisher is no match for who asks for kept messages.
    assert not received
    # The first replies may have gone before the tester was seen; the order stands.
    values = [message.data for message in replies]
    assert values == [3, 4, 5, 6][-len(values):]


def test_volatile_publisher_does_not_reach_who_asks_for_kept_messages(tester):
    replies = tester.subscribe(Int64, "reply")
    volatile = tester.node.create_publisher(Int64, "to_latched", 10)
    kept = tester.publisher(Int64, "to_latched", latched())
    tester.matched("reply")
    until(lambda: kept.publish(Int64(data=40)) or volatile.publish(Int64(data=41)) or
          len(replies) > 5, "replies to the other one")
    assert {message.data for message in replies} == {40}


def test_counts_of_the_graph_are_those_rclpy_sees(tester):
    before = tester.node.count_subscribers("reply")
    tester.subscribe(Int64, "reply")
    wanted = f"{before + 1} {tester.node.count_publishers('reply')} {before + 1}"
    until(lambda: tester.call(Trigger, "count").message == wanted, f"counts are {wanted}")
