#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Usage: init_firmware FILE | init_firmware --vehicle VEHICLE_FILE

Loads firmware parameters through rosflight_io, calibrates the IMU and stores: each step when the one
before has answered. The second form takes the section `firmware` of a vehicle file, defaults for the rest. The names are relative, so it works in a namespace. Ends with 0 when all is done.
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import rclpy
from rclpy.utilities import remove_ros_args
from rosflight_msgs.srv import ParamFile
from std_srvs.srv import Trigger

TIMEOUT_S = 60.0
TRY_AGAIN_S = 0.5


def call(node, kind, name, **fields):
    """The answer of a service, waited for."""
    client = node.create_client(kind, name)
    if not client.wait_for_service(timeout_sec=TIMEOUT_S):
        raise RuntimeError(f"{name}: found no such service, allowed with rosflight_io running")
    future = client.call_async(kind.Request(**fields))
    rclpy.spin_until_future_complete(node, future, timeout_sec=TIMEOUT_S)
    if not future.done():
        raise RuntimeError(f"{name}: no answer in {TIMEOUT_S:.0f} s")
    node.destroy_client(client)
    return future.result()


def demand(node, kind, name, **fields):
    answer = call(node, kind, name, **fields)
    text = getattr(answer, "message", "")
    node.get_logger().info(f"{name}: {'done' if answer.success else 'failed'} {text}")
    if not answer.success:
        raise RuntimeError(f"{name} failed {text}")


def initialise(node, file):
    end = time.monotonic() + TIMEOUT_S
    while not call(node, Trigger, "all_params_received").success:
        if time.monotonic() > end:
            raise RuntimeError("the firmware's parameters have not arrived")
        time.sleep(TRY_AGAIN_S)
    demand(node, ParamFile, "param_load_from_file", filename=file)
    demand(node, Trigger, "calibrate_imu")
    demand(node, Trigger, "param_write")


def parameters_of(vehicle_file, folder):
    """The parameter file of a vehicle file, made in the folder; says why not on stderr and ends."""
    made = Path(folder, "firmware.yaml")
    done = subprocess.run([Path(__file__).resolve().parent / "vehicle_firmware", vehicle_file, made], check=False)
    if done.returncode != 0:
        sys.exit(done.returncode)
    return str(made)


def main():
    words = remove_ros_args(sys.argv)[1:]
    if len(words) == 2 and words[0] == "--vehicle":
        with tempfile.TemporaryDirectory() as folder:
            return run(parameters_of(words[1], folder))
    if len(words) != 1:
        print(f"init_firmware: found {len(words)} files, allowed one", file=sys.stderr)
        return 2
    return run(words[0])


def run(file):
    rclpy.init()
    node = rclpy.create_node("init_firmware")
    try:
        initialise(node, file)
    except RuntimeError as why:
        node.get_logger().error(str(why))
        return 1
    finally:
        node.destroy_node()
        rclpy.shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
