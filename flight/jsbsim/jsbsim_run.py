# SPDX-License-Identifier: BSD-3-Clause
"""Flies a recorded flight in JSBSim and in our simulator, in open loop."""

import subprocess
from pathlib import Path

import jsbsim
import numpy as np

import jsbsim_model
from jsbsim_body import FLAT_RADIUS_M, FT
from jsbsim_model import SLUG_FT3

HOLD_S = 2.5e-3
ADAMS_BASHFORTH_4 = 5
BODY_NUMBERS = 13


def rotation(roll, pitch, yaw):
    """Body to north-east-down; arrays of angles give an array of matrices."""
    c, s = np.cos, np.sin
    rows = [[c(pitch) * c(yaw), s(roll) * s(pitch) * c(yaw) - c(roll) * s(yaw),
             c(roll) * s(pitch) * c(yaw) + s(roll) * s(yaw)],
            [c(pitch) * s(yaw), s(roll) * s(pitch) * s(yaw) + c(roll) * c(yaw),
             c(roll) * s(pitch) * s(yaw) - s(roll) * c(yaw)],
            [-s(pitch), s(roll) * c(pitch), c(roll) * c(pitch)]]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def rotation_of_quaternion(q):
    w, x, y, z = np.moveaxis(np.asarray(q), -1, 0)
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


class Track:
    """Position [m] and velocity [m/s] in N, attitude as matrices, rates [rad/s], every 2.5 ms."""

    def __init__(self, position, attitude, velocity, rates):
        self.position, self.attitude, self.velocity, self.rates = position, attitude, velocity, rates

    def away_from(self, other) -> dict:
        """Distances to another track at each time."""
        turn = np.einsum("nji,njk->nik", self.attitude, other.attitude)
        # The angle of a small rotation, from its antisymmetric part: the trace would lose half the digits.
        axis = 0.5 * np.stack([turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0],
                               turn[:, 1, 0] - turn[:, 0, 1]], axis=1)
        length = np.linalg.norm
        return {"position_m": length(self.position - other.position, axis=1),
                "velocity_m_s": length(self.velocity - other.velocity, axis=1),
                "attitude_rad": np.arcsin(np.minimum(1.0, length(axis, axis=1))),
                "rates_rad_s": length(self.rates - other.rates, axis=1)}


def our_track(program: Path, vehicle: Path, folder: Path, parts: int, overrides) -> Track:
    out = folder / f"ours_{parts}.csv"
    subprocess.run([program, "replay", vehicle, folder, str(parts), out, *overrides], check=True)
    rows = np.loadtxt(out, delimiter=",")
    attitude = rotation_of_quaternion(rows[:, 4:8])
    velocity = np.einsum("nij,nj->ni", attitude, rows[:, 8:11])
    return Track(rows[:, 1:4], attitude, velocity, rows[:, 11:14])


def jsbsim_track(model: jsbsim_model.Model, folder: Path, parts: int) -> Track:
    """`parts` frames for each held output."""
    jsbsim_model.write(model, folder, "vehicle")
    start = np.loadtxt(folder / "start.csv", delimiter=",")
    outputs = np.loadtxt(folder / "outputs.csv", delimiter=",")
    jsbsim.FGJSBBase().debug_lvl = 0
    fdm = jsbsim.FGFDMExec(str(folder))
    fdm.set_dt(HOLD_S / parts)  # before loading: its components remember it
    if not fdm.load_model("vehicle"):
        raise RuntimeError("JSBSim does not load the model")
    fdm["simulation/gravity-model"] = 0  # a sphere
    for integrator in ("rate/rotational", "rate/translational", "position/rotational", "position/translational"):
        fdm[f"simulation/integrator/{integrator}"] = ADAMS_BASHFORTH_4
    fdm["atmosphere/override/density"] = model.density / SLUG_FT3
    for name, value in zip(model.states, start[BODY_NUMBERS:], strict=True):
        fdm[f"rosflight/{name}-start"] = value

    def set_outputs(row):
        for i, value in enumerate(row):
            fdm[f"rosflight/out-{i}"] = value

    attitude = rotation_of_quaternion(start[3:7])
    fdm["ic/lat-geod-rad"], fdm["ic/long-gc-rad"] = start[0] / FLAT_RADIUS_M, start[1] / FLAT_RADIUS_M
    fdm["ic/h-sl-ft"] = -start[2] / FT
    fdm["ic/phi-rad"] = np.arctan2(attitude[2, 1], attitude[2, 2])
    fdm["ic/theta-rad"] = np.arcsin(-attitude[2, 0])
    fdm["ic/psi-true-rad"] = np.arctan2(attitude[1, 0], attitude[0, 0])
    for name, value in zip("uvw", start[7:10], strict=True):
        fdm[f"ic/{name}-fps"] = value / FT
    for name, value in zip("pqr", start[10:13], strict=True):
        fdm[f"ic/{name}-rad_sec"] = value
    set_outputs(outputs[0])
    fdm["rosflight/hold"] = 1
    fdm.run_ic()
    fdm.run_ic()  # the schemes of the vehicle's states remember two frames, and the first saw no rates
    fdm["rosflight/hold"] = 0

    names = ["position/lat-geod-rad", "position/long-gc-rad", "position/h-sl-ft", "attitude/phi-rad",
             "attitude/theta-rad", "attitude/psi-rad", "velocities/u-fps", "velocities/v-fps", "velocities/w-fps",
             "velocities/p-rad_sec", "velocities/q-rad_sec", "velocities/r-rad_sec"]
    rows = [[fdm[name] for name in names]]
    for k in range(len(outputs)):
        for part in range(parts):
            # A frame moves the state with what it felt at its beginning, then looks at the outputs. Where they jump
            # it sees the mean of both sides: an Adams-Bashforth scheme takes a jump half a frame too early.
            if part == parts - 1 and k + 1 < len(outputs):
                set_outputs(0.5 * (outputs[k] + outputs[k + 1]))
            elif part == 0 and k > 0:
                set_outputs(outputs[k])
            fdm.run()
        rows.append([fdm[name] for name in names])
    rows = np.array(rows)
    attitude = rotation(rows[:, 3], rows[:, 4], rows[:, 5])
    position = np.stack([rows[:, 0] * FLAT_RADIUS_M, rows[:, 1] * FLAT_RADIUS_M, -rows[:, 2] * FT], axis=1)
    velocity = np.einsum("nij,nj->ni", attitude, rows[:, 6:9] * FT)
    return Track(position, attitude, velocity, rows[:, 9:12])
