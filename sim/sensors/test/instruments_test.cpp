// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "sim/sensors/battery_monitor.hpp"
#include "sim/sensors/magnetometer.hpp"
#include "sim/sensors/pressure.hpp"
#include "sim/sensors/rangefinder.hpp"
#include "sim/sensors/test/samples.hpp"

namespace rosflight::sim::sensors {
namespace {

constexpr double kPi = std::numbers::pi;
const RandomSource kSource{7};
const Vector3 kField_W_T{2.0e-5, 0.5e-5, 4.5e-5};

template <class Config>
Config perfect() {
  Config config;
  config.timing.period = Time{10'000};
  return config;
}

// ---- magnetometer

hal::MagSample field(const Magnetometer::Config& config, const Quaternion& q_WB) {
  Magnetometer mag(config, kField_W_T, kSource);
  Truth truth = at_rest(Time{77});
  truth.body.q_WB = q_WB;
  hal::MagSample sample;
  EXPECT_TRUE(mag.measure(truth, sample));
  EXPECT_EQ(sample.stamp, Time{77});
  return sample;
}

void expect_field(const hal::MagSample& sample, const Vector3& expected) {
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(static_cast<double>(sample.field_T[static_cast<std::size_t>(i)]), expected[i],
                1e-11)
        << i;
  }
}

TEST(Magnetometer, SeesTheFieldInBodyAxes) {
  expect_field(field(perfect<Magnetometer::Config>(), Quaternion::Identity()), kField_W_T);
  // Nose east: the body's x is east and its right hand points south.
  const Quaternion east = turned(kPi / 2.0, Vector3::UnitZ());
  expect_field(field(perfect<Magnetometer::Config>(), east), {0.5e-5, -2.0e-5, 4.5e-5});
}

TEST(Magnetometer, IronIsWhatTheCalibrationUndoes) {
  // ROSflight 2.x corrects m = A (y - b); with A the inverse of the soft iron the field comes back.
  auto config = perfect<Magnetometer::Config>();
  config.soft_iron << 1.1, 0.02, -0.03, 0.02, 0.95, 0.01, -0.03, 0.01, 1.05;
  config.field_T.fixed_bias = {1e-5, -2e-5, 3e-6};
  const auto sample = field(config, Quaternion::Identity());
  const Vector3 y{static_cast<double>(sample.field_T[0]), static_cast<double>(sample.field_T[1]),
                  static_cast<double>(sample.field_T[2])};
  const Vector3 corrected = config.soft_iron.inverse() * (y - config.field_T.fixed_bias);
  EXPECT_TRUE(corrected.isApprox(kField_W_T, 1e-6));  // floats
  EXPECT_FALSE(y.isApprox(kField_W_T, 0.1));
}

TEST(Magnetometer, IsTurnedLikeTheImu) {
  auto config = perfect<Magnetometer::Config>();
  config.rotation_deg = {0.0, 0.0, 90.0};
  expect_field(field(config, Quaternion::Identity()), {-0.5e-5, 2.0e-5, 4.5e-5});
}

// ---- barometer and pitot tube

template <class Instrument>
double pressure(const typename Instrument::Config& config, const Truth& truth) {
  Instrument instrument(config, kSource);
  typename Instrument::Sample sample;
  EXPECT_TRUE(instrument.measure(truth, sample));
  EXPECT_EQ(sample.stamp, truth.time);
  return static_cast<double>(sample.pressure_Pa);
}

TEST(Barometer, ShowsStaticPressure) {
  Truth truth = at_rest();
  truth.air.pressure_Pa = 85'729.125;
  truth.body.v_B = {30.0, 0.0, 0.0};
  EXPECT_EQ(pressure<Barometer>(perfect<Barometer::Config>(), truth), 85'729.125);
}

TEST(Barometer, ABadPortAddsAShareOfTheDynamicPressure) {
  // 0.2 * 1/2 * 1.225 * (3^2 + 4^2), the wind taken off.
  auto config = perfect<Barometer::Config>();
  config.dynamic_pressure_share = 0.2;
  Truth truth = at_rest();
  truth.body.v_B = {8.0, 0.0, 0.0};
  truth.air.wind_W = {5.0, 4.0, 0.0};
  EXPECT_NEAR(pressure<Barometer>(config, truth) - 101'325.0, 3.0625, 0.004);  // float: 1/128 Pa
}

TEST(Barometer, TemperatureIsThatOfTheAirOrFixed) {
  auto config = perfect<Barometer::Config>();
  config.temperature.rise_K = 5.0;
  hal::BaroSample sample;
  Barometer(config, kSource).measure(at_rest(), sample);
  EXPECT_FLOAT_EQ(sample.temperature_K, 293.15F);
  config.temperature.fixed_K = 300.15;
  Barometer(config, kSource).measure(at_rest(), sample);
  EXPECT_FLOAT_EQ(sample.temperature_K, 300.15F);
}

TEST(PitotTube, HasTheSignOfTheAirAlongTheNose) {
  // 1/2 * 1.225 * 20^2 = 245 Pa.
  const auto config = perfect<PitotTube::Config>();
  Truth truth = at_rest();
  truth.body.v_B = {20.0, 3.0, -2.0};
  EXPECT_NEAR(pressure<PitotTube>(config, truth), 245.0, 1e-4);
  truth.body.v_B.x() = -20.0;
  EXPECT_NEAR(pressure<PitotTube>(config, truth), -245.0, 1e-4);
}

TEST(PitotTube, FeelsTheWindInBodyAxes) {
  // Standing with the nose east in an east wind (air moves west, -10 m/s east): 1/2 * 1.225 * 100.
  Truth truth = at_rest();
  truth.body.q_WB = turned(kPi / 2.0, Vector3::UnitZ());
  truth.air.wind_W = {0.0, -10.0, 0.0};
  EXPECT_NEAR(pressure<PitotTube>(perfect<PitotTube::Config>(), truth), 61.25, 1e-4);
}

TEST(PitotTube, ReferenceHabitLosesTheSign) {
  auto config = perfect<PitotTube::Config>();
  config.always_positive = true;
  Truth truth = at_rest();
  truth.body.v_B = {-20.0, 0.0, 0.0};
  EXPECT_NEAR(pressure<PitotTube>(config, truth), 245.0, 1e-4);
}

// ---- range

Rangefinder::Config sonar() {
  auto config = perfect<Rangefinder::Config>();
  config.min_m = 0.2;
  config.max_m = 7.65;
  config.max_tilt_deg = 30.0;
  return config;
}

struct Echo {
  bool there;
  hal::RangeSample sample;
};

Echo echo(const Rangefinder::Config& config, double height_m, double tilt_deg = 0.0) {
  Rangefinder rangefinder(config, kSource);
  Truth truth = at_rest();
  truth.body.p_W = {3.0, 4.0, -height_m};
  truth.body.q_WB = turned(tilt_deg * kPi / 180.0, Vector3(0.6, 0.8, 0.0));
  Echo result{};
  result.there = rangefinder.measure(truth, result.sample);
  return result;
}

TEST(Rangefinder, MeasuresAlongItsAxis) {
  EXPECT_FLOAT_EQ(echo(sonar(), 3.0).sample.range_m, 3.0F);
  // At 25 degrees of tilt the beam is 1/cos 25 longer.
  EXPECT_NEAR(static_cast<double>(echo(sonar(), 3.0, 25.0).sample.range_m), 3.310134, 1e-6);
  EXPECT_FLOAT_EQ(echo(sonar(), 3.0).sample.min_m, 0.2F);
  EXPECT_FLOAT_EQ(echo(sonar(), 3.0).sample.max_m, 7.65F);
}

TEST(Rangefinder, HasNoEchoPastItsLimits) {
  EXPECT_TRUE(echo(sonar(), 7.64).there);
  EXPECT_FALSE(echo(sonar(), 7.66).there);
  EXPECT_TRUE(echo(sonar(), 7.0, 20.0).there);
  EXPECT_FALSE(echo(sonar(), 7.0, 28.0).there);  // 7.93 m
  EXPECT_TRUE(echo(sonar(), 1.0, 29.9).there);
  EXPECT_FALSE(echo(sonar(), 1.0, 30.1).there);
  EXPECT_FALSE(echo(sonar(), 1.0, 180.0).there);
  EXPECT_FALSE(echo(sonar(), std::numeric_limits<double>::quiet_NaN()).there);
}

TEST(Rangefinder, ShowsItsMinimumInTheDeadZone) {
  EXPECT_TRUE(echo(sonar(), 0.05).there);
  EXPECT_FLOAT_EQ(echo(sonar(), 0.05).sample.range_m, 0.2F);
}

TEST(Rangefinder, MeasuresFromWhereItIs) {
  auto config = sonar();
  config.position_m = {0.1, 0.0, 0.15};
  EXPECT_NEAR(static_cast<double>(echo(config, 3.0).sample.range_m), 2.85, 1e-6);
}

TEST(Rangefinder, ReferenceHabitPinsTheHeight) {
  auto config = sonar();
  config.min_m = 0.25;
  config.max_m = 8.0;
  config.pinned = true;
  EXPECT_FLOAT_EQ(echo(config, 100.0).sample.range_m, 8.0F);
  EXPECT_FLOAT_EQ(echo(config, 0.0).sample.range_m, 0.25F);
  EXPECT_FLOAT_EQ(echo(config, 4.0, 60.0).sample.range_m, 4.0F);
}

// ---- battery

TEST(BatteryMonitor, ShowsTheTerminals) {
  auto config = perfect<BatteryMonitor::Config>();
  config.current_A.resolution = 0.5;
  Truth truth = at_rest();
  truth.battery_voltage_V = 23.456;
  truth.battery_current_A = 31.3;
  hal::BatterySample sample;
  EXPECT_TRUE(BatteryMonitor(config, kSource).measure(truth, sample));
  EXPECT_FLOAT_EQ(sample.voltage_V, 23.456F);
  EXPECT_FLOAT_EQ(sample.current_A, 31.5F);
  config.fixed_voltage_V = 23.0;
  config.fixed_current_A = 1.0;
  BatteryMonitor(config, kSource).measure(truth, sample);
  EXPECT_FLOAT_EQ(sample.voltage_V, 23.0F);
  EXPECT_FLOAT_EQ(sample.current_A, 1.0F);
}

}  // namespace
}  // namespace rosflight::sim::sensors
