// SPDX-License-Identifier: BSD-3-Clause
#include <random>
#include <tuple>
#include <utility>

#include "firmware/core/test/sensors_rig.hpp"

namespace rosflight::core {
namespace {

class SensorsCalibrationTest : public SensorsTest {};

// ---- IMU calibration

TEST_F(SensorsCalibrationTest, GyroCalibrationFindsTheBiasAndReportsIt) {
  sensors_.start_gyro_calibration();
  EXPECT_TRUE(sensors_.calibrating_imu());
  const Events e = calibrate(kLevel, {0.02f, -0.03f, 0.04f});
  EXPECT_TRUE(e.gyro_done);
  EXPECT_FALSE(e.gyro_failed || e.accel_done || e.accel_settled);
  EXPECT_FALSE(sensors_.calibrating_imu());
  // A float sum of 1001 samples is good to some 1e-6 of itself.
  EXPECT_NEAR(parameters_.get_float(Param::kGyroXBias), 0.02f, 1e-6f);
  EXPECT_NEAR(parameters_.get_float(Param::kGyroYBias), -0.03f, 1e-6f);
  EXPECT_NEAR(parameters_.get_float(Param::kGyroZBias), 0.04f, 1e-6f);
  EXPECT_NE(texts(), "");  // weak point 35: success is reported too
  imu(kLevel, {0.02f, -0.03f, 0.04f});
  expect_near(now().imu.gyro_rad_s, {0, 0, 0}, 1e-6f);  // in force at once
}

TEST_F(SensorsCalibrationTest, AFailedGyroCalibrationKeepsTheOldBias) {
  // Weak point 34: in ROSflight 2.x the biases stay zero.
  set(Param::kGyroXBias, 0.1f);
  config_.gyro_bias = {0.1f, 0, 0};
  sensors_.configure(config_);
  sensors_.start_gyro_calibration();
  const Events e = calibrate(kLevel, {0.6f, 0.6f, 0.6f});  // norm 1.04 rad/s
  EXPECT_TRUE(e.gyro_failed);
  EXPECT_FALSE(e.gyro_done);
  EXPECT_EQ(parameters_.get_float(Param::kGyroXBias), 0.1f);
  EXPECT_NE(texts(), "");
  imu(kLevel, {0.3f, 0, 0});
  EXPECT_NEAR(now().imu.gyro_rad_s[0], 0.2f, 1e-6f);
}

TEST_F(SensorsCalibrationTest, GyroCalibrationRefusesATurnThatIsNoOffset) {
  for (const float rate : {0.34f, 0.36f, 0.5f, -0.5f, 3.0f}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      set(Param::kGyroXBias, 0.0f);
      hal::Vec3 gyro{};
      gyro[axis] = rate;
      sensors_.start_gyro_calibration();
      const bool done = calibrate(kLevel, gyro).gyro_done;
      EXPECT_EQ(done, rate == 0.34f) << rate;
      if (rate == 0.5f) {
        EXPECT_EQ(texts(), "Gyro calibration refused: mean 0.50 rad/s\n");
      }
      if (!done) {
        EXPECT_EQ(parameters_.get_float(Param::kGyroXBias), 0.0f);
      }
      texts();
    }
  }
}

TEST_F(SensorsCalibrationTest, GyroCalibrationRefusesShakingAndSlowTurns) {
  const auto calibrated = [this](const auto& accel, const auto& gyro) {
    sensors_.start_gyro_calibration();
    Events e;
    for (int k = 0; k < kCalibrationSamples; ++k) {
      const float t = 0.0025f * static_cast<float>(k);
      e = imu(accel(t), gyro(t));
    }
    return e.gyro_done;
  };
  const auto still = [](float) { return kLevel; };
  set(Param::kGyroXBias, 0.125f);
  // A swing of +-0.4 rad/s, whose mean is nothing.
  EXPECT_FALSE(
      calibrated(still, [](float t) { return hal::Vec3{0.4f * std::sin(20.0f * t), 0.0f, 0.0f}; }));
  EXPECT_EQ(texts(), "Gyro calibration refused: moved 0.80 rad/s\n");
  // One knock.
  EXPECT_FALSE(calibrated(
      still, [](float t) { return hal::Vec3{0.0f, 0.0f, t > 1.0f && t < 1.02f ? 0.5f : 0.0f}; }));
  EXPECT_EQ(texts(), "Gyro calibration refused: moved 0.50 rad/s\n");
  // 0.06 rad/s of roll for 2.5 s: 0.15 rad, 1.46 m/s^2.
  EXPECT_FALSE(calibrated(
      [](float t) {
        return hal::Vec3{0.0f, -9.80665f * std::sin(0.06f * t), -9.80665f * std::cos(0.06f * t)};
      },
      [](float) { return hal::Vec3{0.06f, 0.0f, 0.0f}; }));
  EXPECT_NE(texts().find("Gyro calibration refused: swayed 1.4"), std::string::npos);
  EXPECT_EQ(parameters_.get_float(Param::kGyroXBias), 0.125f);
}

TEST_F(SensorsCalibrationTest, GyroCalibrationAcceptsTheSensorsInStillHands) {
  // Offset of the simulated parts, their noise, 8 Hz of trembling hands and a gust.
  for (const auto& [bias, sigma] : {std::pair{0.25f, 0.00226f}, {0.0175f, 0.0049f}}) {
    std::mt19937 random(1);
    std::normal_distribution<float> noise(0.0f, sigma);
    std::normal_distribution<float> accel_noise(0.0f, 0.05f);
    sensors_.start_gyro_calibration();
    Events e;
    for (int k = 0; k < kCalibrationSamples; ++k) {
      const float t = 0.0025f * static_cast<float>(k);
      const float tremble = 0.05f * std::sin(50.0f * t);
      e = imu(
          {accel_noise(random), accel_noise(random), -9.80665f + accel_noise(random)},
          {bias + tremble + noise(random), -bias + noise(random), bias - tremble + noise(random)});
    }
    EXPECT_TRUE(e.gyro_done) << texts();
    EXPECT_NEAR(parameters_.get_float(Param::kGyroYBias), -bias, 1e-3f);
  }
}

TEST_F(SensorsCalibrationTest, GyroCalibrationOfTheNoisiestSimulatedSensorPasses) {
  std::mt19937 random(2);
  std::normal_distribution<float> noise(0.0f, 0.0226f);
  for (int run = 0; run < 20; ++run) {
    sensors_.start_gyro_calibration();
    Events e;
    for (int k = 0; k < kCalibrationSamples; ++k) {
      e = imu(kLevel, {noise(random), noise(random), noise(random)});
    }
    EXPECT_TRUE(e.gyro_done) << texts();
  }
}

TEST_F(SensorsCalibrationTest, AccelCalibrationFindsBothBiases) {
  sensors_.start_accel_calibration();
  const Events e = calibrate({0.2f, -0.1f, -9.50665f}, {0.01f, 0, 0});
  EXPECT_TRUE(e.accel_done && e.accel_settled && e.gyro_done);
  EXPECT_NEAR(parameters_.get_float(Param::kAccXBias), 0.2f, 1e-5f);
  EXPECT_NEAR(parameters_.get_float(Param::kAccYBias), -0.1f, 1e-5f);
  EXPECT_NEAR(parameters_.get_float(Param::kAccZBias), 0.3f, 1e-5f);
  EXPECT_NEAR(parameters_.get_float(Param::kGyroXBias), 0.01f, 1e-6f);
  imu({0.2f, -0.1f, -9.50665f});
  expect_near(now().imu.accel_m_s2, kLevel, 1e-5f);
}

TEST_F(SensorsCalibrationTest, AccelCalibrationIsFreeOfTheOldBiasAndOfTemperature) {
  config_.acc_bias = {3.0f, 3.0f, 3.0f};
  config_.acc_temp_comp = {0.001f, 0, 0};
  sensors_.configure(config_);
  sensors_.start_accel_calibration();
  Events e;
  for (int k = 0; k < kCalibrationSamples; ++k) e = imu({0.5f, 0, -9.80665f}, {}, 300.0f);
  EXPECT_TRUE(e.accel_done);
  EXPECT_NEAR(parameters_.get_float(Param::kAccXBias), 0.5f - 0.3f, 1e-5f);
  EXPECT_NEAR(parameters_.get_float(Param::kAccYBias), 0.0f, 1e-5f);
}

TEST_F(SensorsCalibrationTest, AccelCalibrationRefusesMotion) {
  // Spread is the norm of maximum less minimum: up to 1.0 m/s^2.
  sensors_.start_accel_calibration();
  Events e = calibrate(kLevel, {}, {0.49f, 0, 0});
  EXPECT_TRUE(e.accel_done);
  set(Param::kAccXBias, 0.25f);
  sensors_.start_accel_calibration();
  e = calibrate(kLevel, {}, {0.3f, 0.3f, 0.3f});  // 0.6 * sqrt(3) = 1.04
  EXPECT_FALSE(e.accel_done);
  EXPECT_FALSE(e.accel_settled);  // the estimator is not reset by a shake
  EXPECT_EQ(parameters_.get_float(Param::kAccXBias), 0.25f);
}

TEST_F(SensorsCalibrationTest, AccelCalibrationRefusesATiltAboveFiveDegrees) {
  const auto tilted = [this](float roll_deg, float pitch_deg) {
    const float r = roll_deg * kRadPerDeg, p = pitch_deg * kRadPerDeg;
    const float g = 9.80665f;
    set(Param::kAccXBias, 0.25f);
    texts();
    sensors_.start_accel_calibration();
    return calibrate(
        {g * std::sin(p), -g * std::sin(r) * std::cos(p), -g * std::cos(r) * std::cos(p)}, {});
  };
  EXPECT_TRUE(tilted(4.9f, 0).accel_done);
  EXPECT_TRUE(tilted(0, -4.9f).accel_done);
  for (const auto& [roll, pitch, text] : {std::tuple{5.5f, 0.0f, "tilt 5.5 deg"},
                                          {0.0f, -20.0f, "tilt 20.0 deg"},
                                          {-4.0f, 4.0f, "tilt 5.7 deg"},
                                          {80.0f, 0.0f, "tilt 80.0 deg"},
                                          {179.0f, 0.0f, "tilt 179.0 deg"}}) {
    const Events e = tilted(roll, pitch);
    EXPECT_FALSE(e.accel_done || e.accel_settled);
    EXPECT_EQ(parameters_.get_float(Param::kAccXBias), 0.25f);
    const std::string all = texts();
    EXPECT_NE(all.find(std::string("Accel calibration refused: ") + text), std::string::npos)
        << all;
  }
  // The offsets of the simulated sensors are no tilt.
  sensors_.start_accel_calibration();
  EXPECT_TRUE(calibrate({0.6f, 0.6f, -9.20665f}, {}).accel_done) << texts();
}

TEST_F(SensorsCalibrationTest, AccelCalibrationRefusesALargeBiasAndKeepsTheOld) {
  set(Param::kAccZBias, 0.25f);
  config_.acc_bias = {0, 0, 0.25f};
  sensors_.configure(config_);
  sensors_.start_accel_calibration();
  const Events e = calibrate({0, 0, -9.80665f - 3.1f}, {});
  EXPECT_FALSE(e.accel_done);
  EXPECT_TRUE(e.accel_settled);
  EXPECT_EQ(parameters_.get_float(Param::kAccZBias), 0.25f);
  EXPECT_NE(texts().find("3.10"), std::string::npos);  // the norm is in the message
  imu(kLevel);
  EXPECT_NEAR(now().imu.accel_m_s2[2], -9.80665f - 0.25f, 1e-6f);
}

TEST_F(SensorsCalibrationTest, AStoppedCalibrationLeavesEverythingAsItWas) {
  set(Param::kGyroXBias, 0.1f);
  config_.gyro_bias = {0.1f, 0, 0};
  sensors_.configure(config_);
  sensors_.start_accel_calibration();
  for (int k = 0; k < 600; ++k) imu(kLevel, {0.5f, 0, 0});
  EXPECT_NEAR(now().imu.gyro_rad_s[0], 0.5f, 1e-6f);  // bias not subtracted while it is measured
  sensors_.stop_calibrations();
  EXPECT_FALSE(sensors_.calibrating_imu());
  const Events e = calibrate(kLevel, {0.5f, 0, 0});
  EXPECT_FALSE(e.gyro_done || e.gyro_failed || e.accel_done || e.accel_settled);
  EXPECT_NEAR(now().imu.gyro_rad_s[0], 0.4f, 1e-6f);
  EXPECT_EQ(parameters_.get_float(Param::kGyroXBias), 0.1f);
}

TEST_F(SensorsCalibrationTest, CalibratesInBodyAxes) {
  config_.imu_mounting_deg = {180.0f, 0.0f, 0.0f};  // upside down on its board
  sensors_.configure(config_);
  sensors_.start_accel_calibration();
  const Events e = calibrate({0.0f, 0.2f, 9.80665f}, {0, 0.1f, 0});
  EXPECT_TRUE(e.accel_done);
  EXPECT_NEAR(parameters_.get_float(Param::kAccYBias), -0.2f, 1e-5f);
  EXPECT_NEAR(parameters_.get_float(Param::kAccZBias), 0.0f, 2e-5f);
  EXPECT_NEAR(parameters_.get_float(Param::kGyroYBias), -0.1f, 1e-5f);
}

// ---- pressure calibration

TEST_F(SensorsCalibrationTest, BarometerCalibrationSetsBiasAndGroundLevel) {
  sensors_.start_baro_calibration();
  for (int k = 0; k < 256; ++k) {
    now_ += hal::milliseconds(25);
    board_.baro.put({now_, 90'000.0f, 280.0f});
    step();
  }
  EXPECT_NEAR(parameters_.get_float(Param::kBaroBias), 90'000.0f, 0.01f);
  EXPECT_NEAR(parameters_.get_float(Param::kGroundLevel), 988.545f, 5e-3f);
  EXPECT_NE(texts(), "");
  // Recorded, not used: altitude stays that of the raw pressure (weak point 33).
  EXPECT_NEAR(now().altitude_m, 988.545f, 5e-3f);
}

TEST_F(SensorsCalibrationTest, BarometerCalibrationDoesNotCountRejectedPressures) {
  const float bias = parameters_.get_float(Param::kBaroBias);
  const float level = parameters_.get_float(Param::kGroundLevel);
  sensors_.start_baro_calibration();
  for (int k = 0; k < 512; ++k) {
    now_ += hal::milliseconds(25);
    board_.baro.put({now_, 100.0f, 280.0f});
    step();
  }
  EXPECT_EQ(parameters_.get_float(Param::kBaroBias), bias);
  EXPECT_EQ(parameters_.get_float(Param::kGroundLevel), level);
}

TEST_F(SensorsCalibrationTest, BarometerCalibrationDoesNotTakeHalfOfAResult) {
  // 119 kPa would be a ground level of -1390 m, below its range: neither parameter may change.
  const float bias = parameters_.get_float(Param::kBaroBias);
  const float level = parameters_.get_float(Param::kGroundLevel);
  sensors_.start_baro_calibration();
  for (int k = 0; k < 256; ++k) {
    now_ += hal::milliseconds(25);
    board_.baro.put({now_, 119'000.0f, 280.0f});
    step();
  }
  EXPECT_EQ(parameters_.get_float(Param::kBaroBias), bias);
  EXPECT_EQ(parameters_.get_float(Param::kGroundLevel), level);
  EXPECT_NE(texts(), "");
}

TEST_F(SensorsCalibrationTest, AirspeedCalibrationTakesTheOffsetAtOnce) {
  sensors_.start_airspeed_calibration();
  for (int k = 0; k < 256; ++k) {
    now_ += hal::milliseconds(25);
    board_.diff_pressure.put({now_, 12.5f, 280.0f});
    step();
  }
  EXPECT_FLOAT_EQ(parameters_.get_float(Param::kDiffPressBias), 12.5f);
  EXPECT_NEAR(now().diff_pressure.pressure_Pa, 0.0f, 1e-5f);
}

TEST_F(SensorsCalibrationTest, AnUnsteadyAirspeedKeepsTheOffset) {
  set(Param::kDiffPressBias, 3.0f);
  config_.diff_pressure_bias_Pa = 3.0f;
  sensors_.configure(config_);
  sensors_.start_airspeed_calibration();
  for (int k = 0; k < 256; ++k) {
    now_ += hal::milliseconds(25);
    board_.diff_pressure.put({now_, k % 2 == 0 ? 50.0f : -50.0f, 280.0f});
    step();
  }
  EXPECT_EQ(parameters_.get_float(Param::kDiffPressBias), 3.0f);
  EXPECT_NE(texts(), "");
  board_.diff_pressure.put({now_, 3.0f, 280.0f});
  step();
  EXPECT_FLOAT_EQ(now().diff_pressure.pressure_Pa, 0.0f);
}

}  // namespace
}  // namespace rosflight::core
