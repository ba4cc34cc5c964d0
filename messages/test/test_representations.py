# SPDX-License-Identifier: BSD-3-Clause
"""Every field of every message of the link through all representations.

pymavlink writes a frame with another value in each field. Our codec reads it, messages/ makes ROS messages of its
struct and serialises them, and mcap_ros2 reads those by their schemas. What it reads must be what EXPECTED makes of the
fields that pymavlink wrote. What ROS sends to the FCU goes back into a frame, which must be the one it came from.
"""

import importlib.util
import math
import os
import random
import struct
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from mcap_ros2._dynamic import generate_dynamic, serialize_dynamic

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("ROSFLIGHT_BUILD", ROOT / "build" / "release"))
EMPTY = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}
NONE9 = [0.0] * 9
UNKNOWN = [-1.0] + [0.0] * 8
IDENTITY = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
INTEGERS = {"int8_t": (-(2**7), 2**7), "uint8_t": (0, 2**8), "int16_t": (-(2**15), 2**15), "uint16_t": (0, 2**16),
            "int32_t": (-(2**31), 2**31), "uint32_t": (0, 2**32), "int64_t": (-(2**63), 2**63), "uint64_t": (0, 2**64)}


def f32(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


def bits(value):
    return struct.unpack("<I", struct.pack("<f", value))[0]


def text(value):
    return value.decode().rstrip("\0")


def xyz(x, y, z):
    return {"x": x, "y": y, "z": z}


def xyzw(x, y, z, w):
    return {"x": x, "y": y, "z": z, "w": w}


def imu(m, orientation, covariance):
    return {"orientation": orientation, "orientation_covariance": covariance,
            "angular_velocity": xyz(m.xgyro, m.ygyro, m.zgyro), "angular_velocity_covariance": NONE9,
            "linear_acceleration": xyz(m.xacc, m.yacc, m.zacc), "linear_acceleration_covariance": NONE9}


def euler(m):
    w, x, y, z = m.q1, m.q2, m.q3, m.q4
    return {"vector": xyz(math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
                          math.asin(max(-1.0, min(1.0, 2 * (w * y - z * x)))),
                          math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))}


def range_of(m):
    lidar = m.type == 1
    return {"radiation_type": 1 if lidar else 0, "field_of_view": f32(0.0349066 if lidar else 1.0472),
            "min_range": m.min_range, "max_range": m.max_range, "range": m.range, "variance": 0.0}


def parameter(m):
    number = bits(m.param_value)
    signed = number - (1 << 32) if number >> 31 else number
    value = {6: float(signed), 9: m.param_value}.get(m.param_type, math.nan)
    return {"name": text(m.param_id), "type": m.param_type, "value": value, "bits": number}


# MAVLink message -> (ROS type, its fields without the header) of each ROS message made of it.
EXPECTED = {
    "HEARTBEAT": lambda m: [("rosflight_log_msgs/msg/Heartbeat", {"direction": 0, "vehicle_type": m.type})],
    "TIMESYNC": lambda m: [("rosflight_log_msgs/msg/TimeSync", {"direction": 0, "tc1": m.tc1, "ts1": m.ts1})],
    "PARAM_REQUEST_READ": lambda m: [("rosflight_log_msgs/msg/ParamRequestRead", {
        "target_system": m.target_system, "index": m.param_index, "name": text(m.param_id)})],
    "PARAM_REQUEST_LIST": lambda m: [("rosflight_log_msgs/msg/ParamRequestList", {"target_system": m.target_system})],
    "PARAM_SET": lambda m: [("rosflight_log_msgs/msg/ParamSet", {"target_system": m.target_system, **parameter(m)})],
    "PARAM_VALUE": lambda m: [("rosflight_log_msgs/msg/ParamValue", {
        **parameter(m), "index": m.param_index, "count": m.param_count})],
    "OFFBOARD_CONTROL": lambda m: [("rosflight_msgs/msg/Command", {"mode": m.mode, "ignore": m.ignore, "u": m.u})],
    "ROSFLIGHT_AUX_CMD": lambda m: [("rosflight_msgs/msg/AuxCommand", {
        "type_array": m.type_array, "values": m.aux_cmd_array})],
    "EXTERNAL_ATTITUDE": lambda m: [("rosflight_msgs/msg/Attitude", {
        "attitude": xyzw(m.qx, m.qy, m.qz, m.qw), "angular_velocity": xyz(0.0, 0.0, 0.0)})],
    "ROSFLIGHT_CMD": lambda m: [("rosflight_log_msgs/msg/CommandRequest", {"command": m.command})],
    "ROSFLIGHT_CMD_ACK": lambda m: [("rosflight_log_msgs/msg/CommandAck", {
        "command": m.command, "success": m.success != 0})],
    "ATTITUDE_QUATERNION": lambda m: [
        ("rosflight_msgs/msg/Attitude", {"attitude": xyzw(m.q2, m.q3, m.q4, m.q1),
                                         "angular_velocity": xyz(m.rollspeed, m.pitchspeed, m.yawspeed)}),
        ("geometry_msgs/msg/Vector3Stamped", euler(m))],
    "SMALL_IMU": lambda m: [
        ("sensor_msgs/msg/Imu", imu(m, IDENTITY, UNKNOWN)),
        ("sensor_msgs/msg/Imu", imu(m, xyzw(m.last.q2, m.last.q3, m.last.q4, m.last.q1) if m.last else IDENTITY, NONE9)),
        ("sensor_msgs/msg/Temperature", {"temperature": m.temperature - 273.15, "variance": 0.0})],
    "SMALL_MAG": lambda m: [("sensor_msgs/msg/MagneticField", {
        "magnetic_field": xyz(m.xmag, m.ymag, m.zmag), "magnetic_field_covariance": NONE9})],
    "SMALL_BARO": lambda m: [("rosflight_msgs/msg/Barometer", {
        "altitude": m.altitude, "pressure": m.pressure, "temperature": m.temperature})],
    "DIFF_PRESSURE": lambda m: [("rosflight_msgs/msg/Airspeed", {
        "velocity": m.velocity, "differential_pressure": m.diff_pressure, "temperature": m.temperature})],
    "SMALL_RANGE": lambda m: [("sensor_msgs/msg/Range", range_of(m))],
    "RC_CHANNELS": lambda m: [("rosflight_msgs/msg/RCRaw", {
        "values": [getattr(m, f"chan{k}_raw") for k in range(1, 9)]})],
    "ROSFLIGHT_OUTPUT_RAW": lambda m: [("rosflight_msgs/msg/OutputRaw", {"values": m.values})],
    "ROSFLIGHT_STATUS": lambda m: [("rosflight_msgs/msg/Status", {
        "armed": m.armed != 0, "failsafe": m.failsafe != 0, "rc_override": m.rc_override, "offboard": m.offboard != 0,
        "control_mode": m.control_mode, "error_code": m.error_code, "num_errors": m.num_errors,
        "loop_time_us": m.loop_time_us})],
    "ROSFLIGHT_VERSION": lambda m: [("std_msgs/msg/String", {"data": text(m.version)})],
    "ROSFLIGHT_HARD_ERROR": lambda m: [("rosflight_msgs/msg/Error", {
        "error_message": "The flight controller had a fault and restarted", "error_code": m.error_code,
        "reset_count": m.reset_count, "rearm": m.doRearm != 0, "pc": m.pc})],
    "ROSFLIGHT_GNSS": lambda m: [("rosflight_msgs/msg/GNSS", {
        "fix_type": m.fix_type, "num_sat": m.num_sat, "lat": m.lat, "lon": m.lon, "alt": m.height,
        "horizontal_accuracy": m.h_acc, "vertical_accuracy": m.v_acc, "vel_n": m.vel_n, "vel_e": m.vel_e,
        "vel_d": m.vel_d, "speed_accuracy": m.s_acc, "gnss_unix_seconds": m.seconds, "gnss_unix_nanos": m.nanos})],
    "ROSFLIGHT_BATTERY_STATUS": lambda m: [("rosflight_msgs/msg/BatteryStatus", {
        "voltage": m.battery_voltage, "current": m.battery_current})],
    "STATUSTEXT": lambda m: [("rcl_interfaces/msg/Log", {
        "stamp": EMPTY["stamp"], "level": {2: 50, 3: 40, 4: 30}.get(m.severity, 20), "name": "fcu", "msg": text(m.text),
        "file": "", "function": "", "line": 0})],
    "MOTOR_TEST": lambda m: [("rosflight_log_msgs/msg/MotorTest", {
        "target_system": m.target_system, "motor": m.motor, "value": m.value})],
    "REPORT_REQUEST": lambda m: [("rosflight_log_msgs/msg/ReportRequest", {
        "target_system": m.target_system, "kind": m.kind})],
    "CHECK_RESULT": lambda m: [("rosflight_log_msgs/msg/CheckResult", {
        "index": m.index, "count": m.count, "result": m.result, "name": text(m.name), "reason": text(m.reason)})],
    "COUNTERS": lambda m: [("rosflight_log_msgs/msg/Counters", {
        name: getattr(m, name) for name in ("longest_pass", "pass_budget", "passes_over_budget", "passes",
                                            "frames_dropped", "tx_dropped", "texts_lost", "imu_jitter", "rejected")})],
    "RECORD_REQUEST": lambda m: [], "RECORD_PART": lambda m: [],
}
NO_HEADER = {"std_msgs/msg/String", "rcl_interfaces/msg/Log"}
# Fields that no ROS message carries: times, which become stamps, and what ROSflight 2.x does not publish.
NOT_CARRIED = {
    "HEARTBEAT": {"autopilot", "base_mode", "custom_mode", "system_status", "mavlink_version"},
    "PARAM_REQUEST_READ": {"target_component"}, "PARAM_REQUEST_LIST": {"target_component"},
    "PARAM_SET": {"target_component"}, "ATTITUDE_QUATERNION": {"time_boot_ms"}, "SMALL_IMU": {"time_boot_us"},
    "RC_CHANNELS": {"time_boot_ms", "chancount", "rssi", *(f"chan{k}_raw" for k in range(9, 19))},
    "ROSFLIGHT_OUTPUT_RAW": {"stamp"}, "ROSFLIGHT_GNSS": {"rosflight_timestamp"},
    "RECORD_REQUEST": {"target_system", "first", "count"}, "RECORD_PART": {"number", "oldest", "newest", "part", "bytes"},
}
# Values that mean something; every other field takes any value of its type.
CHOSEN = {("SMALL_RANGE", "type"): range(4), ("STATUSTEXT", "severity"): (2, 3, 4, 6),
          ("PARAM_SET", "param_type"): (6, 9, 3), ("PARAM_VALUE", "param_type"): (6, 9),
          ("ROSFLIGHT_STATUS", "armed"): (0, 1), ("ROSFLIGHT_STATUS", "failsafe"): (0, 1),
          ("ROSFLIGHT_STATUS", "offboard"): (0, 1), ("ROSFLIGHT_CMD_ACK", "success"): (0, 1),
          ("ROSFLIGHT_HARD_ERROR", "doRearm"): (0, 1)}
SENT_BY_ROS = {"OFFBOARD_CONTROL", "ROSFLIGHT_AUX_CMD", "EXTERNAL_ATTITUDE"}
ROUNDS = 12


def load_dialect():
    path = BUILD / "link" / "mavlink" / "mavlink_python" / "rosflight.py"
    spec = importlib.util.spec_from_file_location("rosflight_dialect", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def any_value(rng, kind, length):
    if kind == "char":
        return "".join(chr(rng.randrange(97, 123)) for _ in range(rng.randrange(1, 16))).encode()
    if kind in ("float", "double"):
        draw = lambda: f32(rng.uniform(-1.0, 1.0)) if kind == "float" else rng.uniform(-100.0, 100.0)
    else:
        draw = lambda: rng.randrange(*INTEGERS[kind])
    return [draw() for _ in range(length)] if length else draw()


def random_fields(rng, kind):
    lengths = dict(zip(kind.ordered_fieldnames, kind.array_lengths))
    return {name: rng.choice(CHOSEN[kind.msgname, name]) if (kind.msgname, name) in CHOSEN
            else any_value(rng, type_name, lengths[name])
            for name, type_name in zip(kind.fieldnames, kind.fieldtypes)}


class Watched(SimpleNamespace):
    """Fields of a message that remember who was read."""

    def __getattribute__(self, name):
        if not name.startswith("_"):
            object.__getattribute__(self, "_read").add(name)
        return object.__getattribute__(self, name)


def plain(message):
    if hasattr(message, "__slots__"):
        return {name: plain(getattr(message, name)) for name in message.__slots__}
    return [plain(one) for one in message] if isinstance(message, (list, tuple, bytes)) else message


def same(found, wanted):
    if isinstance(wanted, dict):
        return found.keys() == wanted.keys() and all(same(found[k], wanted[k]) for k in wanted)
    if isinstance(wanted, list):
        return len(found) == len(wanted) and all(map(same, found, wanted))
    if isinstance(wanted, float):
        return math.isclose(found, wanted, rel_tol=1e-15, abs_tol=1e-15) or (found != found and wanted != wanted)
    return type(found) is type(wanted) and found == wanted


def schemas_in(lines):
    found = {}
    while lines:
        name, count = lines[0].split()
        found[name] = "\n".join(lines[1:1 + int(count)])
        lines = lines[1 + int(count):]
    return found


@pytest.fixture(scope="module")
def exchange():
    """Name, fields and frame of each message sent, with what came of it; and the schemas."""
    dialect, rng, sent = load_dialect(), random.Random(12), []
    sender = dialect.MAVLink(None, srcSystem=1, srcComponent=50)
    for _ in range(ROUNDS):
        for kind in dialect.mavlink_map.values():
            fields = random_fields(rng, kind)
            sent.append((kind.msgname, fields, bytes(kind(**fields).pack(sender, force_mavlink1=True))))
            sender.seq = (sender.seq + 1) % 256
    done = subprocess.run([BUILD / "messages" / "message_peer"], input="\n".join(f.hex() for *_, f in sent) + "\n",
                          text=True, capture_output=True, check=True, timeout=60)
    lines = done.stdout.splitlines()
    answers = [line.rstrip("\t").split("\t") if line else [] for line in lines[:len(sent)]]
    pairs = [[(a[k], bytes.fromhex(a[k + 1])) for k in range(0, len(a), 2)] for a in answers]
    return list(zip(sent, pairs)), schemas_in(lines[len(sent):])


def test_every_message_of_the_dialect_is_in_the_table(exchange):
    assert {name for (name, _, _), _ in exchange[0]} == EXPECTED.keys()


def test_every_field_arrives_as_it_was_sent(exchange):
    messages, schemas = exchange
    decoders = {name: generate_dynamic(name, schema)[name] for name, schema in schemas.items()}
    last = None
    for (name, fields, _), answer in messages:
        seen = Watched(**fields, last=last, _read=set())
        wanted = EXPECTED[name](seen)
        unused = fields.keys() - seen._read - NOT_CARRIED.get(name, set())
        assert not unused, f"{name}: nothing here looks at {unused}"
        if name == "ATTITUDE_QUATERNION":
            last = SimpleNamespace(**fields)
        made = [one for one in answer if one[0] != "frame"]
        assert [kind for kind, _ in made] == [kind for kind, _ in wanted], name
        for (kind, cdr), (_, values) in zip(made, wanted):
            if kind not in NO_HEADER:
                values = {"header": EMPTY, **values}
            found = plain(decoders[kind](cdr))
            assert same(found, values), f"{name} -> {kind}:\n{found}\n{values}"


def test_every_message_has_exactly_the_bytes_of_its_schema(exchange):
    """Decoders do not mind bytes left over; writing the decoded message again does."""
    messages, schemas = exchange
    for _, answer in messages:
        for kind, cdr in answer:
            if kind != "frame":
                decoded = generate_dynamic(kind, schemas[kind])[kind](cdr)
                assert serialize_dynamic(kind, schemas[kind])[kind](decoded) == cdr, kind


def test_what_ros_sends_becomes_the_frame_it_came_from(exchange):
    for (name, _, frame), answer in exchange[0]:
        back = dict(answer).get("frame")
        assert (back is not None) == (name in SENT_BY_ROS), name
        if back is not None:
            assert back[6:-2] == frame[6:-2], name
