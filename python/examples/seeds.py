# SPDX-License-Identifier: BSD-3-Clause
"""The same flight with other noise, several at once, as a table: seeds.py [FLIGHTS]."""

import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import rosflight


def fly(seed: int) -> rosflight.Flight:
    return rosflight.fly(seed=seed, wind=(6, 270, 6), log="none", series_hz=0)


def main(flights: int) -> None:
    with ThreadPoolExecutor(2) as pool:
        flown = list(pool.map(fly, range(1, flights + 1)))
    errors = np.array([flight.tracking_rms_m for flight in flown])
    print(f"{sum(flight.success for flight in flown)} of {flights} missions done")
    print(f"tracking error: median {np.median(errors):.3f} m rms, largest {errors.max():.3f} m rms")
    for flight in flown:
        if not flight.success:
            print(f"seed {flight.seed}: {flight.verdict}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
