# SPDX-License-Identifier: BSD-3-Clause
"""The pass-through demonstration; ros_demo.py documents its use."""

import csv
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib
import rclpy
import yaml

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402
from ros_demo_rate import exit_code  # noqa: E402
from ros_rig import PROGRAM, ROOT, Rig, program, wait_for, write_parameters  # noqa: E402
from rosflight_msgs.msg import Status  # noqa: E402
from rosflight_msgs.srv import ParamFile  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402

NODE = program("rosflight_demos", "passthrough")
VEHICLE = ROOT / "vehicles" / "multirotor.yaml"
RATE_HZ = 400.0  # of the attitude that closes the loops
ARM_S, RELEASE_S = 20.0, 21.5  # the pilot's part, after everything has been set up


def frame_of(vehicle: dict) -> dict:
    """The frame file of ./rosflight mixer for the simulated vehicle."""
    rotors, battery = vehicle["rotors"], vehicle["battery"]
    layout = sorted(rotors["layout"], key=lambda rotor: rotor["output"])
    return {
        "num_motors": len(layout),
        "motor_positions": [x for rotor in layout for x in rotor["position_m"]],
        "motor_orientations": [float(x) for rotor in layout for x in rotor["thrust_direction"]],
        "motor_directions": [rotor["spin"] for rotor in layout],
        "air_density": 1.225,
        "prop_diameter": rotors["propeller"]["diameter_m"],
        "prop_ct": rotors["propeller"]["thrust_coefficients"][0],
        "prop_cq": rotors["propeller"]["torque_coefficients"][0],
        "vehicle_mass": vehicle["body"]["mass_kg"],
        "motor_resistance": rotors["motor"]["resistance_ohm"],
        "motor_kv": rotors["motor"]["torque_constant_Nm_A"],
        "no_load_current": rotors["motor"]["no_load_current_A"],
        "max_voltage": battery["cells"] * battery["open_circuit_cell_V"][-1],
    }


def parameters(folder: Path) -> Path:
    """Mixer parameters made by the tool, and the transmitter's as the vehicle has them."""
    vehicle = yaml.safe_load(VEHICLE.read_text())
    frame, file = folder / "frame.yaml", folder / "parameters.yaml"
    frame.write_text(yaml.safe_dump(frame_of(vehicle)))
    subprocess.run([PROGRAM, "mixer", "-f", frame, "-o", file, "-t", "PRI"], check=True, capture_output=True)
    made = {entry["name"]: entry["value"] for entry in yaml.safe_load(file.read_text())}
    radio = {name: value for name, value in vehicle["firmware"].items()
             if name.startswith(("RC_", "FAILSAFE", "BATT_", "TAKE"))}
    write_parameters(file, radio | made)
    return file


def pilot(folder: Path) -> Path:
    script = folder / "rc.yaml"
    script.write_text(f"""channels: {{arm: 4, attitude_override: 5, throttle_override: 5, attitude_mode: 6}}
start: {{throttle: 0.0, attitude_override: 1.0, attitude_mode: 1.0}}
events:
  - {{at_s: {ARM_S}, switch: arm, on: true}}
  - {{at_s: {RELEASE_S}, switch: attitude_override, on: false}}
""")
    return script


def fly(options, csv_file: Path):
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        rig = Rig(folder, "--rc", pilot(folder))
        try:
            status = rig.peer.listen(Status, "status")
            loaded = rig.peer.call(ParamFile, "param_load_from_file", filename=str(parameters(folder)))
            if not loaded.success:
                raise RuntimeError("parameters not taken: " + "; ".join(rig.io.lines[-5:]))
            calibrated = rig.peer.call(Trigger, "calibrate_imu")
            if not calibrated.success:
                raise RuntimeError(f"IMU calibration: {calibrated.message}")
            node = subprocess.Popen([NODE, str(options.seconds), csv_file], stderr=subprocess.PIPE, text=True)
            wait_for(lambda: status and status[-1][1].armed, "arming", lambda: rig.io.lines[-10:])
            _, err = node.communicate(timeout=options.seconds + 120)
            if node.returncode != 0:
                raise RuntimeError(err.strip() + "; " + "; ".join(rig.io.lines[-5:]))
        finally:
            rig.close()


def judge(csv_file: Path) -> dict:
    """Lag by the shift that fits best, and the error with and without it."""
    with csv_file.open() as lines:
        rows = [tuple(map(float, line)) for line in list(csv.reader(lines))[1:]]
    times, wanted, found = zip(*rows)
    step = (times[-1] - times[0]) / (len(times) - 1)

    def rms(shift):
        pairs = list(zip(wanted[:len(wanted) - shift], found[shift:]))
        return math.sqrt(sum((a - b) ** 2 for a, b in pairs) / len(pairs))
    most = min(int(0.5 / step), len(rows) // 2)
    lag = min(range(most), key=rms)
    return {"lag_s": lag * step, "rms_deg": math.degrees(rms(0)), "rms_without_lag_deg": math.degrees(rms(lag)),
            "samples": len(rows), "rate_hz": 1.0 / step}


def draw(csv_file: Path, told: dict, picture: Path):
    with csv_file.open() as lines:
        rows = [tuple(map(float, line)) for line in list(csv.reader(lines))[1:]]
    times, wanted, found = zip(*rows)
    figure, axes = pyplot.subplots(figsize=(10, 4.5), layout="constrained")
    axes.plot(times, [math.degrees(x) for x in wanted], label="setpoint", color="#e69f00")
    axes.plot(times, [math.degrees(x) for x in found], label="measured", color="#0072b2")
    axes.set(title=f"Roll through pass-through at {told['rate_hz']:.0f} Hz: lag {1000 * told['lag_s']:.0f} ms, "
                   f"error {told['rms_deg']:.2f}° rms ({told['rms_without_lag_deg']:.2f}° without the lag)",
             xlabel="time [s]", ylabel="roll [°]")
    axes.legend()
    axes.grid(alpha=0.3)
    figure.savefig(picture, dpi=120)
    pyplot.close(figure)


def run(options) -> int:
    rclpy.init()
    csv_file = options.out / "passthrough.csv"
    try:
        fly(options, csv_file)
    except (RuntimeError, AssertionError, subprocess.SubprocessError) as error:
        print(f"rosflight: {error}", file=sys.stderr)
        return 1
    finally:
        rclpy.try_shutdown()
    told = judge(csv_file)
    draw(csv_file, told, options.out / "passthrough.png")
    (options.out / "passthrough.json").write_text(json.dumps(told, indent=2) + "\n")
    if options.json:
        print(json.dumps(told, indent=2))
    else:
        print(f"roll follows {1000 * told['lag_s']:.0f} ms late; error {told['rms_deg']:.2f} deg rms, "
              f"{told['rms_without_lag_deg']:.2f} deg without the lag; {told['samples']} samples at {told['rate_hz']:.0f} Hz")
        print(f"plot, CSV and JSON are in {options.out}")
    return exit_code([("passthrough", told["rate_hz"], RATE_HZ)])
