#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Usage: init_firmware FILE [--wait | --fly]
       init_firmware --vehicle VEHICLE_FILE [--wait | --fly]

Loads firmware parameters through rosflight_io, calibrates the IMU and stores: each step when the one before has answered. The
second form takes the section `firmware` of a vehicle file, defaults for the rest. The names are relative, so it works in a
namespace. Ends with 0 when all is done.

  --wait   and then waits until the flight controller has no error: the vehicle can be armed
  --fly    and then arms and lets go of the override, by the services of the simulated pilot
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import rclpy
from rclpy.utilities import remove_ros_args
from rosflight_msgs.msg import Status
from rosflight_msgs.srv import ParamFile
from std_srvs.srv import Trigger

TIMEOUT_S = 60.0
FIRST_ANSWER_S = 5.0
SAY_AGAIN_S = 10.0


class Vehicle:
    """The flight controller by its status and the services of rosflight_io and of the simulated pilot.

    Times to wait are the flight controller's, by the stamps of its status: in simulated time a busy machine makes it slow. They are the
    wall's since the last status while none comes.
    """

    SERVICES = {"all_params_received": Trigger, "param_load_from_file": ParamFile, "calibrate_imu": Trigger, "param_write": Trigger,
                "toggle_arm": Trigger, "toggle_override": Trigger}
    PILOT_HOLDS = Status.OVERRIDE_ATT_SWITCH | Status.OVERRIDE_THR_SWITCH
    FOLLOWS_S = 5.0
    TRIES = 5  # odd: each turns the switch over

    def __init__(self, node):
        self.node, self.status, self.last_s = node, None, time.monotonic()
        node.create_subscription(Status, "status", self.on_status, 1)
        # All now: rmw_fastrtps drops the answer to a client that the server has known for too short a time.
        self.clients = {name: node.create_client(kind, name) for name, kind in self.SERVICES.items()}

    def on_status(self, message):
        self.status, self.last_s = message, time.monotonic()

    def within(self, seconds, done):
        """Whether it is done within the time."""
        start, self.last_s = None, time.monotonic()
        while not done():
            rclpy.spin_once(self.node, timeout_sec=0.1)
            now = self.status and self.status.header.stamp.sec + 1e-9 * self.status.header.stamp.nanosec
            if start is None or now < start:  # it may have been started again
                start = now
            if start is not None and now - start > seconds or time.monotonic() - self.last_s > seconds:
                return False
        return True

    def ask(self, name, seconds, **fields):
        """The answer of a service; None: it did not come within the time."""
        client = self.clients[name]
        if not client.wait_for_service(timeout_sec=TIMEOUT_S):
            raise RuntimeError(f"{name}: found no such service, allowed with rosflight_io running")
        future = client.call_async(client.srv_type.Request(**fields))
        return future.result() if self.within(seconds, future.done) else None

    def call(self, name, **fields):
        answer = self.ask(name, TIMEOUT_S, **fields)
        if answer is None:
            raise RuntimeError(f"{name}: no answer in {TIMEOUT_S:.0f} s")
        return answer

    def has_all_parameters(self):
        """The first question of all: its answer may be lost on a busy machine while the two ends hardly know each other."""
        answer = self.ask("all_params_received", FIRST_ANSWER_S)
        return answer is not None and answer.success

    def demand(self, name, **fields):
        answer = self.call(name, **fields)
        text = getattr(answer, "message", "")
        self.node.get_logger().debug(f"{name}: {'done' if answer.success else 'failed'} {text}")
        if not answer.success:
            raise RuntimeError(f"{name} failed {text}")

    def initialise(self, file):
        if not self.within(TIMEOUT_S, self.has_all_parameters):
            raise RuntimeError("the firmware's parameters have not arrived")
        self.demand("param_load_from_file", filename=file)
        self.demand("calibrate_imu")
        self.demand("param_write")
        self.node.get_logger().info("parameters loaded, IMU calibrated, all stored")

    def becomes(self, condition, seconds):
        """Whether a status that comes now fulfils the condition within the time."""
        self.status = None
        return self.within(seconds, lambda: self.status is not None and condition(self.status))

    def wait(self):
        """As long as it takes; says now and then what it waits for."""
        while not self.becomes(lambda status: status.error_code == 0, SAY_AGAIN_S):
            found = "no status" if self.status is None else f"error_code 0x{self.status.error_code:02x} in its status"
            self.node.get_logger().warning(f"waits for a flight controller without errors, found {found}")

    def fly(self):
        self.wait()
        self.switch("toggle_arm", lambda status: status.armed, "armed")
        self.switch("toggle_override", lambda status: not status.rc_override & self.PILOT_HOLDS, "the autopilot has control")

    def switch(self, service, condition, text):
        """Flips a switch of the pilot until the flight controller follows: it does not arm with the throttle up, or errors."""
        for _ in range(self.TRIES):
            self.call(service)
            if self.becomes(condition, self.FOLLOWS_S):
                self.node.get_logger().info(text)
                return
        raise RuntimeError(f"{service}: the flight controller does not follow")


def parameters_of(vehicle_file, folder):
    """The parameter file of a vehicle file, made in the folder; says why not on stderr and ends."""
    made = Path(folder, "firmware.yaml")
    done = subprocess.run([Path(__file__).resolve().parent / "vehicle_firmware", vehicle_file, made], check=False)
    if done.returncode != 0:
        sys.exit(done.returncode)
    return str(made)


def main():
    words = remove_ros_args(sys.argv)[1:]
    then = [word for word in words if word in ("--wait", "--fly")]
    words = [word for word in words if word not in then]
    if len(then) > 1 or len(words) != (2 if words[:1] == ["--vehicle"] else 1):
        print(f"init_firmware: found {len(words)} files, allowed one, or --vehicle and one; then --wait or --fly", file=sys.stderr)
        return 2
    if len(words) == 1:
        return run(words[0], then)
    with tempfile.TemporaryDirectory() as folder:
        return run(parameters_of(words[1], folder), then)


def run(file, then):
    print("not ready: loads the firmware's parameters, calibrates its IMU, stores", flush=True)  # before it is seen in the graph
    rclpy.init()
    node = rclpy.create_node("init_firmware")
    try:
        vehicle = Vehicle(node)
        vehicle.initialise(file)
        if then:
            getattr(vehicle, then[0].removeprefix("--"))()
    except RuntimeError as why:
        node.get_logger().error(str(why))
        return 1
    finally:
        node.destroy_node()
        rclpy.shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
