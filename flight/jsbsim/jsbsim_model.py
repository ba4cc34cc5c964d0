# SPDX-License-Identifier: BSD-3-Clause
"""Writes a vehicle file as a JSBSim aircraft.

Usage: jsbsim_model.py VEHICLE.yaml FOLDER [KEY=VALUE...]

VEHICLE.yaml is a multirotor or fixed wing of vehicles/, KEY=VALUE an override as for --set. Writes
FOLDER/aircraft/NAME/NAME.xml, which JSBSim loads with FOLDER as its root. Written from the equations in
sim/multirotor/multirotor.hpp and sim/fixedwing/aerodynamics.hpp alone; air of constant density without wind, no ground,
a planet that neither turns nor curves within a flight.

Set rosflight/out-N to the firmware's outputs before each frame; rosflight/STATE-start to the states of the vehicle
before the first, with rosflight/hold at 1 while JSBSim settles the start.
"""

import math
import sys
from pathlib import Path

import yaml

from jsbsim_body import FT, LBF, SLUG, mass_balance, metrics, planet
from jsbsim_expression import Call, P, Table, clip, high, of, root, total

INCH = 0.0254
SLUG_FT3 = SLUG / FT ** 3
U, V, W = (P(f"velocities/{c}-fps") * FT for c in "uvw")
RATES = [P(f"velocities/{c}-rad_sec") for c in "pqr"]


class BadVehicle(Exception):
    """One line for a person."""


def load(path: Path) -> dict:
    """The file on top of what it extends."""
    data = yaml.safe_load(path.read_text())
    if "extends" not in data:
        return data
    base = load(path.parent / data.pop("extends"))
    return merge(base, data)


def merge(base, over):
    if not (isinstance(base, dict) and isinstance(over, dict)):
        return over
    return base | {key: merge(base[key], value) if key in base else value for key, value in over.items()}


def override(data: dict, assignment: str) -> None:
    key, _, value = assignment.partition("=")
    *way, last = key.split(".")
    for step in way:
        data = data[int(step)] if isinstance(data, list) else data.setdefault(step, {})
    data[int(last) if isinstance(data, list) else last] = yaml.safe_load(value)


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


class Model:
    """Collects the parts of an aircraft: control-system components in order, forces, axes of the aerodynamics."""

    def __init__(self, vehicle: dict):
        self.vehicle = vehicle
        atmosphere = vehicle["environment"]["atmosphere"]
        if atmosphere["model"] != "constant":
            raise BadVehicle(f"environment.atmosphere.model: found {atmosphere['model']}, allowed constant")
        self.density = float(atmosphere["density_kg_m3"])
        self.states: list[str] = []  # in the order of the module's
        self.properties: list[str] = ["rosflight/hold"] + [f"rosflight/out-{i}" for i in range(14)]
        self.components: list[str] = []
        self.rates: list[str] = []
        self.reactions: list[str] = []
        self.axes: dict[str, list] = {axis: [] for axis in ("X", "Y", "Z", "ROLL", "PITCH", "YAW")}

    # ---- control system: integrators first, then what follows from their states, then their rates

    def state(self, name: str) -> P:
        """A state of the vehicle, by Adams-Bashforth of the third order from the rates of past frames."""
        start, rate = f"rosflight/{name}-start", f"rosflight/{name}-rate"
        self.states.append(name)
        self.properties += [start]
        self.integrators = getattr(self, "integrators", [])
        self.integrators.append(
            f'<pid name="rosflight/{name}-change"><input>{rate}</input><kp>0</kp><ki type="ab3">1</ki><kd>0</kd>'
            "<trigger>rosflight/hold</trigger></pid>")
        self.integrators.append(_function(f"rosflight/{name}", P(start) + P(f"rosflight/{name}-change")))
        return P(f"rosflight/{name}")

    def let(self, name: str, formula) -> P:
        self.components.append(_function(f"rosflight/{name}", of(formula)))
        return P(f"rosflight/{name}")

    def rate(self, name: str, formula) -> P:
        return self.let(f"{name}-rate", formula)

    # ---- forces [N] and moments [N m] in body axes

    def push(self, name: str, position_m, direction, newtons) -> None:
        x, y, z = position_m
        self.reactions.append(
            f'<force name="{name}" frame="BODY"><function>{(newtons / LBF).xml()}</function>'
            f'<location unit="IN"><x>{-x / INCH!r}</x><y>{y / INCH!r}</y><z>{-z / INCH!r}</z></location>'
            f"{_direction(direction)}</force>")

    def twist(self, name: str, direction, newton_metres) -> None:
        self.reactions.append(f'<moment name="{name}" frame="BODY"><function>'
                              f"{(newton_metres / (LBF * FT)).xml()}</function>{_direction(direction)}</moment>")

    def force(self, axis: str, newtons) -> None:
        self.axes[axis].append(newtons / LBF)

    def moment(self, axis: str, newton_metres) -> None:
        self.axes[axis].append(newton_metres / (LBF * FT))

    def xml(self, name: str) -> str:
        body, wing = self.vehicle["body"], self.vehicle["aero"].get("wing", {})
        properties = "".join(f"<property value=\"0\">{p}</property>" for p in self.properties)
        axes = "".join(f'<axis name="{axis}">' + "".join(f"<function>{f.xml()}</function>" for f in terms) + "</axis>"
                       for axis, terms in self.axes.items() if terms)
        return f"""<?xml version="1.0"?>
<fdm_config name="{name}" version="2.0" release="BETA">
{planet(float(self.vehicle["environment"]["gravity_m_s2"]))}
{metrics(**{key: wing[key] for key in ("area_m2", "span_m", "chord_m") if key in wing})}
{mass_balance(body["mass_kg"], body["inertia_kg_m2"])}
<ground_reactions/>
<external_reactions>{"".join(self.reactions)}</external_reactions>
<propulsion/>
<flight_control name="rosflight">{properties}
<channel name="states">{"".join(self.integrators)}</channel>
<channel name="vehicle">{"".join(self.components)}</channel>
</flight_control>
<aerodynamics>{axes}</aerodynamics>
</fdm_config>
"""


def _function(name, formula) -> str:
    return f'<fcs_function name="{name}"><function>{formula.xml()}</function></fcs_function>\n'


def _direction(d) -> str:
    return f"<direction><x>{float(d[0])!r}</x><y>{float(d[1])!r}</y><z>{float(d[2])!r}</z></direction>\n"


def propulsion(model: Model) -> None:
    """Rotors, motors and battery: (1)-(5) of sim/multirotor/multirotor.hpp."""
    rotors, battery = model.vehicle["rotors"], model.vehicle["battery"]
    propeller, motor = rotors["propeller"], rotors["motor"]
    if motor["model"] != "electrical" or battery["model"] != "cells" or rotors.get("flow", "hub") != "hub":
        raise BadVehicle("rotors: found a motor, battery or flow of another model, allowed electrical, cells and hub")
    layout = rotors["layout"]
    count = range(len(layout))
    k, ohm, idle = motor["torque_constant_Nm_A"], motor["resistance_ohm"], motor["no_load_current_A"]
    most = motor.get("current_limit_A", 1e9)
    least = -most if motor.get("active_braking", True) else 0.0
    inertia, diameter = float(propeller["inertia_kg_m2"]), propeller["diameter_m"]
    speeds = [model.state(f"rotor-{i}") for i in count]
    charge = model.state("charge")

    duties = [model.let(f"duty-{i}", clip(P(f"rosflight/out-{r['output']}"), 0, 1)) for i, r in enumerate(layout)]
    curve = battery["open_circuit_cell_V"]
    full_As = 3600.0 * battery["capacity_Ah"]
    open_V = model.let("open-voltage", Table(charge, [full_As * i / (len(curve) - 1) for i in range(len(curve))],
                                             [battery["cells"] * v for v in curve]))
    own, inner = battery.get("avionics_current_A", 0.0), battery["resistance_ohm"]
    square = total(d * d for d in duties)
    product = total(d * s for d, s in zip(duties, speeds, strict=True))
    volts = model.let("voltage", (open_V - inner * (own - k / ohm * product)) / (1.0 + inner / ohm * square))
    amps = [model.let(f"current-{i}", clip((duties[i] * volts - k * speeds[i]) / ohm, least, most)) for i in count]
    model.rate("charge", -(own + total(d * a for d, a in zip(duties, amps, strict=True))))

    # The H-force of a rotor; fixed wings have none.
    h_share = model.vehicle["aero"].get("rotor_drag_s_m", 0.0)
    momenta = []
    for i, rotor in enumerate(layout):
        e = [float(x) for x in rotor["thrust_direction"]]
        p = [float(x) for x in rotor["position_m"]]
        spin = float(rotor["spin"])
        turning = cross(RATES, p)
        hub = [model.let(f"hub-{i}-{axis}", v + t) for axis, v, t in zip("xyz", (U, V, W), turning, strict=True)]
        along = model.let(f"inflow-{i}", total(h * c for h, c in zip(hub, e, strict=True)))
        u = along * (2.0 * math.pi / diameter)
        up = model.let(f"u-up-{i}", high(u, 0.0))
        slope = model.let(f"u-slope-{i}", high(u, -propeller.get("descent_limit", 0.12) * speeds[i]))
        ct, cq = propeller["thrust_coefficients"], propeller["torque_coefficients"]
        scale = model.density * diameter ** 4 / (2.0 * math.pi) ** 2

        def blades(c):
            return c[0] * speeds[i] * speeds[i] + c[1] * speeds[i] * slope + c[2] * up * up

        thrust = model.let(f"thrust-{i}", scale * blades(ct))
        torque = model.let(f"torque-{i}", scale * diameter * blades(cq))
        rate = model.rate(f"rotor-{i}", (k * (amps[i] - idle) - torque) / inertia)
        model.push(f"thrust-{i}", p, e, thrust)
        model.twist(f"reaction-{i}", e, spin * (torque + inertia * rate))
        if h_share:
            for axis, part, unit in zip("xyz", range(3), ((1, 0, 0), (0, 1, 0), (0, 0, 1)), strict=True):
                model.push(f"drag-{i}-{axis}", p, unit, -h_share * high(thrust, 0.0) * (hub[part] - along * e[part]))
        momenta.append([spin * inertia * c * speeds[i] for c in e])
    spinning = [total(m[axis] for m in momenta) for axis in range(3)]
    for axis, gyroscopic in zip(("ROLL", "PITCH", "YAW"), cross(RATES, spinning), strict=True):
        model.moment(axis, gyroscopic)


def multirotor(model: Model) -> None:
    aero = model.vehicle["aero"]
    if aero["ground_effect"] != "none":
        raise BadVehicle(f"aero.ground_effect: found {aero['ground_effect']}, allowed none")
    speed = root(U * U + V * V + W * W)
    for axis, v, area in zip("XYZ", (U, V, W), aero["drag_area_m2"], strict=True):
        model.force(axis, -0.5 * model.density * area * speed * v)


def servos(model: Model):
    """(1) and (2) of sim/fixedwing/fixedwing.hpp: aileron, elevator, rudder."""
    surfaces = model.vehicle["surfaces"]
    limit = math.radians(surfaces["rate_limit_deg_s"])
    sums: dict[str, list] = {"aileron": [], "elevator": [], "rudder": []}
    for i, surface in enumerate(surfaces["layout"]):
        angle = model.state(f"surface-{i}")
        command = math.radians(surface["travel_deg"]) * (2.0 * clip(P(f"rosflight/out-{surface['output']}"), 0, 1) - 1.0)
        model.rate(f"surface-{i}", clip((command - angle) / surfaces["time_constant_s"], -limit, limit))
        for kind, terms in sums.items():
            if surface.get(kind, 0.0):
                terms.append(float(surface[kind]) * angle)
    return (model.let(kind, total(terms)) for kind, terms in sums.items())


def fixed_wing(model: Model) -> None:
    """(1)-(7) of sim/fixedwing/aerodynamics.hpp, with JSBSim's own angles, dynamic pressure and reduced rates."""
    aero, wing = model.vehicle["aero"], model.vehicle["aero"]["wing"]
    if aero.get("model", "stall") != "stall":
        raise BadVehicle(f"aero.model: found {aero['model']}, allowed stall")
    aileron, elevator, rudder = servos(model)
    alpha, beta = P("aero/alpha-rad"), P("aero/beta-rad")
    pressure = P("aero/qbar-psf") * P("metrics/Sw-sqft")  # [lbf]
    p, r = (P(f"velocities/{c}-aero-rad_sec") * P("aero/bi2vel") for c in "pr")
    q = P("velocities/q-aero-rad_sec") * P("aero/ci2vel")
    sine, cosine = Call("sin", alpha), Call("cos", alpha)

    sharp, angle = aero["stall"]["sharpness_1_rad"], math.radians(aero["stall"]["angle_deg"])
    beyond, below = Call("exp", -sharp * (alpha - angle)), Call("exp", sharp * (alpha + angle))
    # The blend as the textbook has it, which is the same as (4).
    blend = (1.0 + beyond + below) / ((1.0 + beyond) * (1.0 + below))
    plate = 2.0 * sine * Call("abs", sine)
    lift, drag, pitch = aero["lift"], aero["drag"], aero["pitch"]
    linear = lift["zero"] + lift["alpha"] * alpha
    aspect = wing["span_m"] ** 2 / wing["area_m2"]
    c_l = ((1.0 - blend) * linear + blend * plate * cosine + lift["q"] * q + lift["elevator"] * elevator)
    c_d = (drag["parasitic"] + (1.0 - blend) * linear * linear / (math.pi * wing["oswald"] * aspect)
           + blend * plate * sine + drag["q"] * q + drag["elevator"] * elevator)
    c_m = ((1.0 - blend) * (pitch["zero"] + pitch["alpha"] * alpha)
           + blend * (pitch["alpha"] / lift["alpha"]) * plate + pitch["q"] * q + pitch["elevator"] * elevator)

    def lateral(c):
        return (c["zero"] + c["beta"] * beta + c["p"] * p + c["r"] * r + c["aileron"] * aileron
                + c["rudder"] * rudder)

    span, chord = P("metrics/bw-ft"), P("metrics/cbarw-ft")
    model.axes["X"].append(pressure * (c_l * sine - c_d * cosine))
    model.axes["Y"].append(pressure * lateral(aero["side"]))
    model.axes["Z"].append(-pressure * (c_d * sine + c_l * cosine))
    model.axes["ROLL"].append(pressure * span * lateral(aero["roll"]))
    model.axes["PITCH"].append(pressure * chord * c_m)
    model.axes["YAW"].append(pressure * span * lateral(aero["yaw"]))


def build(vehicle: dict) -> Model:
    model = Model(vehicle)
    kinds = {"multirotor": multirotor, "fixedwing": fixed_wing}
    if vehicle["type"] not in kinds:
        raise BadVehicle(f"type: found {vehicle['type']}, allowed {', '.join(sorted(kinds))}")
    propulsion(model)
    kinds[vehicle["type"]](model)
    return model


def write(model: Model, folder: Path, name: str) -> Path:
    file = folder / "aircraft" / name / f"{name}.xml"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(model.xml(name))
    return file


def main(words) -> int:
    if len(words) < 2:
        print(__doc__, file=sys.stderr)
        return 2
    path = Path(words[0])
    try:
        vehicle = load(path)
        for assignment in words[2:]:
            override(vehicle, assignment)
        print(write(build(vehicle), Path(words[1]), path.stem))
    except (BadVehicle, KeyError, OSError, yaml.YAMLError) as e:
        print(f"jsbsim_model: {path}: {' '.join(str(e).split())}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
