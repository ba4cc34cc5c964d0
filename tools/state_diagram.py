# SPDX-License-Identifier: BSD-3-Clause
"""Draws the safety state machine from its table into docs/state-machine.md.

Usage: state_diagram.py [--check]. Reads kTransitions in firmware/core/state_machine.hpp; --check writes nothing and
ends with 1 if the document is not up to date.
"""

import re
import sys
from dataclasses import dataclass

import project

TABLE = "firmware/core/state_machine.hpp"
DOCUMENT = "docs/state-machine.md"

ROW = re.compile(r"\{State::k(\w+),\s*Event::k(\w+),\s*Condition::k(\w+),\s*([^,]+?),\s*State::k(\w+)\}")
EVENTS = {"Initialized": "initialised", "RcFound": "RC found", "RcLost": "RC lost", "Error": "an error",
          "NoError": "no error", "Arm": "arm request", "ArmInAir": "arm request in the air",
          "Disarm": "disarm request", "CalibrationComplete": "calibration complete",
          "CalibrationFailed": "calibration failed", "Saved": "parameters stored",
          "SaveFailed": "storing failed", "MotorTest": "motor test request", "MotorTestEnd": "motor test over"}
CONDITIONS = {"Always": "", "NotReady": "a check refuses", "CalibrationWanted": "ARM_CAL_GYRO",
              "SaveWanted": "parameters not stored", "ErrorFlag": "error flag",
              "CannotFly": "no mixer, IMU or receiver"}
ACTIONS = {"None": "", "Arm": "arm", "InAir": "at once", "Disarm": "disarm", "FailsafeOn": "failsafe on",
           "FailsafeOff": "failsafe off", "ErrorOn": "flag on", "ErrorOff": "flag off", "SetRcLost": "set RC lost",
           "ClearRcLost": "clear RC lost", "CalibrateGyro": "calibrate gyro",
           "StopCalibration": "stop the calibration", "Save": "store the parameters", "Refuse": "refuse",
           "RefuseStorage": "refuse", "StopMotorTest": "motors off"}


@dataclass
class Row:
    state: str
    event: str
    condition: str
    actions: list[str]
    next: str


def words(table: dict[str, str], key: str) -> str:
    if key not in table:
        sys.exit(f"{TABLE}: found '{key}', allowed {', '.join(table)}")
    return table[key]


def read(text: str) -> list[Row]:
    """The rows of the table, in our words; ends with a line if one is not understood."""
    size = re.search(r"std::array<Transition, (\d+)> kTransitions", text)
    if size is None:
        sys.exit(f"{TABLE}: no kTransitions")
    rows = [Row(m[1], words(EVENTS, m[2]), words(CONDITIONS, m[3]),
                [w for a in re.findall(r"action::k(\w+)", m[4]) if (w := words(ACTIONS, a))], m[5])
            for m in ROW.finditer(text)]
    if len(rows) != int(size[1]):
        sys.exit(f"{TABLE}: found {len(rows)} rows that can be read, the table has {size[1]}")
    return rows


def label(row: Row) -> str:
    text = row.event + (f" [{row.condition}]" if row.condition else "")
    return text + (f" / {', '.join(row.actions)}" if row.actions else "")


def document(rows: list[Row]) -> str:
    lines = [
        "# The safety state machine", "",
        f"Made by `tools/state_diagram.py` from the table in `{TABLE}`; do not edit. Read a label as",
        "*event [condition] / what happens besides*. What is not drawn changes nothing. Errors never disarm; setting an",
        "error bit is the event *an error*, clearing the last one *no error*.", "",
        "```mermaid", "stateDiagram-v2", "    [*] --> Init"]
    lines += [f"    {row.state} --> {row.next}: {label(row)}" for row in rows if row.state != row.next]
    lines += ["```", "", "Within a state:", "", "| state | event | condition | what happens |", "|---|---|---|---|"]
    lines += [f"| {row.state} | {row.event} | {row.condition} | {', '.join(row.actions)} |"
              for row in rows if row.state == row.next]
    return "\n".join(lines) + "\n"


def main() -> int:
    made = document(read((project.ROOT / TABLE).read_text()))
    path = project.ROOT / DOCUMENT
    if sys.argv[1:] == ["--check"]:
        if path.exists() and path.read_text() == made:
            return 0
        print(f"{DOCUMENT}: not up to date; run tools/state_diagram.py", file=sys.stderr)
        return 1
    if sys.argv[1:]:
        print(__doc__.splitlines()[2], file=sys.stderr)
        return 2
    path.write_text(made)
    return 0


if __name__ == "__main__":
    sys.exit(main())
