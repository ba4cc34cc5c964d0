// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "firmware/boards/simulated/simulated_board.hpp"
#include "firmware/core/sensors.hpp"
#include "firmware/core/test/test_values.hpp"

namespace rosflight::core {

inline constexpr int kCalibrationSamples = 1001;

inline constexpr std::size_t cause(Reject r) {
  return static_cast<std::size_t>(r);
}

class SensorsTest : public ::testing::Test {
 protected:
  using Events = Sensors::CalibrationEvents;

  Events step() {
    now_ += hal::microseconds(2500);
    return sensors_.step(now_, roles_, parameters_, log_);
  }
  /// The last bit of every third sample differs, as no real sensor repeats itself.
  Events imu(hal::Vec3 accel, const hal::Vec3& gyro = {}, float temperature_K = 298.15f) {
    if (++samples_ % 3 == 0) accel[2] = std::nextafter(accel[2], 0.0f);
    board_.imu.put({now_, accel, gyro, temperature_K});
    return step();
  }
  /// A whole calibration; events of all its passes together.
  Events calibrate(const hal::Vec3& accel, const hal::Vec3& gyro, const hal::Vec3& shake = {}) {
    Events all;
    for (int k = 0; k < kCalibrationSamples; ++k) {
      hal::Vec3 a = accel;
      for (std::size_t i = 0; i < 3; ++i) a[i] += k % 2 == 0 ? shake[i] : -shake[i];
      const Events e = imu(a, gyro);
      all.gyro_done = all.gyro_done || e.gyro_done;
      all.gyro_failed = all.gyro_failed || e.gyro_failed;
      all.accel_settled = all.accel_settled || e.accel_settled;
      all.accel_done = all.accel_done || e.accel_done;
    }
    return all;
  }
  void set(Param id, float value) {
    ASSERT_NE(parameters_.set_float(id, value), SetResult::kOutOfRange);
  }
  std::string texts() {
    std::string all;
    while (!log_.empty()) all += std::string(log_.pop().text.data()) + "\n";
    return all;
  }
  const Measurements& now() const { return sensors_.measurements(); }

  boards::SimulatedBoard board_;
  boards::MemorySerial serial_;
  hal::Board roles_{board_.roles(serial_)};
  Parameters parameters_;
  Log log_;
  Sensors::Config config_;
  Sensors sensors_;
  Time now_{hal::milliseconds(1000)};
  int samples_{0};
};

inline void expect_near(const hal::Vec3& v, const hal::Vec3& expected, float tolerance) {
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(v[k], expected[k], tolerance) << "axis " << k;
}

}  // namespace rosflight::core
