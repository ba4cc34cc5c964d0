# SPDX-License-Identifier: BSD-3-Clause
"""Many futures of one moment: which roll angle brings a vehicle back to the line it was blown off?"""

import numpy as np
import rosflight


def main() -> None:
    vehicle = rosflight.Simulation(seed=5, wind=(4, 270, 4))
    vehicle.place([0, 1.5, -20])
    vehicle.angles(0, 0, 0, vehicle.hover_throttle)
    vehicle.run(0.5)
    moment = vehicle.snapshot()
    off_m = {}
    for roll_deg in (-20, -10, 0, 10):
        vehicle.restore(moment)
        vehicle.angles(float(np.radians(roll_deg)), 0, 0, vehicle.hover_throttle)
        vehicle.run(1.0)
        off_m[roll_deg] = abs(float(vehicle.truth.position_m[1]))
        print(f"{roll_deg:4d} degrees: {off_m[roll_deg]:.2f} m off after 1 s")
    print(f"best: {min(off_m, key=lambda roll_deg: off_m[roll_deg])} degrees")


if __name__ == "__main__":
    main()
