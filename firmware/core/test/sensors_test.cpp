// SPDX-License-Identifier: BSD-3-Clause
#include <tuple>
#include <utility>

#include "firmware/core/test/sensors_rig.hpp"

namespace rosflight::core {
namespace {

// ---- mounting, corrections

TEST_F(SensorsTest, NothingIsNewWithoutSamples) {
  step();
  EXPECT_FALSE(now().new_imu || now().new_mag || now().new_baro || now().new_diff_pressure ||
               now().new_range || now().new_gnss || now().new_battery);
  EXPECT_EQ(now().density_kg_m3, 1.225f);
}

TEST_F(SensorsTest, EachSampleIsNewOnce) {
  imu(kLevel);
  EXPECT_TRUE(now().new_imu);
  step();
  EXPECT_FALSE(now().new_imu);
}

TEST_F(SensorsTest, YawMountingOf90TurnsXIntoMinusY) {
  // Reference run (weak point 27: the formula is kept).
  config_.imu_mounting_deg = {0.0f, 0.0f, 90.0f};
  config_.mag_mounting_deg = {0.0f, 0.0f, 90.0f};
  sensors_.configure(config_);
  imu({1, 0, 0}, {1, 0, 0});
  expect_near(now().imu.accel_m_s2, {0, -1, 0}, 1e-6f);
  expect_near(now().imu.gyro_rad_s, {0, -1, 0}, 1e-6f);
  board_.mag.put({now_, {1, 0, 0}, 290.0f});
  step();
  expect_near(now().mag.field_T, {0, -1, 0}, 1e-6f);
}

TEST_F(SensorsTest, MountingAnglesAreYawPitchRoll) {
  // By hand: v' = R(q)^T v.
  const auto turned = [&](const Vector3& deg, const hal::Vec3& v) {
    config_.imu_mounting_deg = deg;
    sensors_.configure(config_);
    imu(v);
    return now().imu.accel_m_s2;
  };
  expect_near(turned({90, 0, 0}, {0, 1, 0}), {0, 0, -1}, 1e-6f);
  expect_near(turned({90, 0, 0}, {0, 0, 1}), {0, 1, 0}, 1e-6f);
  expect_near(turned({0, 90, 0}, {1, 0, 0}), {0, 0, 1}, 1e-6f);
  expect_near(turned({0, 90, 0}, {0, 0, 1}), {-1, 0, 0}, 1e-6f);
  expect_near(turned({180, 0, 0}, {1, 2, 3}), {1, -2, -3}, 2e-6f);
  // R = Rz(yaw) Ry(pitch) Rx(roll): yaw 90 and roll 90, R^T y = Rx^T Rz^T y = Rx^T x = x.
  expect_near(turned({90, 0, 90}, {0, 1, 0}), {1, 0, 0}, 1e-6f);
}

TEST_F(SensorsTest, SubtractsBiasesAfterTheRotation) {
  config_.imu_mounting_deg = {0.0f, 0.0f, 90.0f};
  config_.acc_bias = {0.1f, 0.2f, 0.3f};
  config_.gyro_bias = {0.01f, 0.02f, 0.03f};
  sensors_.configure(config_);
  imu({1, 0, -9}, {0.5f, 0, 0.25f});
  expect_near(now().imu.accel_m_s2, {-0.1f, -1.2f, -9.3f}, 1e-6f);
  expect_near(now().imu.gyro_rad_s, {-0.01f, -0.52f, 0.22f}, 1e-6f);
}

TEST_F(SensorsTest, CompensatesTheAccelerometersTemperature) {
  config_.acc_temp_comp = {0.001f, -0.002f, 0.0f};
  sensors_.configure(config_);
  imu(kLevel, {}, 300.0f);
  expect_near(now().imu.accel_m_s2, {-0.3f, 0.6f, -9.80665f}, 1e-6f);
  EXPECT_EQ(now().imu.temperature_K, 300.0f);
}

TEST_F(SensorsTest, CorrectsTheMagnetometerForHardAndSoftIron) {
  config_.mag_bias = {1.0f, 2.0f, 3.0f};
  config_.mag_soft_iron << 2, 0, 0, 0, 3, 1, 0, 0, 4;
  sensors_.configure(config_);
  board_.mag.put({now_, {2.0f, 4.0f, 6.0f}, 290.0f});
  step();
  EXPECT_TRUE(now().new_mag);
  expect_near(now().mag.field_T, {2.0f, 3.0f * 2.0f + 3.0f, 12.0f}, 1e-6f);
}

TEST_F(SensorsTest, APassWithAnImuSampleTakesOneOtherSensorAtMost) {
  const auto new_ones = [this] {
    return int{now().new_gnss} + int{now().new_battery} + int{now().new_range} +
           int{now().new_baro} + int{now().new_mag} + int{now().new_diff_pressure};
  };
  const auto put_all = [this] {
    board_.mag.put({now_, {1e-5f, 0.0f, 4e-5f}, 290.0f});
    board_.baro.put({now_, 90'000.0f, 280.0f});
    board_.diff_pressure.put({now_, 10.0f, 280.0f});
    board_.range.put({now_, 1.0f, 0.1f, 8.0f});
    board_.gnss.put({now_});
    board_.battery.put({now_, 16.0f, 1.0f});
  };
  put_all();
  for (int k = 0; k < 6; ++k) {  // slowest first
    imu(kLevel, {1e-3f * static_cast<float>(k % 2), 0.0f, 0.0f});
    EXPECT_EQ(new_ones(), 1) << k;
    EXPECT_TRUE(now().new_aid);
    EXPECT_EQ(now().new_gnss, k == 0);
    EXPECT_EQ(now().new_diff_pressure, k == 5);
  }
  imu(kLevel, {5e-3f, 0.0f, 0.0f});
  EXPECT_EQ(new_ones(), 0);
  EXPECT_FALSE(now().new_aid);
  put_all();
  step();
  EXPECT_EQ(new_ones(), 6) << "without an IMU sample all that wait";
}

TEST_F(SensorsTest, BarometerGivesAltitudeAndDensityOfTheStandardAtmosphere) {
  board_.baro.put({now_, 90'000.0f, 280.0f});
  step();
  EXPECT_NEAR(now().altitude_m, 988.545f, 5e-3f);  // as ROSflight 2.x, one float pow
  // ISA: T = 288.15 - 0.0065 * 988.545 = 281.724 K, p/(R T) = 90000/(287.053 * 281.724).
  EXPECT_NEAR(now().density_kg_m3, 1.11290f, 1e-5f);
  sensors_ = Sensors{};
  board_.baro.put({now_, 101'325.0f, 288.15f});
  step();
  EXPECT_NEAR(now().altitude_m, 0.0f, 1e-2f);
  EXPECT_NEAR(now().density_kg_m3, 1.225f, 1e-6f);
}

TEST_F(SensorsTest, DensityIsLowPassedWithFiveSeconds) {
  const auto breathe = [this](float pressure_Pa, int samples) {
    for (int k = 0; k < samples; ++k) {
      now_ += hal::microseconds(17'500);  // and 2.5 ms of step()
      board_.baro.put({now_, pressure_Pa, 280.0f});
      step();
    }
  };
  breathe(90'000.0f, 1);
  const float first = now().density_kg_m3;
  EXPECT_NEAR(first, 1.11290f, 1e-5f);
  breathe(101'325.0f, 250);  // one time constant
  EXPECT_NEAR((now().density_kg_m3 - first) / (1.225f - first), 1.0f - std::exp(-1.0f), 2e-3f);
}

TEST_F(SensorsTest, OneWrongPressureDoesNotChangeTheDensity) {
  for (const float pressure_Pa : {101'325.0f, 54'000.0f}) {
    for (const std::int64_t period_ms : {10, 20, 50, 200, 5000}) {
      sensors_ = Sensors{};
      for (int k = 0; k < 10; ++k) {
        now_ += hal::milliseconds(period_ms);
        board_.baro.put({now_, pressure_Pa, 280.0f});
        step();
      }
      const float before = now().density_kg_m3;
      for (const float wrong : {1'000.0f, 115'000.0f, 29'999.0f, 120'001.0f, 1e9f, 0.0f, -5.0f}) {
        now_ += hal::milliseconds(period_ms);
        board_.baro.put({now_, wrong, 280.0f});
        step();
        EXPECT_EQ(now().new_baro, wrong == 115'000.0f) << wrong;
        EXPECT_NEAR(now().density_kg_m3 / before, 1.0f, 0.01f) << wrong;
      }
      EXPECT_EQ(sensors_.rejected()[cause(Reject::kPressure)], 6u);
    }
  }
}

TEST_F(SensorsTest, NumbersBeyondWhatASensorMeasuresAreDropped) {
  imu(kLevel, {0.1f, 0, 0});
  imu(kLevel, {126.0f, 0, 0});
  EXPECT_FALSE(now().new_imu);
  imu({0, 7001.0f, 0});
  EXPECT_FALSE(now().new_imu);
  imu(kLevel, {}, 1e5f);
  EXPECT_FALSE(now().new_imu);
  EXPECT_EQ(now().imu.gyro_rad_s[0], 0.1f);
  for (const auto& [voltage, current] :
       {std::pair{-2.0f, 1.0f}, {101.0f, 1.0f}, {12.0f, 3000.0f}}) {
    board_.battery.put({now_, voltage, current});
    step();
    EXPECT_FALSE(now().new_battery);
  }
  board_.battery.put({now_, -0.02f, -0.1f});  // noise without a battery
  step();
  EXPECT_TRUE(now().new_battery);
  for (const float pressure_Pa : {60e3f, -60e3f, 1e20f}) {
    board_.diff_pressure.put({now_, pressure_Pa, 290.0f});
    step();
    EXPECT_FALSE(now().new_diff_pressure);
  }
  for (const float range_m : {-1.0f, -kInf}) {
    board_.range.put({now_, range_m, 0.1f, 40.0f, hal::RangeKind::kLidar});
    step();
    EXPECT_FALSE(now().new_range);
  }
  hal::GnssSample good;
  good.latitude_deg = 40.0;
  board_.gnss.put(good);
  step();
  EXPECT_TRUE(now().new_gnss);
  for (int k = 0; k < 5; ++k) {
    hal::GnssSample gnss;
    if (k == 0) gnss.latitude_deg = -90.1;
    if (k == 1) gnss.longitude_deg = 361.0;
    if (k == 2) gnss.height_msl_m = 2e5;
    if (k == 3) gnss.velocity_ned_m_s = {0, -1001.0f, 0};
    if (k == 4) gnss.height_msl_m = -1001.0;
    board_.gnss.put(gnss);
    step();
    EXPECT_FALSE(now().new_gnss) << k;
    EXPECT_EQ(now().gnss.latitude_deg, 40.0);  // the last good one is still there
  }
  EXPECT_EQ(sensors_.rejected()[cause(Reject::kRange)], 3u + 3u + 3u + 2u + 5u);
}

TEST_F(SensorsTest, AirspeedHasTheSignOfThePressure) {
  config_.diff_pressure_bias_Pa = 10.0f;
  sensors_.configure(config_);
  const auto airspeed = [&](float pressure) {
    board_.diff_pressure.put({now_, pressure, 290.0f});
    step();
    return now().airspeed_m_s;
  };
  // 61.25 Pa = 0.5 * 1.225 * 10^2
  EXPECT_NEAR(airspeed(71.25f), 10.0f, 1e-5f);
  EXPECT_NEAR(airspeed(-51.25f), -10.0f, 1e-5f);
  EXPECT_NEAR(airspeed(10.0f), 0.0f, 1e-6f);
  EXPECT_FLOAT_EQ(now().diff_pressure.pressure_Pa, 0.0f);
}

// ---- battery

TEST_F(SensorsTest, BatteryFilterStartsFromTheFirstSample) {
  // Weak points 28 and 29: ROSflight 2.x starts at BATT_VOLT_MAX with a time constant of 20 s and
  // ignores stored factors.
  config_.battery_voltage_lpf = 0.5f;
  config_.battery_current_lpf = 0.75f;
  sensors_.configure(config_);
  board_.battery.put({now_, 16.0f, 8.0f});
  step();
  EXPECT_EQ(now().battery.voltage_V, 16.0f);
  EXPECT_EQ(now().battery.current_A, 8.0f);
  board_.battery.put({now_, 12.0f, 0.0f});
  step();
  EXPECT_FLOAT_EQ(now().battery.voltage_V, 14.0f);
  EXPECT_FLOAT_EQ(now().battery.current_A, 6.0f);
}

TEST_F(SensorsTest, BatteryFilterOfOneFreezesAndOfZeroFollows) {
  config_.battery_voltage_lpf = 1.0f;
  config_.battery_current_lpf = 0.0f;
  sensors_.configure(config_);
  board_.battery.put({now_, 16.0f, 8.0f});
  step();
  board_.battery.put({now_, 12.0f, 1.0f});
  step();
  EXPECT_EQ(now().battery.voltage_V, 16.0f);
  EXPECT_EQ(now().battery.current_A, 1.0f);
}

// ---- nonsense

TEST_F(SensorsTest, SamplesThatAreNoMeasurementAreDropped) {
  imu(kLevel, {0.1f, 0.2f, 0.3f});
  const hal::ImuSample good = now().imu;
  for (const float bad : {kNan, kInf, -kInf, 1e30f}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      hal::Vec3 v = kLevel;
      v[axis] = bad;
      imu(v);
      EXPECT_FALSE(now().new_imu);
      imu(kLevel, v);
      EXPECT_FALSE(now().new_imu);
      board_.mag.put({now_, v, 290.0f});
      step();
      EXPECT_FALSE(now().new_mag);
      hal::GnssSample gnss;
      gnss.velocity_ned_m_s = v;
      board_.gnss.put(gnss);
      step();
      EXPECT_FALSE(now().new_gnss);
    }
  }
  for (const float bad : {kNan, kInf}) {
    imu(kLevel, {}, bad);
    EXPECT_FALSE(now().new_imu);
    board_.baro.put({now_, bad, 290.0f});
    board_.diff_pressure.put({now_, bad, 290.0f});
    board_.battery.put({now_, bad, 1.0f});
    step();
    EXPECT_FALSE(now().new_baro);
    EXPECT_FALSE(now().new_diff_pressure);
    EXPECT_FALSE(now().new_battery);
    board_.battery.put({now_, 12.0f, bad});
    hal::GnssSample gnss;
    gnss.latitude_deg = double{bad};
    board_.gnss.put(gnss);
    step();
    EXPECT_FALSE(now().new_battery);
    EXPECT_FALSE(now().new_gnss);
  }
  EXPECT_EQ(now().imu.gyro_rad_s, good.gyro_rad_s);
  for (const float vacuum : {0.0f, -5.0f}) {
    board_.baro.put({now_, vacuum, 290.0f});
    step();
    EXPECT_FALSE(now().new_baro);
  }
  board_.range.put({now_, kNan, 0.1f, 40.0f, hal::RangeKind::kLidar});
  step();
  EXPECT_FALSE(now().new_range);
  board_.range.put({now_, kInf, 0.1f, 40.0f, hal::RangeKind::kLidar});  // nothing in reach
  step();
  EXPECT_TRUE(now().new_range);
}

TEST_F(SensorsTest, TwentyEqualImuSamplesAreAStuckSensor) {
  const auto put = [this](const hal::Vec3& accel, const hal::Vec3& gyro) {
    board_.imu.put({now_, accel, gyro, 298.15f});
    step();
    return now().new_imu;
  };
  for (int round = 0; round < 3; ++round) {
    const hal::Vec3 gyro{0.1f, 0.2f, 0.01f * static_cast<float>(round)};
    for (int k = 1; k <= 100; ++k) EXPECT_EQ(put(kLevel, gyro), k < 20) << k;
  }
  EXPECT_EQ(sensors_.rejected()[cause(Reject::kStuck)], 3 * 81u);
  for (int axis = 0; axis < 6; ++axis) {  // one bit of any of the six is enough
    for (int k = 0; k < 100; ++k) {
      hal::Vec3 accel = kLevel, gyro{0.1f, 0.2f, 0.3f};
      float& v = axis < 3 ? accel[static_cast<std::size_t>(axis)]
                          : gyro[static_cast<std::size_t>(axis - 3)];
      if (k % 19 == 0) v = std::nextafter(v, 100.0f);
      EXPECT_TRUE(put(accel, gyro)) << axis << " " << k;
    }
  }
}

TEST_F(SensorsTest, SixZerosAreNoImuSample) {
  // Weak point 26: what the ADIS driver of ROSflight 2.x hands over after a bad packet.
  imu(kLevel, {0.1f, 0, 0});
  for (const float zero : {0.0f, -0.0f}) {
    board_.imu.put({now_, {zero, zero, zero}, {zero, zero, zero}, 298.15f});
    step();
    EXPECT_FALSE(now().new_imu);
  }
  EXPECT_EQ(now().imu.gyro_rad_s[0], 0.1f);
  imu(kLevel);  // a perfect gyro at rest
  EXPECT_TRUE(now().new_imu);
  imu({0, 0, 0}, {0, 1e-3f, 0});  // free fall
  EXPECT_TRUE(now().new_imu);
}

TEST_F(SensorsTest, SamplesWithUnusableStampsAreAsIfTheyHadNotCome) {
  for (int k = 0; k < 10; ++k) imu(kLevel, {0.1f, 0, 0});
  const auto at = [this](Time stamp) {
    board_.imu.put({stamp, kLevel, {9.0f, 0, 0}, 298.15f});
    const Events e = step();
    return now().new_imu || e.gyro_done;
  };
  sensors_.start_gyro_calibration();
  EXPECT_FALSE(at(now_ + hal::milliseconds(150)));
  EXPECT_FALSE(at(now_ - hal::milliseconds(10)));
  EXPECT_TRUE(sensors_.imu_step().backwards);
  EXPECT_EQ(now().imu.gyro_rad_s[0], 0.1f);
  EXPECT_EQ(sensors_.rejected()[cause(Reject::kOutlier)], 1u);
  EXPECT_EQ(sensors_.rejected()[cause(Reject::kBackwards)], 1u);
  EXPECT_TRUE(calibrate(kLevel, {0.1f, 0, 0}).gyro_done);
  EXPECT_NEAR(parameters_.get_float(Param::kGyroXBias), 0.1f, 1e-5f);
}

TEST_F(SensorsTest, ACalibrationDoesNotCountDroppedSamples) {
  sensors_.start_gyro_calibration();
  for (int k = 0; k < 500; ++k) {
    imu(kLevel, {kNan, 0, 0});
    EXPECT_FALSE(imu(kLevel, {0.1f, 0, 0}).gyro_done);
  }
  for (int k = 500; k < 1000; ++k) EXPECT_FALSE(imu(kLevel, {0.1f, 0, 0}).gyro_done);
  EXPECT_TRUE(imu(kLevel, {0.1f, 0, 0}).gyro_done);
  EXPECT_NEAR(parameters_.get_float(Param::kGyroXBias), 0.1f, 1e-5f);
}

// ---- gyro filters

TEST_F(SensorsTest, GyroFiltersActAtTheMeasuredRate) {
  config_.gyro_low_pass_Hz = 30.0f;
  config_.gyro_notch_Hz = 100.0f;
  sensors_.configure(config_);
  float largest_before = 0.0f, largest_after = 0.0f;
  for (int k = 0; k < 1000; ++k) {
    imu(kLevel, {std::sin(kPi / 2 * static_cast<float>(k)), 0.25f, 0.0f});  // 100 Hz
    const float x = std::abs(now().imu.gyro_rad_s[0]);
    if (k < 200) largest_before = std::max(largest_before, x);
    if (k > 300) largest_after = std::max(largest_after, x);
    EXPECT_NEAR(now().imu.gyro_rad_s[1], 0.25f, 1e-4f);
    if (k == 600) sensors_.configure(config_);  // another parameter was set: no restart
  }
  EXPECT_NEAR(largest_before, 1.0f, 1e-3f);
  EXPECT_LT(largest_after, 1e-2f);
  EXPECT_EQ(texts(), "");
  // 2 samples of delay at least: what the pilot pays.
  EXPECT_NEAR(sensors_.gyro_chain().group_delay_s(0.0f), 0.0075f + 0.0011f, 1e-3f);
}

TEST_F(SensorsTest, GyroFiltersAboveHalfTheRateAreOffAndTold) {
  config_.gyro_low_pass_Hz = 200.0f;
  config_.gyro_notch_Hz = 250.0f;
  sensors_.configure(config_);
  for (int k = 0; k < 500; ++k) {
    const float x = 0.01f * static_cast<float>(k);
    imu(kLevel, {x, 0, 0});
    EXPECT_EQ(now().imu.gyro_rad_s[0], x);
  }
  EXPECT_EQ(texts(),
            "GYRO_LPF_HZ off: not below 196 Hz\nGYRO_NOTCH_HZ, BW off: not below 196 Hz\n");
}

TEST_F(SensorsTest, GyroFiltersFollowAnotherRate) {
  config_.gyro_low_pass_Hz = 50.0f;
  sensors_.configure(config_);
  for (int k = 0; k < 300; ++k) imu(kLevel, {0.1f, 0, 0});
  const float at_400_Hz = sensors_.gyro_chain().group_delay_s(1.0f);
  for (int k = 0; k < 600; ++k) {
    now_ += hal::microseconds(2500);  // 200 Hz
    imu(kLevel, {0.1f, 0, 0});
    EXPECT_NEAR(now().imu.gyro_rad_s[0], 0.1f, 1e-5f);
  }
  // At 0 Hz sqrt(2)/(2 T tan(pi f T)) samples of T: near sqrt(2)/(2 pi f) = 4.5 ms.
  EXPECT_NEAR(at_400_Hz, 4.268e-3f, 1e-5f);
  EXPECT_NEAR(sensors_.gyro_chain().group_delay_s(1.0f), 3.536e-3f, 1e-5f);
  for (int k = 0; k < 5; ++k) imu(kLevel, {40.0f, 0, 0});
  EXPECT_EQ(sensors_.rejected()[cause(Reject::kGyroClipped)], 5u);
}

TEST_F(SensorsTest, GnssAndRangePassUnchanged) {
  hal::GnssSample gnss;
  gnss.latitude_deg = 40.2673;
  gnss.unix_s = 1'700'000'000;
  gnss.fix = hal::GnssFix::k3d;
  board_.gnss.put(gnss);
  board_.range.put({now_, 2.5f, 0.1f, 40.0f, hal::RangeKind::kLidar});
  step();
  EXPECT_TRUE(now().new_gnss);
  EXPECT_EQ(now().gnss.latitude_deg, 40.2673);
  EXPECT_EQ(now().gnss.unix_s, 1'700'000'000);
  EXPECT_TRUE(now().new_range);
  EXPECT_EQ(now().range.range_m, 2.5f);
  EXPECT_EQ(now().range.max_m, 40.0f);
}

}  // namespace
}  // namespace rosflight::core
