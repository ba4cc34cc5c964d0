# SPDX-License-Identifier: BSD-3-Clause
"""Everything once: a flight, its log, pictures, a vehicle commanded step by step, an environment. Writes flights/ and path.png."""

import gymnasium
import numpy as np
import rosflight


def main() -> None:
    flight = rosflight.fly("multirotor", "hop", seed=7, wind=(4, 270, 3), faults="baro@12:3", set={"body.mass_kg": 3.3})
    print(flight.verdict, flight.tracking_rms_m, flight.log_sha256)
    print(flight.series["position_m"].shape, flight.to_pandas().columns[:3].tolist())

    log = rosflight.read(flight.folder or "")
    print(log["/imu/data"]["linear_acceleration.z"].mean(), log["/autonomy/estimate"].to_pandas().shape)
    rosflight.plot.path(log).savefig("path.png")

    vehicle = rosflight.Simulation(seed=5)
    vehicle.place([0, 0, -10])
    vehicle.rates(0, 0, 0.5, vehicle.hover_throttle)
    vehicle.step(400)
    print(vehicle.truth.rates_rad_s, vehicle.estimate.position_m, vehicle.parameters["PID_YAW_RATE_P"])
    moment = vehicle.snapshot()
    for yaw_rate in (0.2, 0.8):
        vehicle.restore(moment)
        vehicle.rates(0, 0, yaw_rate, vehicle.hover_throttle)
        vehicle.step(400)
        print(yaw_rate, vehicle.truth.rates_rad_s[2])

    envs = gymnasium.make_vec("rosflight/Hover-v0", num_envs=16, vectorization_mode="vector_entry_point", threads=2)
    observations, info = envs.reset(seed=1)
    observations, rewards, terminated, truncated, info = envs.step(np.zeros((16, 4), np.float32))
    print(observations.shape, rewards.mean())


if __name__ == "__main__":
    main()
