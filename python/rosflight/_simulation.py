# SPDX-License-Identifier: BSD-3-Clause
"""A vehicle in a closed loop without a mission: the caller is companion and pilot."""

from __future__ import annotations

import functools
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Union

import numpy as np

from . import _arguments as arguments
from . import _core
from ._flight import SEVERITIES, STEPS_PER_SECOND, Note

Array = np.ndarray[Any, np.dtype[np.float64]]
Number = Union[float, "np.floating[Any]"]
SimulationError = _core.SimulationError


@dataclass(frozen=True)
class Truth:
    """The true state. The arrays are views: they follow the simulation in place. Copy what you keep."""

    position_m: Array  #: North, east, down from the origin.
    velocity_m_s: Array  #: Over ground, north, east, down.
    attitude: Array  #: Quaternion w, x, y, z from body (front, right, down) to north-east-down.
    rates_rad_s: Array  #: In the body.
    specific_force_m_s2: Array  #: In the body: what an ideal accelerometer measures.
    battery: Array  #: Voltage [V] and current [A].
    rotor_speeds_rad_s: Array  #: Ten; those that the vehicle does not have are 0.


@dataclass(frozen=True)
class Estimate:
    """What a companion computes from the samples that arrive over the link. Views, as those of Truth."""

    position_m: Array
    velocity_m_s: Array
    attitude: Array
    rates_rad_s: Array
    wind_m_s: Array
    position_sigma_m: Array
    velocity_sigma_m_s: Array


def _parts(whole: Array, *sizes: int) -> list[Array]:
    return np.split(whole, np.cumsum(sizes)[:-1])


class Forces:
    """Forces and moments on the vehicle, as a function of forces() sees and changes them. Views, which follow in place."""

    position_m: Array  #: North, east, down from the origin.
    velocity_m_s: Array  #: Over ground, north, east, down.
    attitude: Array  #: Quaternion w, x, y, z from body (front, right, down) to north-east-down.
    rates_rad_s: Array  #: In the body.
    air_velocity_m_s: Array  #: Through the air, in the body.
    outputs: Array  #: The fourteen of the firmware, 0 to 1.
    force_N: Array  #: In the body, without gravity and ground: what the vehicle's own rotors and wings do. Change it in place.
    torque_Nm: Array  #: About the centre of mass, in the body, as `force_N`.

    def __init__(self, core: _core.Simulation):
        (self.position_m, self.velocity_m_s, self.attitude, self.rates_rad_s, self.air_velocity_m_s, self.outputs,
         self._scalars) = _parts(core.forces_inputs, 3, 3, 4, 3, 3, 14, 3)
        self.force_N, self.torque_Nm = _parts(core.forces_wrench, 3, 3)

    @property
    def time_s(self) -> float:
        """Start of the step."""
        return float(self._scalars[0])

    @property
    def density_kg_m3(self) -> float:
        return float(self._scalars[1])

    @property
    def height_m(self) -> float:
        """Of the centre of mass above the ground."""
        return float(self._scalars[2])


class Parameters(Mapping[str, float]):
    """Parameters of the firmware, as the companion has them. Setting one sends it over the link and steps the simulation until
    the firmware has confirmed it, some milliseconds."""

    def __init__(self, core: _core.Simulation):
        self._core = core

    def __getitem__(self, name: str) -> float:
        found = self._core.parameter(name)
        if found is None:
            raise KeyError(name)
        value, whole = found
        return int(value) if whole else value

    def __setitem__(self, name: str, value: Number) -> None:
        self._core.set_parameter(name, arguments.finite(f"parameters, {name}", value))

    def __iter__(self) -> Iterator[str]:
        return iter([name for name, _, _ in self._core.parameters()])

    def __len__(self) -> int:
        return len(self._core.parameters())


def _vector(what: str, value: Sequence[Number] | Array, size: int) -> list[float]:
    array = np.asarray(value)
    if array.shape != (size,) or array.dtype.kind not in "fiu":
        raise ValueError(f"{what}: found shape {array.shape} of {array.dtype}, allowed {size} numbers")
    if not np.isfinite(array).all():
        raise ValueError(f"{what}: found NaN or infinity, allowed finite numbers")
    return [float(one) for one in array]


class Simulation:
    """One vehicle with the real firmware, stepped by the caller. Every byte crosses the simulated cable.

    It begins armed on the ground, after what a companion and a pilot do for a mission, by the same code: link, parameters,
    calibration, storing, arming (`start=False`: powered up, at time 0). Equal arguments and equal calls give equal bits.

    One step is 2.5 ms. A command stays in force until the next one, and is sent 100 times per second. One thread at a time may
    use a simulation; different ones compute at once.
    """

    STEP_S = 1 / STEPS_PER_SECOND

    def __init__(
        self,
        vehicle: str | os.PathLike[str] = "multirotor",
        seed: int = 1,
        wind: arguments.Wind | None = None,
        faults: Union[str, Iterable[str]] = (),
        set: arguments.Overrides = (),
        *,
        link_protocol: str = "mavlink",
        start: bool = True,
    ):
        self._core = _core.Simulation(
            arguments.name_or_path("vehicle", vehicle),
            arguments.whole("seed", seed, 0),
            arguments.wind_text(wind),
            arguments.texts("faults", faults),
            arguments.override_texts(set),
            arguments.one_of("link_protocol", link_protocol, ("mavlink", "lean")),
        )
        self.truth = Truth(*_parts(self._core.truth, 3, 3, 4, 3, 3, 2, 10))
        self.estimate = Estimate(*_parts(self._core.estimate, 3, 3, 4, 3, 3, 3, 3))
        self.outputs: Array = self._core.outputs  #: The fourteen outputs of the firmware, 0 to 1. A view.
        self.parameters = Parameters(self._core)
        self._calls: list[tuple[int, Callable[[Simulation], object]]] = []  # periods in steps
        self._calling = False
        self._forces: Callable[[], object] | None = None
        if start:
            self.start()

    def start(self) -> None:
        """From power-up to armed. Raises SimulationError if the firmware does not arm."""
        self._core.start()

    def step(self, n: int = 1) -> None:
        """Advances by n steps of 2.5 ms."""
        left = arguments.whole("step", n, 0, 2**40)
        if left and self._calling:
            raise SimulationError("step: found a call by a function of every(), allowed from outside")
        while left and self._calls:
            now = round(self.time_s * STEPS_PER_SECOND)
            self._calling = True
            try:
                for period, call in list(self._calls):
                    if now % period == 0:
                        call(self)
            finally:
                self._calling = False
            until_next = min((period - now % period for period, _ in self._calls), default=left)
            self._core.step(min(left, until_next))
            left -= min(left, until_next)
        self._core.step(left)

    def every(self, seconds: Number, call: Callable[[Simulation], object]) -> Callable[[], None]:
        """From now on `call(self)` before each step that begins at a multiple of this time: a controller or an estimator of your own.

        @returns a function that ends it. What `call` raises ends step() or run(); the simulation can go on.
        """
        period = round(arguments.at_least("every", seconds, 1 / STEPS_PER_SECOND) * STEPS_PER_SECOND)
        if not callable(call):
            raise TypeError(f"every: found {call!r}, allowed a function of the simulation")
        row = (period, call)
        self._calls.append(row)

        def end() -> None:
            self._calls[:] = [other for other in self._calls if other is not row]

        return end

    def forces(self, call: Callable[[Forces], object] | None) -> None:
        """From now on `call(forces)` behind each computation of the forces and moments of the vehicle, four times in a step, for what it
        leaves in them to act: a tether, or a model of your own in place of theirs. None: no longer. One function at a time.

        What `call` raises ends step() or run() after the step, in which the vehicle's own forces act; likewise a ValueError if it
        leaves NaN. A snapshot does not hold the function: restore() leaves it as it is.
        """
        if call is not None and not callable(call):
            raise TypeError(f"forces: found {call!r}, allowed a function of Forces, or None")
        self._forces = None if call is None else functools.partial(call, Forces(self._core))  # the core does not keep it
        self._core.set_forces(self._forces)

    def run(self, seconds: Number) -> None:
        """Advances by a time, rounded to steps."""
        self.step(round(arguments.finite("run", seconds) * STEPS_PER_SECOND))

    # ---- what is seen -------------------------------------------------------------------------

    @property
    def time_s(self) -> float:
        """Simulated time since power-up."""
        return self._core.time_s

    @property
    def armed(self) -> bool:
        return self._core.status[0]

    @property
    def failsafe(self) -> bool:
        return self._core.status[1]

    @property
    def on_ground(self) -> bool:
        return self._core.on_ground

    @property
    def hover_throttle(self) -> float:
        """Throttle that carries the vehicle: hovering, or in cruise."""
        return self._core.hover_throttle

    def texts(self) -> list[Note]:
        """What the firmware has written to its log since the last call."""
        return [Note(t_s, "fcu", SEVERITIES[severity], text) for t_s, severity, text in self._core.take_texts()]

    # ---- commands of the companion ------------------------------------------------------------

    def mixer(self, u: Sequence[Number] | Array) -> None:
        """Directly to the mixer (pass-through): forces x, y, z and torques x, y, z in its unit, then four free axes. Thrust up
        is negative z."""
        self._core.command("mixer", _vector("mixer", u, 6 if len(u) == 6 else 10))

    def rates(self, roll_rad_s: Number, pitch_rad_s: Number, yaw_rad_s: Number, throttle: Number) -> None:
        """Body rates; throttle 0 to 1."""
        self._core.command("rates", _vector("rates", [roll_rad_s, pitch_rad_s, yaw_rad_s, throttle], 4))

    def angles(self, roll_rad: Number, pitch_rad: Number, yaw_rad_s: Number, throttle: Number) -> None:
        """Roll, pitch and rate of yaw; throttle 0 to 1."""
        self._core.command("angles", _vector("angles", [roll_rad, pitch_rad, yaw_rad_s, throttle], 4))

    def surfaces(self, aileron: Number, elevator: Number, rudder: Number, throttle: Number) -> None:
        """A fixed wing's surfaces, -1 to 1, and throttle, 0 to 1, directly."""
        if not self._core.fixed_wing:
            raise ValueError("surfaces: found a multirotor, allowed a fixed wing")
        self._core.command("surfaces", _vector("surfaces", [aileron, elevator, rudder, throttle], 4))

    def release(self) -> None:
        """No more commands: after OFFBOARD_TIMEOUT the pilot flies."""
        self._core.release()

    # ---- the pilot and the world --------------------------------------------------------------

    def rc(self, **controls: float) -> None:
        """Moves sticks and switches of the pilot, 0 to 1: roll, pitch, throttle, yaw, arm, attitude_override,
        throttle_override, attitude_mode."""
        for control, to in controls.items():
            self._core.move(control, arguments.finite(f"rc, {control}", to))

    def fault(self, text: str) -> None:
        """Adds a fault, as `fly` takes it; its time counts from power-up: f"motor0_dead@{simulation.time_s}"."""
        self._core.add_fault(arguments.texts("fault", [text])[0])

    def end_faults(self) -> None:
        self._core.end_faults()

    def wind(self, wind: arguments.Wind) -> None:
        """Another wind from now on."""
        self._core.set_wind(arguments.wind_text(wind) or "")

    def hold(self, held: bool) -> None:
        """A fixed wing is held on the ground until it is let go: hold(False)."""
        self._core.set_held(bool(held))

    def place(
        self,
        position_m: Sequence[Number] | Array,
        velocity_m_s: Sequence[Number] | Array = (0.0, 0.0, 0.0),
        attitude: Sequence[Number] | Array = (1.0, 0.0, 0.0, 0.0),
        rates_rad_s: Sequence[Number] | Array = (0.0, 0.0, 0.0),
    ) -> None:
        """Puts the vehicle somewhere else at once, rotors as they turn. The firmware is not told, as in Truth the frames."""
        self._core.set_state([
            *_vector("position_m", position_m, 3),
            *_vector("velocity_m_s", velocity_m_s, 3),
            *_vector("attitude", attitude, 4),
            *_vector("rates_rad_s", rates_rad_s, 3),
        ])

    # ---- moments ------------------------------------------------------------------------------

    def snapshot(self) -> _core.Snapshot:
        """This moment, whole: world, sensors and their noise, firmware, bytes on the cable, companion, pilot, faults."""
        return self._core.snapshot()

    def restore(self, snapshot: _core.Snapshot) -> None:
        """Back to a snapshot of this simulation, any number of times; equal calls lead on to equal bits."""
        self._core.restore(snapshot)
