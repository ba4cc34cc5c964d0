# SPDX-License-Identifier: BSD-3-Clause
"""A controller of one's own between the steps: climbs to 5 m by throttle alone, and prints where it got to."""

import rosflight


def control(vehicle: rosflight.Simulation) -> None:
    error = vehicle.estimate.position_m[2] + 5
    vehicle.rates(0, 0, 0, min(max(vehicle.hover_throttle + 0.1 * (error + vehicle.estimate.velocity_m_s[2]), 0), 1))


def main() -> None:
    vehicle = rosflight.Simulation()
    end = vehicle.every(0.01, control)
    vehicle.run(10)
    end()
    print(f"{-vehicle.truth.position_m[2]:.2f} m")


if __name__ == "__main__":
    main()
