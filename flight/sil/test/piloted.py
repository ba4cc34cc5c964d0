# SPDX-License-Identifier: BSD-3-Clause
"""A firmware in its own process with a pilot's script around it, and what its link said, by the time of the board.

The script runs from the start of the process, so parameters are written into its memory by a process before it:
nothing then depends on how fast the ground tool is. Waits are for the board's time; wall time only ends a test whose
firmware no longer sends.
"""

import math
import time
from dataclasses import dataclass
from pathlib import Path

from ground_tool import DIALECT, INT32, TIMEOUT_S, REAL32, Connected, decoded

# A quadrotor that arms by a switch on channel 4; a bias that is not zero says that the IMU is calibrated.
PARAMETERS = {
    "PRIMARY_MIXER": 2, "RC_NUM_CHN": 8, "RC_ARM_CHN": 4, "RC_ATT_OVRD_CHN": 5, "RC_THR_OVRD_CHN": 5,
    "RC_ATT_CTRL_CHN": 6, "FAILSAFE_THR": 0.3, "BATT_VOLT_MAX": 25.2, "ACC_X_BIAS": 0.001, "ARM_CAL_GYRO": 0,
    "PID_ROLL_ANG_P": 1.0, "PID_ROLL_ANG_I": 1.0, "PID_ROLL_ANG_D": 0.14,
    "PID_PITCH_ANG_P": 1.0, "PID_PITCH_ANG_I": 1.0, "PID_PITCH_ANG_D": 0.14, "PID_YAW_RATE_P": 0.5,
}
HOVER = 0.72  # throttle stick that carries the default multirotor


@dataclass
class Said:
    """A message and the stamp of the newest IMU sample before it."""
    t_s: float
    message: object


class Piloted(Connected):
    """With-block of a running firmware; `events` are lines of a pilot's script (sim/rc/script.hpp)."""

    def __init__(self, folder: Path, events, parameters=None, rate_Hz=50, options=()):
        write_parameters(folder, {**PARAMETERS, **(parameters or {})})
        script = folder / "pilot.yaml"
        script.write_text(f"rate_Hz: {rate_Hz}\nstart: {{attitude_mode: 1}}\nevents:\n"
                          + "".join(f"  - {{{event}}}\n" for event in events))
        super().__init__("pty", folder, "--rc", script, *options)
        self.said: list[Said] = []
        self.now_s = 0.0

    def __enter__(self):
        super().__enter__()
        return self

    # ---- listening

    def listen(self):
        """Takes what has arrived. @returns the new messages."""
        self.ground.receive()
        new = []
        for message in self.ground.waiting:
            if message.get_type() == "SMALL_IMU":
                self.now_s = message.time_boot_us * 1e-6
            new.append(Said(self.now_s, message))
        self.ground.waiting.clear()
        self.said += new
        return new

    def wait(self, accept, limit_s):
        """The first of the messages to come that is accepted; None after `limit_s` of the board's time."""
        end_s = self.now_s + limit_s
        received = time.monotonic()
        while self.now_s < end_s:
            new = self.listen()
            if new:
                received = time.monotonic()
            assert time.monotonic() - received < TIMEOUT_S, "the firmware sends nothing"
            for said in new:
                if said.t_s <= end_s and accept(said.message):
                    return said
        return None

    def until(self, t_s, every_s=math.inf, send=None):
        """Waits for a time of the board and calls `send` every so often."""
        due_s = self.now_s
        while self.now_s < t_s:
            if send is not None and self.now_s >= due_s:
                send()
                due_s = self.now_s + every_s
            self.wait(lambda _: True, 0.005)

    def run_for(self, duration_s, every_s=math.inf, send=None):
        self.until(self.now_s + duration_s, every_s, send)

    def until_armed(self, limit_s=15.0):
        said = self.wait(lambda m: m.get_type() == "ROSFLIGHT_STATUS" and m.armed, limit_s)
        assert said is not None, f"not armed; texts: {self.texts()}"
        return said.t_s

    # ---- what was said

    def of(self, kind, since_s=0.0, until_s=math.inf):
        return [said for said in self.said if said.message.get_type() == kind and since_s <= said.t_s <= until_s]

    def texts(self, part="", since_s=0.0):
        found = (said.message.text for said in self.of("STATUSTEXT", since_s))
        return [text for text in found if part in text]

    def armed_changes(self):
        """[(t_s, armed)], beginning with the first status."""
        changes = []
        for said in self.of("ROSFLIGHT_STATUS"):
            if not changes or changes[-1][1] != bool(said.message.armed):
                changes.append((said.t_s, bool(said.message.armed)))
        return changes

    def outputs(self, since_s=0.0, until_s=math.inf):
        """[(t_s, values)]"""
        return [(said.t_s, list(said.message.values))
                for said in self.of("ROSFLIGHT_OUTPUT_RAW", since_s, until_s)]

    # ---- speaking

    def heartbeat(self):
        self.ground.mav.heartbeat_send(6, 0, 0, 0, 0, 2)

    def set(self, name, value):
        """Sets a parameter. @returns the value of the answer."""
        self.ground.set(name, value, kind_of(value))
        return self._answer(name)

    def value(self, name):
        self.ground.mav.param_request_read_send(1, 1, name.encode(), -1)
        return self._answer(name)

    def _answer(self, name):
        said = self.wait(lambda m: m.get_type() == "PARAM_VALUE" and m.param_id == name, 5.0)
        assert said is not None, f"no answer about {name}"
        return decoded(said.message)

    def offboard(self, mode, values, ignore=0):
        self.ground.mav.offboard_control_send(mode, ignore, list(values) + [0.0] * (10 - len(values)))

    def auxiliary(self, entries):
        """`entries`: channel: (kind, value)."""
        kinds, values = [0] * 14, [0.0] * 14
        for channel, (kind, value) in entries.items():
            kinds[channel], values[channel] = kind, value
        self.ground.mav.rosflight_aux_cmd_send(kinds, values)


AUX_MOTOR = DIALECT.MOTOR if hasattr(DIALECT, "MOTOR") else 2


def kind_of(value):
    return INT32 if isinstance(value, int) else REAL32


def write_parameters(folder, parameters):
    """Into the memory of the processes to come."""
    with Connected("tcp", folder) as ground:
        for name, value in parameters.items():
            ground.set(name, value, kind_of(value))
            answer = ground.expect("PARAM_VALUE", lambda m, name=name: m.param_id == name)
            assert answer is not None and math.isclose(decoded(answer), value, rel_tol=1e-6), name
        assert ground.command(DIALECT.ROSFLIGHT_CMD_WRITE_PARAMS)
