# SPDX-License-Identifier: BSD-3-Clause
"""Forces of one's own: a vehicle that leans forward, without and with a banner that it tows, and the speed that it reaches."""

import math

import rosflight


def banner(at: rosflight.Forces) -> None:
    at.force_N -= 0.8 * at.air_velocity_m_s


def speed_m_s(tows: bool) -> float:
    vehicle = rosflight.Simulation()
    vehicle.place([0, 0, -100])
    if tows:
        vehicle.forces(banner)
    vehicle.angles(0, -math.radians(15), 0, 1.05 * vehicle.hover_throttle)
    vehicle.run(15)
    return float(vehicle.truth.velocity_m_s[0])


def main() -> None:
    print(f"{speed_m_s(False):.1f} m/s, with a banner {speed_m_s(True):.1f} m/s")


if __name__ == "__main__":
    main()
