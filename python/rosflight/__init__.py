# SPDX-License-Identifier: BSD-3-Clause
"""The firmware of the ROSflight open autopilot in its simulation, for Python: fly missions, equal to the bit for equal seeds.

    import rosflight
    flight = rosflight.fly(seed=7)
    print(flight.verdict, flight.tracking_rms_m)
"""

from . import plot
from ._core import BUILD
from ._flight import Flight, Note, fly, missions, vehicles
from ._log import Log, Topic, read
from ._simulation import Estimate, Forces, Parameters, Simulation, SimulationError, Truth

__all__ = ["BUILD", "Estimate", "Flight", "Forces", "Log", "Note", "Parameters", "Simulation", "SimulationError", "Topic", "Truth", "fly",
           "missions", "plot", "read", "vehicles"]

try:
    from .gym import register as _register
except ImportError:  # gymnasium is not installed
    pass
else:
    _register()
