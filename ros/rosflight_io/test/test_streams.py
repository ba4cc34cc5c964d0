# SPDX-License-Identifier: BSD-3-Clause
"""Every topic of the node: type, frame, unit, rate and stamp, with the vehicle at rest on the ground."""

import math

import pytest
from geometry_msgs.msg import Vector3Stamped
from ros_rig import table_size, wait_for
from diagnostic_msgs.msg import DiagnosticArray
from rosflight_msgs.msg import (Airspeed, Attitude, Barometer, BatteryStatus, GNSS, OutputRaw, RCRaw, Status)
from sensor_msgs.msg import Imu, MagneticField, Range, Temperature
from std_msgs.msg import Bool, String


def seconds(stamp):
    return stamp.sec + stamp.nanosec * 1e-9


def norm(v):
    return math.sqrt(v.x ** 2 + v.y ** 2 + v.z ** 2)


# Topic: type, frame, what must hold for each message.
STREAMS = {
    "imu/data": (Imu, "world", lambda m: abs(m.linear_acceleration.z + 9.8) < 1.0 and norm(m.angular_velocity) < 0.5),
    "imu/temperature": (Temperature, "world", lambda m: -20.0 < m.temperature < 80.0),
    "attitude": (Attitude, "", lambda m: abs(m.attitude.w ** 2 + m.attitude.x ** 2 + m.attitude.y ** 2
                                             + m.attitude.z ** 2 - 1.0) < 1e-3),
    "attitude/euler": (Vector3Stamped, "", lambda m: abs(m.vector.x) < 0.2 and abs(m.vector.y) < 0.2),
    "magnetometer": (MagneticField, "world", lambda m: 2e-5 < norm(m.magnetic_field) < 7e-5),
    "baro": (Barometer, "", lambda m: 5e4 < m.pressure < 1.1e5 and 220.0 < m.temperature < 350.0),
    "airspeed": (Airspeed, "", lambda m: abs(m.velocity) < 20.0),
    "range": (Range, "", lambda m: m.radiation_type == Range.ULTRASOUND and abs(m.field_of_view - 1.0472) < 1e-4),
    "rc_raw": (RCRaw, "", lambda m: all(900 <= value <= 2100 for value in m.values)),
    "output_raw": (OutputRaw, "", lambda m: len(m.values) == 14 and all(0.0 <= v <= 1.0 for v in m.values)),
    "gnss": (GNSS, "NED", lambda m: m.fix_type == GNSS.GNSS_FIX_TYPE_3D_FIX and -90 <= m.lat <= 90),
    "battery": (BatteryStatus, "", lambda m: 5.0 < m.voltage < 60.0),
    "status": (Status, "", lambda m: not m.armed and m.control_mode in (0, 1, 2)),
}


@pytest.fixture(scope="module")
def received(rig):
    lists = {topic: rig.peer.listen(kind, topic) for topic, (kind, _, _) in STREAMS.items()}
    wait_for(lambda: all(len(messages) >= 20 for messages in lists.values()), "20 messages of each stream",
             lambda: {topic: len(messages) for topic, messages in lists.items()})
    return lists


@pytest.mark.parametrize("topic", STREAMS)
def test_stream_has_its_type_frame_and_unit(received, topic):
    _, frame, holds = STREAMS[topic]
    for _, message in received[topic]:
        assert message.header.frame_id == frame
        assert holds(message), message


@pytest.mark.parametrize("topic", STREAMS)
def test_stamps_are_ros_time_just_before_arrival_and_rise(received, topic):
    def ages(name):
        return [arrival - seconds(m.header.stamp) for arrival, m in received[name]]
    # Before the arrival, but for the error of the clock estimate; how late a loaded machine is, which says nothing, is seen at the IMU.
    assert min(ages(topic)) > -0.02 and min(ages(topic)) < 0.3 + max(0.0, min(ages("imu/data"))), ages(topic)
    stamps = [seconds(m.header.stamp) for _, m in received[topic]]
    assert all(b >= a - 0.02 for a, b in zip(stamps, stamps[1:]))


def test_imu_stamps_keep_the_rate_of_the_sensor(received):
    stamps = [seconds(m.header.stamp) for _, m in received["imu/data"]]
    steps = [b - a for a, b in zip(stamps, stamps[1:])]
    periods = [max(1, round(step / 0.0025)) for step in steps]  # a loaded observer misses messages
    errors = sorted(abs(step - count * 0.0025) for step, count in zip(steps, periods))
    assert errors[len(errors) // 2] < 2e-4


def test_late_listeners_get_what_is_latched(rig):
    version = rig.peer.listen(String, "version", depth=1, latched=True)
    unsaved = rig.peer.listen(Bool, "status/unsaved_params", depth=1, latched=True)
    wait_for(lambda: version and unsaved, "latched topics")
    assert version[0][1].data.startswith("2.0")


def test_diagnostics_tell_link_clock_parameters_and_vehicle(rig):
    received = rig.peer.listen(DiagnosticArray, "/diagnostics")

    def last():
        return {status.name.split(": ")[1]: status for status in received[-1][1].status} if received else {}
    wait_for(lambda: last().get("link") and last()["link"].message == "connected"
             and last()["clock"].message == "synchronised", "a healthy link", last)
    values = {entry.key: entry.value for entry in last()["clock"].values}
    assert 0.0 < float(values["error at most [ms]"]) < 50.0
    assert {entry.key: entry.value for entry in last()["parameters"].values}["count"] == str(table_size())
