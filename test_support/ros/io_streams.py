# SPDX-License-Identifier: BSD-3-Clause
"""Topics that rosflight_io publishes from what the firmware of a multirotor sends; all have a stamp."""

from geometry_msgs.msg import Vector3Stamped
from rosflight_msgs.msg import Attitude, Barometer, BatteryStatus, GNSS, OutputRaw, RCRaw, Status
from sensor_msgs.msg import Imu, MagneticField, Range, Temperature

STREAMS = {"imu/data": Imu, "imu/temperature": Temperature, "attitude": Attitude, "attitude/euler": Vector3Stamped,
           "magnetometer": MagneticField, "baro": Barometer, "range": Range, "rc_raw": RCRaw, "output_raw": OutputRaw,
           "gnss": GNSS, "battery": BatteryStatus, "status": Status}
