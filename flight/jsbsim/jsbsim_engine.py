# SPDX-License-Identifier: BSD-3-Clause
"""Moves a rigid body with JSBSim, in lock-step with jsbsim_engine.cpp, which starts it.

Commands are single bytes on COMMANDS: b begins with the body described in the block of memory that both share, s sets the
state, m moves by one step. After each the answer r on ANSWERS says that the block holds the new state; e, that it holds an
error and this program ends. It ends as well when COMMANDS is closed.

JSBSim keeps its own equations of motion, gravity and mass properties; its planet neither turns nor, with a radius of 1e9 m,
curves. Earth-fixed and inertial axes are the same then, and at latitude and longitude 0 north is z, east is y, down is -x.
The load of a step enters as external reactions: the force in inertial axes, the torque in body axes.
"""

import mmap
import os
import sys
import tempfile
from math import asin, atan2, sqrt
from pathlib import Path

from jsbsim_body import FLAT_RADIUS_M, FT, LBF, mass_balance, metrics, planet

COMMANDS, ANSWERS, BLOCK = 3, 4, 5
# Numbers of the block, in its order: all are float64.
MASS, INERTIA, GRAVITY, STEP, FORCE, TORQUE, STATE, END = 0, 1, 7, 8, 9, 12, 15, 33
POSITION, ROTATION, VELOCITY, RATES = 15, 18, 27, 30  # of the state: p_W, R_WB row by row, v_B, w_B
ERROR_BYTES = 256

# Orders of JSBSim's schemes. A load that is held makes the first order exact for the velocity; the attitude follows rates
# and accelerations to second order, the position the velocities of two frames.
EULER, ADAMS_BASHFORTH_2, BUSS_2 = 1, 3, 7
SCHEMES = {"rate/rotational": EULER, "rate/translational": EULER, "position/rotational": BUSS_2,
           "position/translational": ADAMS_BASHFORTH_2}
POUND_FEET = LBF * FT


def reaction(kind: str, name: str, frame: str, axis: int) -> str:
    direction = "".join(f"<{c}>{int(i == axis)}</{c}>" for i, c in enumerate("xyz"))
    location = '<location unit="IN"><x>0</x><y>0</y><z>0</z></location>' if kind == "force" else ""
    return (f'<{kind} name="{name}" frame="{frame}"><function><property>rosflight/{name}</property></function>'
            f"{location}<direction>{direction}</direction></{kind}>")


def aircraft(mass_kg: float, inertia_kg_m2: dict, gravity_m_s2: float) -> str:
    names = [f"{kind}-{c}" for kind in ("force", "torque") for c in "xyz"]
    reactions = "".join(reaction("force", f"force-{c}", "INERTIAL", i) for i, c in enumerate("xyz"))
    reactions += "".join(reaction("moment", f"torque-{c}", "BODY", i) for i, c in enumerate("xyz"))
    properties = "".join(f'<property value="0">rosflight/{name}</property>' for name in names)
    return f"""<?xml version="1.0"?>
<fdm_config name="body" version="2.0" release="BETA">
{planet(gravity_m_s2)}{metrics()}{mass_balance(mass_kg, inertia_kg_m2)}
<ground_reactions/>
<external_reactions>{properties}{reactions}</external_reactions>
<propulsion/><aerodynamics><axis name="X"/><axis name="ROLL"/></aerodynamics>
</fdm_config>
"""


class Body:
    """A rigid body in JSBSim."""

    def __init__(self, numbers):
        os.environ["OPENBLAS_NUM_THREADS"] = "1"  # numpy's, which JSBSim imports: idle threads take long to start
        import jsbsim  # here, so that an environment without it is an error that reaches a person

        jsbsim.FGJSBBase().debug_lvl = 0
        inertia = dict(zip(("xx", "yy", "zz", "xy", "xz", "yz"), numbers[INERTIA:GRAVITY], strict=True))
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "aircraft", "body", "body.xml")
            file.parent.mkdir(parents=True)
            file.write_text(aircraft(numbers[MASS], inertia, numbers[GRAVITY]))
            self.fdm = jsbsim.FGFDMExec(folder)
            if not self.fdm.load_model("body"):
                raise RuntimeError("JSBSim does not load the body")
        self.fdm["simulation/gravity-model"] = 0  # a sphere
        for integrator, scheme in SCHEMES.items():
            self.fdm[f"simulation/integrator/{integrator}"] = scheme
        self.step_s = 0.0
        self.propagate = self.fdm.get_propagate()
        node = self.fdm.get_property_manager().get_node
        self.force = [node(f"rosflight/force-{c}") for c in "xyz"]
        self.torque = [node(f"rosflight/torque-{c}") for c in "xyz"]
        self.places = [node(f"position/eci-{c}-ft") for c in "xyz"]
        self.velocities = [node(f"velocities/{c}-fps") for c in "uvw"]
        self.rates = [node(f"velocities/{c}-rad_sec") for c in "pqr"]
        self.radius_ft = FLAT_RADIUS_M / FT

    def set_state(self, numbers) -> None:
        north, east, down = numbers[POSITION:ROTATION]
        r = numbers[ROTATION:VELOCITY]
        fdm, up = self.fdm, FLAT_RADIUS_M - down
        radius = sqrt(up * up + east * east + north * north)
        fdm["ic/lat-geod-rad"], fdm["ic/long-gc-rad"] = asin(north / radius), atan2(east, up)
        fdm["ic/h-sl-ft"] = (radius - FLAT_RADIUS_M) / FT
        fdm["ic/phi-rad"], fdm["ic/theta-rad"] = atan2(r[7], r[8]), asin(max(-1.0, min(1.0, -r[6])))
        fdm["ic/psi-true-rad"] = atan2(r[3], r[0])
        for name, value in zip("uvw", numbers[VELOCITY:RATES], strict=True):
            fdm[f"ic/{name}-fps"] = value / FT
        for name, value in zip("pqr", numbers[RATES:END], strict=True):
            fdm[f"ic/{name}-rad_sec"] = value
        fdm.run_ic()
        self.read(numbers)

    def move(self, numbers) -> None:
        fdm = self.fdm
        if numbers[STEP] != self.step_s:
            self.step_s = numbers[STEP]
            fdm.set_dt(self.step_s)
        north, east, down = numbers[FORCE:TORQUE]
        for node, newtons in zip(self.force, (-down, east, north), strict=True):
            node.set_double_value(newtons / LBF)
        for node, newton_metres in zip(self.torque, numbers[TORQUE:STATE], strict=True):
            node.set_double_value(newton_metres / POUND_FEET)
        # A frame first moves the body by the accelerations of the frame before, then finds new ones: those of this load
        # are found in a frame that does not move.
        fdm.suspend_integration()
        fdm.run()
        fdm.resume_integration()
        fdm.run()
        self.read(numbers)

    def read(self, numbers) -> None:
        x, y, z = [node.get_double_value() for node in self.places]
        numbers[POSITION], numbers[POSITION + 1], numbers[POSITION + 2] = z * FT, y * FT, (self.radius_ft - x) * FT
        for i, (x, y, z) in enumerate(self.propagate.get_Tec2b().tolist()):  # axes of the body, in those of the earth
            numbers[ROTATION + i], numbers[ROTATION + 3 + i], numbers[ROTATION + 6 + i] = z, y, -x
        for i in range(3):
            numbers[VELOCITY + i] = self.velocities[i].get_double_value() * FT
            numbers[RATES + i] = self.rates[i].get_double_value()


def main() -> int:
    memory = mmap.mmap(BLOCK, 8 * END + ERROR_BYTES)
    numbers = memoryview(memory)[:8 * END].cast("d")
    try:
        body = None
        while command := os.read(COMMANDS, 1):
            if command == b"b":
                body = Body(numbers)
            elif command == b"s":
                body.set_state(numbers)
            else:
                body.move(numbers)
            os.write(ANSWERS, b"r")
    except Exception as error:  # whatever it is, the flight ends with this line
        text = " ".join(f"{type(error).__name__}: {error}".split()).encode()[:ERROR_BYTES - 1]
        memory[8 * END:8 * END + len(text) + 1] = text + b"\0"
        os.write(ANSWERS, b"e")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
