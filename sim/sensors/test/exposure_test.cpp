// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sensors/exposure.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/sensors/presets.hpp"
#include "sim/sensors/test/samples.hpp"

namespace rosflight::sim::sensors {
namespace {

constexpr Time kImuPeriod{500}, kPeriod{2500};

TEST(Exposure, SamplesComeAtOnceAndAsOftenAsAsked) {
  SensorsConfig config = current_hardware();
  config.range.timing.enabled = false;
  const SensorsConfig c = exposure(config, kImuPeriod, kPeriod);
  EXPECT_EQ(c.imu.timing.period, kImuPeriod);
  for (const Timing& timing :
       {c.mag.timing, c.baro.timing, c.diff_pressure.timing, c.battery.timing})
    EXPECT_EQ(timing.period, kPeriod);
  EXPECT_EQ(c.gnss.timing.period, config.gnss.timing.period);
  for (const Timing& timing : {c.imu.timing, c.mag.timing, c.baro.timing, c.diff_pressure.timing,
                               c.gnss.timing, c.battery.timing}) {
    EXPECT_TRUE(timing.enabled);
    EXPECT_EQ(timing.delay, Time{0});
    EXPECT_EQ(timing.phase, Time{0});
  }
  EXPECT_FALSE(c.range.timing.enabled) << "what is off stays off";
}

TEST(Exposure, NoiseKeepsItsDensity) {
  SensorsConfig config = ideal();
  config.imu.gyro_rad_s.axis.noise_sigma = 0.03;  // at 400 Hz: 0.0015 per root of Hz
  config.imu.gyro_rad_s.axis.noise_density = 0.002;
  Imu imu{exposure(config, kImuPeriod, kPeriod).imu, kTestGravity, RandomSource{3}};
  constexpr int kSamples = 20'000;
  double squares = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    hal::ImuSample sample;
    ASSERT_TRUE(imu.measure(at_rest(k * kImuPeriod), sample));
    const auto x = static_cast<double>(sample.gyro_rad_s[0]);
    squares += x * x;
  }
  // 0.0025 over the 2000 Hz of such samples; 0.5 % is the scatter of the estimate.
  EXPECT_NEAR(std::sqrt(squares / kSamples), 0.0025 * std::sqrt(2000.0), 0.02 * 0.1118);
}

TEST(Exposure, NothingIsRoundedTwice) {
  const SensorsConfig c = exposure(current_hardware(), kImuPeriod, kPeriod);
  for (const ErrorParameters& errors :
       {c.imu.gyro_rad_s.axis, c.imu.accel_m_s2.axis, c.mag.field_T.axis, c.baro.pressure_Pa,
        c.diff_pressure.pressure_Pa}) {
    EXPECT_EQ(errors.resolution, 0.0);
  }
  EXPECT_GT(c.imu.gyro_rad_s.axis.limit, 0.0);
}

}  // namespace
}  // namespace rosflight::sim::sensors
