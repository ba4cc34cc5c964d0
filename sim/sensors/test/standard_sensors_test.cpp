// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sensors/standard_sensors.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <vector>

#include "sim/sensors/presets.hpp"
#include "sim/sensors/test/samples.hpp"

namespace rosflight::sim::sensors {
namespace {

constexpr std::int64_t kTick_us = 2500;

/// Something that moves, so that readings change.
Truth moving(Time t) {
  Truth truth = at_rest(t);
  const double s = to_seconds(t);
  truth.body.p_W = {s, -2.0 * s, -1.0 - 0.5 * std::sin(s)};
  truth.body.v_B = {1.0, -2.0, 0.1};
  truth.body.w_B = {0.1 * std::sin(3.0 * s), 0.0, 0.2};
  truth.battery_voltage_V = 24.0 - 0.01 * s;
  truth.battery_current_A = 20.0;
  truth.rotor_count = 4;
  truth.rotor_speed_rad_s.fill(388.0);
  return truth;
}

/// All samples of a flight, as bytes per sensor.
using Record = std::map<char, std::vector<std::uint32_t>>;

template <class... Floats>
void note(std::vector<std::uint32_t>& record, Time stamp, Floats... values) {
  record.push_back(static_cast<std::uint32_t>(stamp.count()));
  for (const float value : {static_cast<float>(values)...}) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    record.push_back(bits);
  }
}

Record fly(const SensorsConfig& config, std::uint64_t seed, std::int64_t ticks = 2000,
           std::int64_t tick_us = kTick_us) {
  StandardSensors sensors(config, test_place(), RandomSource{seed});
  SensorSamples s;
  Record record;
  for (std::int64_t i = 0; i < ticks; ++i) {
    sensors.step(moving(Time{i * tick_us}), s);
    if (s.has_imu) note(record['i'], s.imu.stamp, s.imu.gyro_rad_s[0], s.imu.accel_m_s2[2]);
    if (s.has_mag) note(record['m'], s.mag.stamp, s.mag.field_T[1]);
    if (s.has_baro) note(record['b'], s.baro.stamp, s.baro.pressure_Pa);
    if (s.has_diff_pressure) note(record['d'], s.diff_pressure.stamp, s.diff_pressure.pressure_Pa);
    if (s.has_range) note(record['r'], s.range.stamp, s.range.range_m);
    if (s.has_gnss) {
      note(record['g'], s.gnss.stamp, s.gnss.height_msl_m, s.gnss.velocity_ned_m_s[0],
           1e6 * (s.gnss.latitude_deg - 40.0));
    }
    if (s.has_battery) note(record['v'], s.battery.stamp, s.battery.voltage_V, s.battery.current_A);
  }
  return record;
}

std::vector<Timing*> timings(SensorsConfig& c) {
  return {&c.imu.timing,   &c.mag.timing,  &c.baro.timing,   &c.diff_pressure.timing,
          &c.range.timing, &c.gnss.timing, &c.battery.timing};
}

TEST(StandardSensors, TheSameSeedGivesTheSameBits) {
  EXPECT_EQ(fly(current_hardware(), 5), fly(current_hardware(), 5));
  EXPECT_EQ(fly(reference(), 5), fly(reference(), 5));
}

TEST(StandardSensors, AnotherSeedDiffersInEverySensor) {
  Record a = fly(current_hardware(), 5);
  Record b = fly(current_hardware(), 6);
  ASSERT_EQ(a.size(), 7U);
  for (const auto& [sensor, samples] : a) EXPECT_NE(samples, b[sensor]) << sensor;
}

TEST(StandardSensors, SwitchingOneOffLeavesTheOthersBitForBit) {
  const Record all = fly(current_hardware(), 5);
  const std::array<char, 7> names{'i', 'm', 'b', 'd', 'r', 'g', 'v'};
  for (std::size_t off = 0; off < names.size(); ++off) {
    SensorsConfig config = current_hardware();
    timings(config)[off]->enabled = false;
    Record expected = all;
    expected.erase(names[off]);
    EXPECT_EQ(fly(config, 5), expected) << names[off];
  }
}

TEST(StandardSensors, SampleKComesAtExactlyPhasePlusKPeriods) {
  SensorsConfig config = ideal();
  config.mag.timing = {.enabled = true, .period = Time{3'337}, .phase = Time{101}, .delay = {}};
  StandardSensors sensors(config, test_place(), RandomSource{1});
  SensorSamples s;
  std::int64_t mags = 0;
  std::int64_t imus = 0;
  for (std::int64_t t = 0; t < 2'000'000; ++t) {  // every microsecond, so that every moment exists
    sensors.step(at_rest(Time{t}), s);
    if (s.has_mag) {
      ASSERT_EQ(t, 101 + 3'337 * mags);
      ASSERT_EQ(s.mag.stamp, Time{t});
      ++mags;
    }
    if (s.has_imu) {
      ASSERT_EQ(t, 2500 * imus);
      ++imus;
    }
  }
  EXPECT_EQ(imus, 800);
  EXPECT_EQ(mags, 600);  // 101 + 599 * 3337 = 1 998 964
}

TEST(StandardSensors, RatesDoNotDriftOverAnHour) {
  SensorsConfig config = ideal();
  for (Timing* timing : timings(config)) timing->enabled = false;
  config.baro.timing = {.enabled = true, .period = Time{16'667}, .phase = {}, .delay = {}};
  const Record record = fly(config, 1, 400LL * 3600);
  EXPECT_EQ(record.at('b').size() / 2, 3600U * 1'000'000U / 16'667U + 1U);
}

TEST(StandardSensors, AWorldSlowerThanASensorSkipsSamples) {
  SensorsConfig config = ideal();
  const Record record = fly(config, 1, 100, 10'000);  // 100 Hz steps
  EXPECT_EQ(record.at('i').size() / 3, 100U);
}

TEST(StandardSensors, ADelayMovesDeliveryButNotTheStamp) {
  SensorsConfig config = ideal();
  config.gnss.timing.delay = Time{22'000};
  config.gnss.timing.phase = Time{0};
  config.imu.timing.delay = Time{7'500};  // longer than its period
  StandardSensors sensors(config, test_place(), RandomSource{1});
  SensorSamples s;
  int imus = 0;
  for (std::int64_t t = 0; t <= 1'000'000; t += kTick_us) {
    Truth truth = at_rest(Time{t});
    truth.body.w_B.x() = static_cast<double>(t);
    sensors.step(truth, s);
    if (s.has_gnss) {
      // 22 ms is over in the step at 22.5 ms.
      EXPECT_EQ(t % 100'000, 22'500);
      EXPECT_EQ(s.gnss.stamp, Time{t - 22'500});
    }
    EXPECT_EQ(s.has_imu, t >= 7'500);
    if (!s.has_imu) continue;
    ++imus;
    EXPECT_EQ(s.imu.stamp, Time{t - 7'500});
    EXPECT_EQ(s.imu.gyro_rad_s[0], static_cast<float>(t - 7'500));
  }
  EXPECT_EQ(imus, 398);
}

TEST(StandardSensors, EveryFlagIsWrittenAtEveryStep) {
  StandardSensors sensors(ideal(), test_place(), RandomSource{1});
  SensorSamples s;
  s.has_imu = s.has_mag = s.has_baro = s.has_diff_pressure = s.has_range = s.has_gnss =
      s.has_battery = true;
  sensors.step(at_rest(Time{0}), s);
  EXPECT_TRUE(s.has_imu);
  EXPECT_FALSE(s.has_mag || s.has_baro || s.has_diff_pressure || s.has_range || s.has_gnss ||
               s.has_battery);
}

TEST(StandardSensors, PresetsDoNotLetSlowSensorsShareAStep) {
  StandardSensors sensors(current_hardware(), test_place(), RandomSource{1});
  SensorSamples s;
  for (std::int64_t i = 0; i < 800; ++i) {
    Truth truth = at_rest(Time{i * kTick_us});
    truth.body.p_W.z() = -1.0;
    sensors.step(truth, s);
    EXPECT_LE(s.has_baro + s.has_range + s.has_gnss + s.has_battery, 1) << i;
  }
}

// ---- presets against the numbers they stand for

/// Spread of one reading over many runs.
template <class Read>
double spread(SensorsConfig config, const Truth& truth, int runs, Read read) {
  double sum = 0.0;
  double squares = 0.0;
  for (Timing* timing : timings(config)) timing->phase = Time{0};
  for (int run = 0; run < runs; ++run) {
    StandardSensors sensors(config, test_place(), RandomSource{static_cast<std::uint64_t>(run)});
    SensorSamples s;
    sensors.step(truth, s);
    const double x = read(s);
    sum += x;
    squares += x * x;
  }
  return std::sqrt(squares / runs - sum * sum / runs / runs);
}

TEST(Presets, ReferenceHasTheStationarySpreadsOfItsSimulator) {
  // Worked out from the update rules of the ROSflight 2.x simulator: T sigma / sqrt(1 - exp(-2 k
  // T)).
  const SensorsConfig c = reference();
  EXPECT_NEAR(c.gnss.horizontal_m.drift_sigma, 1.56, 0.005);
  EXPECT_NEAR(c.gnss.vertical_m.drift_sigma, 2.97, 0.005);
  EXPECT_NEAR(c.imu.gyro_rad_s.axis.drift_sigma, 2.7e-4, 0.05e-4);
  EXPECT_NEAR(c.mag.field_T.axis.drift_sigma, 1.2e-7, 0.05e-7);
  EXPECT_NEAR(c.baro.pressure_Pa.bias_walk, 1.0, 1e-12);  // 1 Pa/sqrt(s) at 100 Hz
}

TEST(Presets, ReferenceStartsWithTheBiasesOfItsSimulator) {
  // Uniform in +-r: standard deviation r/sqrt(3). From n runs it is known to sqrt((1.8 - 1)/(4 n))
  // of itself (1.8 is the kurtosis), 0.7 %; four times that is allowed.
  constexpr int kRuns = 4000;
  const Truth truth = at_rest();  // rotors stand: no white noise in the IMU
  const auto gyro = [](const SensorSamples& s) { return static_cast<double>(s.imu.gyro_rad_s[1]); };
  const auto accel = [](const SensorSamples& s) {
    return static_cast<double>(s.imu.accel_m_s2[0]);
  };
  const auto baro = [](const SensorSamples& s) { return static_cast<double>(s.baro.pressure_Pa); };
  EXPECT_NEAR(spread(reference(), truth, kRuns, gyro) / (0.25 / std::sqrt(3.0)), 1.0, 0.03);
  EXPECT_NEAR(spread(reference(), truth, kRuns, accel) / (0.6 / std::sqrt(3.0)), 1.0, 0.03);
  EXPECT_NEAR(spread(reference(), truth, kRuns, baro) / (500.0 / std::sqrt(3.0)), 1.0, 0.03);
}

TEST(Presets, CurrentHardwareHasTheNoiseOfItsDataSheets) {
  constexpr double kDegree = 0.017453292519943295;
  const SensorsConfig c = current_hardware();
  EXPECT_DOUBLE_EQ(c.imu.gyro_rad_s.axis.noise_density / kDegree, 0.014);  // BMI088: deg/s/sqrt(Hz)
  EXPECT_DOUBLE_EQ(c.imu.accel_m_s2.axis.noise_density / 9.80665e-6, 175.0);  // BMI088: ug/sqrt(Hz)
  EXPECT_NEAR(1.0 / (c.imu.gyro_rad_s.axis.resolution / kDegree), 16.384,
              1e-9);  // BMI088: LSB per deg/s
  EXPECT_NEAR(c.imu.accel_m_s2.axis.resolution / 9.80665 * 1365.33, 1.0,
              1e-5);                                        // BMI088: LSB per g at 24 g
  EXPECT_DOUBLE_EQ(c.mag.field_T.axis.resolution, 1.5e-7);  // IIS2MDC: 1.5 mG
  EXPECT_EQ(c.gnss.timing.period, Time{100'000});
}

TEST(Presets, AllanDeviationOfTheImuIsItsDensityAtOneSecond) {
  SensorsConfig c = current_hardware();
  for (Timing* timing : timings(c)) timing->enabled = false;
  c.imu.timing.enabled = true;
  StandardSensors sensors(c, test_place(), RandomSource{3});
  SensorSamples s;
  constexpr int kClusters = 3000;  // of one second
  double gyro_before = 0.0;
  double accel_before = 0.0;
  double gyro_squares = 0.0;
  double accel_squares = 0.0;
  for (int cluster = 0; cluster < kClusters; ++cluster) {
    double gyro = 0.0;
    double accel = 0.0;
    for (int i = 0; i < 400; ++i) {
      sensors.step(at_rest(Time{(400LL * cluster + i) * kTick_us}), s);
      gyro += static_cast<double>(s.imu.gyro_rad_s[2]) / 400.0;
      accel += static_cast<double>(s.imu.accel_m_s2[1]) / 400.0;
    }
    if (cluster > 0) {
      gyro_squares += (gyro - gyro_before) * (gyro - gyro_before);
      accel_squares += (accel - accel_before) * (accel - accel_before);
    }
    gyro_before = gyro;
    accel_before = accel;
  }
  // White noise: relative spread sqrt(1.5/(2 M)), see noise_test.cpp; drift and rounding add less
  // than 0.5 %.
  const double bound = 4.0 * std::sqrt(1.5 / (2.0 * (kClusters - 1))) + 0.005;
  const double norm = 2.0 * (kClusters - 1);
  EXPECT_NEAR(std::sqrt(gyro_squares / norm) / (0.014 * 0.017453292519943295), 1.0, bound);
  EXPECT_NEAR(std::sqrt(accel_squares / norm) / (175e-6 * 9.80665), 1.0, bound);
}

TEST(Presets, IdealShowsTheTruthAsFloats) {
  StandardSensors sensors(ideal(), test_place(), RandomSource{1});
  SensorSamples s;
  const Truth truth = moving(Time{50'000});
  sensors.step(truth, s);
  ASSERT_TRUE(s.has_imu && s.has_baro && s.has_mag);
  EXPECT_EQ(s.imu.gyro_rad_s[0], static_cast<float>(truth.body.w_B.x()));
  EXPECT_EQ(s.imu.accel_m_s2[2], static_cast<float>(-kTestGravity));
  EXPECT_EQ(s.baro.pressure_Pa, 101'325.0F);
  EXPECT_EQ(s.mag.field_T[2], static_cast<float>(4.60706e-5));
  EXPECT_EQ(s.battery.voltage_V, static_cast<float>(truth.battery_voltage_V));
}

}  // namespace
}  // namespace rosflight::sim::sensors
