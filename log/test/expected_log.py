# SPDX-License-Identifier: BSD-3-Clause
"""Every message of the log that log_sample writes, as literals: test_log_reads_back.py compares."""

import math
import struct

EPOCH_S = 1_767_225_600  # 2026-01-01T00:00:00Z


def f32(value):
    """The double that a float32 holds."""
    return struct.unpack("f", struct.pack("f", value))[0]


def ramp(first, step, count):
    return [first + k * step for k in range(count)]


def header(seconds, frame="body"):
    return {"stamp": stamp(seconds), "frame_id": frame}


def stamp(seconds):
    microseconds = round(seconds * 1e6)
    return {"sec": EPOCH_S + microseconds // 1_000_000, "nanosec": microseconds % 1_000_000 * 1000}


def xyz(x, y, z):
    return {"x": x, "y": y, "z": z}


def xyzw(x, y, z, w):
    return {"x": x, "y": y, "z": z, "w": w}


NO_COVARIANCE = [0.0] * 9


def imu(seconds, q, first_covariance, gyro, accel):
    return {
        "header": header(seconds, "body"),
        "orientation": xyzw(*q),
        "orientation_covariance": [first_covariance] + [0.0] * 8,
        "angular_velocity": xyz(*gyro),
        "angular_velocity_covariance": NO_COVARIANCE,
        "linear_acceleration": xyz(*accel),
        "linear_acceleration_covariance": NO_COVARIANCE,
    }


def sensor_range(seconds, kind, view, low, high, value):
    return {
        "header": header(seconds, "body"), "radiation_type": kind, "field_of_view": f32(view), "min_range": low,
        "max_range": high, "range": value, "variance": 0.0,
    }


# Takes north, east, down to east, north, up; forward, right, down to forward, left, up.
ENU = [[0, 1, 0], [1, 0, 0], [0, 0, -1]]
FLU = [[1, 0, 0], [0, -1, 0], [0, 0, -1]]
HALF_SQRT2 = math.sqrt(0.5)


def transform(parent, child, position, q, seconds=3.004):
    return {"header": header(seconds, parent), "child_frame_id": child,
            "transform": {"translation": xyz(*position), "rotation": xyzw(*q)}}


def rotation(w, x, y, z):
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


def turned(R, sigma):
    """R diag(sigma^2) R^T."""
    return [[sum(R[i][k] * sigma[k] ** 2 * R[j][k] for k in range(3)) for j in range(3)] for i in range(3)]


def multiplied(A, B):
    return [[sum(A[i][k] * B[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def transposed(A):
    return [list(row) for row in zip(*A)]


def covariance(first=None, second=None):
    """36 numbers of two blocks on the diagonal."""
    out = [[0.0] * 6 for _ in range(6)]
    for start, block in ((0, first), (3, second)):
        for i in range(3):
            for j in range(3):
                out[start + i][start + j] = block[i][j] if block else 0.0
    return [number for row in out for number in row]


R_ESTIMATE = rotation(0.5, -0.5, 0.5, 0.5)


def text(seconds, level, source, message):
    return {
        "stamp": stamp(seconds), "level": level, "name": source, "msg": message, "file": "", "function": "",
        "line": 0,
    }


# topic -> (type, [(log time in s, message), ...]); every message log_sample writes.
EXPECTED = {
    "/imu/data": ("sensor_msgs/msg/Imu", [
        (1.000, imu(0.900001, (0.0, 0.0, 0.0, 1.0), -1.0, (0.125, -0.25, 0.375), (1.5, -2.5, -9.75))),
        (1.002, imu(0.903003, (-0.5, 0.5, 0.5, 0.5), 0.0, (-0.125, 0.5, 0.0625), (0.5, 0.25, -9.5))),
    ]),
    "/imu/temperature": ("sensor_msgs/msg/Temperature", [  # the second is within 10 ms
        (1.000, {"header": header(0.900001, "body"), "temperature": f32(300.15) - 273.15, "variance": 0.0}),
    ]),
    "/attitude": ("rosflight_msgs/msg/Attitude", [
        (1.001, {"header": header(0.902, "NED"), "attitude": xyzw(-0.5, 0.5, 0.5, 0.5),
                 "angular_velocity": xyz(f32(0.01), f32(0.02), f32(0.03))}),
    ]),
    "/attitude/euler": ("geometry_msgs/msg/Vector3Stamped", [
        (1.001, {"header": header(0.902, "NED"), "vector": xyz(0.0, math.pi / 2, 0.0)}),
    ]),
    "/link/heartbeat": ("rosflight_log_msgs/msg/Heartbeat", [
        (1.003, {"header": header(1.003), "direction": 0, "vehicle_type": 2}),
        (2.000, {"header": header(2.000), "direction": 1, "vehicle_type": 0}),
    ]),
    "/link/time_sync": ("rosflight_log_msgs/msg/TimeSync", [
        (1.004, {"header": header(1.004), "direction": 0, "tc1": 123456789012, "ts1": -5}),
        (2.001, {"header": header(2.001), "direction": 1, "tc1": 0, "ts1": 987654321}),
    ]),
    "/link/param_value": ("rosflight_log_msgs/msg/ParamValue", [
        (1.005, {"header": header(1.005), "name": "RC_ATT_OVRD_CHN_", "type": 6, "value": -2.0,
                 "bits": 0xFFFFFFFE, "index": 332, "count": 333}),
        (1.006, {"header": header(1.006), "name": "PID_ROLL_RATE_P", "type": 9, "value": f32(0.07),
                 "bits": struct.unpack("I", struct.pack("f", 0.07))[0], "index": 17, "count": 333}),
    ]),
    "/link/command_ack": ("rosflight_log_msgs/msg/CommandAck", [
        (1.007, {"header": header(1.007), "command": 6, "success": True}),
    ]),
    "/magnetometer": ("sensor_msgs/msg/MagneticField", [
        (1.008, {"header": header(1.008, "body"), "magnetic_field": xyz(f32(2.5e-5), f32(-1.25e-5), f32(4.5e-5)),
                 "magnetic_field_covariance": NO_COVARIANCE}),
    ]),
    "/baro": ("rosflight_msgs/msg/Barometer", [
        (1.009, {"header": header(1.009), "altitude": 123.5, "pressure": 99876.5, "temperature": 299.25}),
    ]),
    "/airspeed": ("rosflight_msgs/msg/Airspeed", [
        (1.010, {"header": header(1.010), "velocity": -3.5, "differential_pressure": -7.5, "temperature": 298.5}),
    ]),
    "/range": ("sensor_msgs/msg/Range", [
        (1.011, sensor_range(1.011, 0, 1.0472, 0.25, 8.0, 1.25)),
        (1.012, sensor_range(1.012, 1, 0.0349066, 0.125, 40.0, 11.5)),
    ]),
    "/rc_raw": ("rosflight_msgs/msg/RCRaw", [
        (1.013, {"header": header(1.013), "values": ramp(1000, 25, 8)}),
    ]),
    "/output_raw": ("rosflight_msgs/msg/OutputRaw", [
        (1.014, {"header": header(1.014), "values": ramp(-0.5, 0.125, 14)}),
    ]),
    "/status": ("rosflight_msgs/msg/Status", [
        (1.015, {"header": header(1.015), "armed": True, "failsafe": False, "rc_override": 0x0241, "offboard": True,
                 "control_mode": 2, "error_code": 0x24, "num_errors": -3, "loop_time_us": 245}),
    ]),
    "/version": ("std_msgs/msg/String", [(1.016, {"data": "v2.0.1-3-gabc"})]),
    "/status/rosflight_errors": ("rosflight_msgs/msg/Error", [
        (1.017, {"header": header(1.017), "error_message": "The flight controller had a fault and restarted",
                 "error_code": 0x1234, "reset_count": 3, "rearm": True, "pc": 0x08001234}),
    ]),
    "/gnss": ("rosflight_msgs/msg/GNSS", [
        (1.018, {"header": header(1.0185, "NED"), "fix_type": 3, "num_sat": 14, "lat": 40.267123456789,
                 "lon": -111.635987654321, "alt": 1387.5, "horizontal_accuracy": 0.5, "vertical_accuracy": 0.875,
                 "vel_n": 1.5, "vel_e": -2.25, "vel_d": 0.75, "speed_accuracy": 0.0625,
                 "gnss_unix_seconds": 1767225612, "gnss_unix_nanos": 345678901}),
    ]),
    "/battery": ("rosflight_msgs/msg/BatteryStatus", [
        (1.019, {"header": header(1.019), "voltage": 14.75, "current": 21.5}),
    ]),
    "/rosout": ("rcl_interfaces/msg/Log", [
        (1.020, text(1.020, 30, "fcu", "RC lost ä ?")),
        (1.021, text(1.021, 50, "fcu", "Hard fault")),
        (3.003, text(3.003, 40, "autonomy", 'Waypoint 3 "north" not reached <&>')),
    ]),
    "/link/param_request_read": ("rosflight_log_msgs/msg/ParamRequestRead", [
        (2.002, {"header": header(2.002), "target_system": 7, "index": -1, "name": "FILT_GYRO"}),
    ]),
    "/link/param_request_list": ("rosflight_log_msgs/msg/ParamRequestList", [
        (2.003, {"header": header(2.003), "target_system": 9}),
    ]),
    "/link/param_set": ("rosflight_log_msgs/msg/ParamSet", [
        (2.004, {"header": header(2.004), "target_system": 1, "name": "ARM_THRESHOLD", "type": 9,
                 "value": f32(0.15), "bits": struct.unpack("I", struct.pack("f", 0.15))[0]}),
        (2.005, {"header": header(2.005), "target_system": 1, "name": "BAD_TYPE", "type": 3, "value": math.nan,
                 "bits": 77}),
    ]),
    "/command": ("rosflight_msgs/msg/Command", [
        (2.006, {"header": header(2.006), "mode": 2, "ignore": 0x3C1, "u": ramp(-1.0, 0.25, 10)}),
    ]),
    "/aux_command": ("rosflight_msgs/msg/AuxCommand", [
        (2.007, {"header": header(2.007), "type_array": bytes(range(14)), "values": ramp(1.0, -0.125, 14)}),
    ]),
    "/external_attitude": ("rosflight_msgs/msg/Attitude", [
        (2.008, {"header": header(2.008, "NED"), "attitude": xyzw(0.125, -0.25, 0.5, 0.75),
                 "angular_velocity": xyz(0.0, 0.0, 0.0)}),
    ]),
    "/link/command_request": ("rosflight_log_msgs/msg/CommandRequest", [
        (2.009, {"header": header(2.009), "command": 10}),
    ]),
    "/link/motor_test": ("rosflight_log_msgs/msg/MotorTest", [
        (2.010, {"header": header(2.010), "target_system": 1, "motor": 3, "value": 0.25}),
    ]),
    "/link/report_request": ("rosflight_log_msgs/msg/ReportRequest", [
        (2.011, {"header": header(2.011), "target_system": 1, "kind": 1}),
    ]),
    "/link/check_result": ("rosflight_log_msgs/msg/CheckResult", [
        (1.022, {"header": header(1.022), "index": 3, "count": 9, "result": 2, "name": "gyro still",
                 "reason": "0.21 rad/s"}),
    ]),
    "/link/counters": ("rosflight_log_msgs/msg/Counters", [
        (1.023, {"header": header(1.023), "longest_pass": 310, "pass_budget": 2500, "passes_over_budget": 2,
                 "passes": 400000, "frames_dropped": 5, "tx_dropped": 6, "texts_lost": 7,
                 "imu_jitter": ramp(10, 1, 8), "rejected": ramp(30, 2, 8)}),
    ]),
    "/link/raw": ("rosflight_log_msgs/msg/RawFrames", [
        (2.550, {"header": header(2.500), "delay_us": [0, 49_000], "direction": bytes([1, 0]), "length": [5, 2],
                 "data": bytes([0xFE, 0x00, 0x7F, 0x80, 0xFF, 0xFE, 0x00])}),
        (3.004, {"header": header(2.550), "delay_us": [0], "direction": bytes([1]), "length": [1], "data": bytes([0xFF])}),
    ]),
    "/sim/truth_state": ("rosflight_msgs/msg/SimState", [
        (3.000, {"header": header(3.000, "NED"),
                 "pose": {"position": xyz(1.5, -2.5, -10.25), "orientation": xyzw(0.5, 0.5, 0.5, 0.5)},
                 "twist": {"linear": xyz(3.5, 0.25, -0.125), "angular": xyz(0.1, 0.2, 0.3)},
                 # Specific force plus gravity, which points along body y in this attitude.
                 "acceleration": {"linear": xyz(0.5, -1.5 + 9.80665, -9.0), "angular": xyz(4.5, 5.5, 6.5)}}),
    ]),
    "/sim/truth_wind": ("geometry_msgs/msg/Vector3Stamped", [
        (3.000, {"header": header(3.000, "NED"), "vector": xyz(2.0, -1.0, 0.5)}),
    ]),
    "/sim/forces_and_moments": ("geometry_msgs/msg/WrenchStamped", [
        (3.000, {"header": header(3.000, "body"),
                 "wrench": {"force": xyz(10.5, 20.5, -30.5), "torque": xyz(0.5, 0.25, -0.125)}}),
    ]),
    "/sim/pwm_output": ("rosflight_msgs/msg/PwmOutput", [
        (3.000, {"header": header(3.000, "body"), "values": [1000] + ramp(1000, 125, 8) + [2000] * 5}),
    ]),
    "/sim/truth_vehicle": ("rosflight_log_msgs/msg/TruthVehicle", [
        (3.000, {"header": header(3.000, "body"), "outputs": ramp(-0.125, 0.125, 14),
                 "rotor_speed": ramp(400.0, 10.5, 4), "battery_voltage": 15.25, "battery_current": 33.5,
                 "on_ground": False, "wind": xyz(2.0, -1.0, 0.5), "air_density": 1.1875,
                 "air_pressure": 98765.25, "air_temperature": 287.5}),
    ]),
    "/trajectory_command": ("roscopter_msgs/msg/TrajectoryCommand", [
        (3.001, {"header": header(3.001, "NED"), "position": [1.5, 2.5, -3.5], "velocity": [0.5, 0.25, 0.125],
                 "acceleration": [-0.5, -0.25, 9.5], "psi": 1.25, "psi_dot": -0.75, "psi_dot_dot": 0.625}),
    ]),
    "/autonomy/phase": ("rosflight_log_msgs/msg/Phase", [
        (3.002, {"header": header(3.002), "name": "climb"}),
    ]),
    "/autonomy/estimate": ("rosflight_log_msgs/msg/Estimate", [
        (3.002, {"header": header(3.002, "NED"), "position": [1.5, -2.5, -10.5], "velocity": [0.5, 0.25, -0.125],
                 "attitude": [0.5, -0.5, 0.5, 0.5], "gyro_bias": [f32(0.01), f32(0.02), f32(0.03)],
                 "accel_bias": [f32(0.1), f32(0.2), f32(0.3)], "wind": [4.5, -3.5], "airspeed": 15.5,
                 "course": -1.25, "position_sigma": [0.375, 0.5, 0.625],
                 "velocity_sigma": [0.0625, 0.03125, 0.015625],
                 "attitude_sigma": [f32(0.004), f32(0.005), f32(0.006)], "wind_sigma": [0.75, 0.875],
                 "innovation": ramp(0.25, 0.5, 9),
                 "refusing": [False, True, False, False, True, False, False, False, True]}),
    ]),
    "/tf": ("tf2_msgs/msg/TFMessage", [
        (3.000, {"transforms": [transform("NED", "body", (1.5, -2.5, -10.25), (0.5, 0.5, 0.5, 0.5), 3.000)]}),
    ]),
    "/tf_static": ("tf2_msgs/msg/TFMessage", [
        (3.004, {"transforms": [transform("map", "odom", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)),
                                transform("odom", "NED", (0.0, 0.0, 0.0), (HALF_SQRT2, HALF_SQRT2, 0.0, 0.0)),
                                transform("body", "base_link", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))]}),
    ]),
    # Forward is east, left is up: a quarter turn to the right about forward, which is x of both.
    "/sim/pose": ("geometry_msgs/msg/PoseStamped", [
        (3.000, {"header": header(3.000, "map"), "pose": {"position": xyz(-2.5, 1.5, 10.25),
                                                          "orientation": xyzw(HALF_SQRT2, 0.0, 0.0, HALF_SQRT2)}}),
    ]),
    "/sim/odometry": ("nav_msgs/msg/Odometry", [
        (3.000, {"header": header(3.000, "odom"), "child_frame_id": "base_link",
                 "pose": {"pose": {"position": xyz(-2.5, 1.5, 10.25),
                                   "orientation": xyzw(HALF_SQRT2, 0.0, 0.0, HALF_SQRT2)}, "covariance": covariance()},
                 "twist": {"twist": {"linear": xyz(3.5, -0.25, 0.125), "angular": xyz(0.1, -0.2, -0.3)},
                           "covariance": covariance()}}),
    ]),
    # Forward is up, left is north: nose up by a right angle from east; the velocity is 0.5 north, 0.25 east, 0.125 up.
    "/autonomy/odometry": ("nav_msgs/msg/Odometry", [
        (3.002, {"header": header(3.002, "odom"), "child_frame_id": "base_link",
                 "pose": {"pose": {"position": xyz(-2.5, 1.5, 10.5), "orientation": xyzw(0.0, -HALF_SQRT2, 0.0, HALF_SQRT2)},
                          "covariance": covariance(turned(ENU, (0.375, 0.5, 0.625)), turned(
                              multiplied(ENU, R_ESTIMATE), (f32(0.004), f32(0.005), f32(0.006))))},
                 "twist": {"twist": {"linear": xyz(0.125, 0.5, -0.25), "angular": xyz(0.0, 0.0, 0.0)},
                           "covariance": covariance(turned(multiplied(FLU, transposed(R_ESTIMATE)),
                                                           (0.0625, 0.03125, 0.015625)))}}),
    ]),
    "/autonomy/path": ("nav_msgs/msg/Path", [
        (3.004, {"header": header(3.004, "map"), "poses": [
            {"header": header(3.004, "map"), "pose": {"position": xyz(*p), "orientation": xyzw(0.0, 0.0, 0.0, 1.0)}}
            for p in ((2.5, 1.5, 3.5), (5.5, 4.5, 6.5))]}),
    ]),
    "/gnss/fix": ("sensor_msgs/msg/NavSatFix", [
        (1.018, {"header": header(1.0185, "base_link"), "status": {"status": 0, "service": 1}, "latitude": 40.267123456789,
                 "longitude": -111.635987654321, "altitude": 1387.5,
                 "position_covariance": [0.25, 0.0, 0.0, 0.0, 0.25, 0.0, 0.0, 0.0, 0.765625],
                 "position_covariance_type": 1}),
    ]),
    "/board/inputs": ("rosflight_log_msgs/msg/BoardInputs", [
        (3.004, {"header": header(3.005), "kind": bytes([0, 1, 2, 3, 4, 5, 6, 7, 8]), "delay_us": [0] * 8 + [2500],
                 "age_us": [0, 100, 0, 0, 20_000, 150_000, 0, 7, 0],
                 "values": [*ramp(1.5, 1.0, 18), 1.0, 3.0, 14.0, *ramp(19.5, 1.0, 9), 3.0, 0.0, 1.0, 0.25, 0.5, 0.75, 3.0],
                 "doubles": [40.267123456789, -111.635987654321, 1767225612.0, 345678901.0],
                 "bytes": bytes([0xFE, 0x00, 0xFF])}),
    ]),
    "/robot_description": ("std_msgs/msg/String", [(3.004, {"data": "<robot/>"})]),
    "/settings": ("std_msgs/msg/String", [(3.004, {"data": "type: multirotor\n"})]),
    "/parameters": ("rosflight_log_msgs/msg/Parameter", [
        (3.004, {"header": header(3.004), "name": "BATT_VOLT_MAX", "type": 9, "value": 23.5}),
    ]),
}
