// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sensors/imu.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/sensors/test/samples.hpp"

namespace rosflight::sim::sensors {
namespace {

constexpr double kPi = std::numbers::pi;
const RandomSource kSource{7};

Imu::Config perfect() {
  Imu::Config config;
  config.timing.period = Time{2500};
  return config;
}

hal::ImuSample measured(Imu& imu, const Truth& truth) {
  hal::ImuSample sample;
  EXPECT_TRUE(imu.measure(truth, sample));
  return sample;
}

hal::ImuSample measured(const Imu::Config& config, const Truth& truth) {
  Imu imu(config, kTestGravity, kSource);
  return measured(imu, truth);
}

void expect_near(const hal::Vec3& v, const Vector3& expected, double tolerance) {
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(static_cast<double>(v[static_cast<std::size_t>(i)]), expected[i], tolerance) << i;
  }
}

TEST(Imu, LevelAndAtRestItFeelsGravityUpwards) {
  Truth truth = at_rest(Time{12'345});
  truth.body.w_B = {0.1, -0.2, 0.3};
  const auto sample = measured(perfect(), truth);
  EXPECT_EQ(sample.accel_m_s2, (hal::Vec3{0.0F, 0.0F, -9.80665F}));
  EXPECT_EQ(sample.gyro_rad_s, (hal::Vec3{0.1F, -0.2F, 0.3F}));
  EXPECT_EQ(sample.stamp, Time{12'345});
  EXPECT_EQ(sample.temperature_K, 288.15F);
}

TEST(Imu, NeverRepeatsItselfBitByBit) {
  Imu imu(perfect(), kTestGravity, kSource);
  auto before = measured(imu, at_rest());
  for (int k = 0; k < 100; ++k) {
    const auto sample = measured(imu, at_rest());
    EXPECT_NE(sample.accel_m_s2, before.accel_m_s2);
    expect_near(sample.accel_m_s2, {0.0, 0.0, -kTestGravity}, 1e-6);
    EXPECT_EQ(sample.gyro_rad_s, (hal::Vec3{}));
    before = sample;
  }
}

TEST(Imu, AwayFromTheCentreItFeelsTheTurning) {
  // Spin of 3 rad/s about z, 0.2 m forward: centripetal 9 * 0.2 towards the centre. Angular
  // acceleration of 5 rad/s^2 about z: 5 * 0.2 to the right.
  Imu::Config config = perfect();
  config.position_m = {0.2, 0.0, 0.0};
  Truth truth = at_rest();
  truth.body.w_B = {0.0, 0.0, 3.0};
  truth.angular_acceleration_B = {0.0, 0.0, 5.0};
  expect_near(measured(config, truth).accel_m_s2, {-1.8, 1.0, -kTestGravity}, 1e-6);

  // Roll rate 2 and pitch rate 1, 0.1 m down: w x (w x r) = w (w.r) - r w^2 = (0, 0, -0.5).
  config.position_m = {0.0, 0.0, 0.1};
  truth.body.w_B = {2.0, 1.0, 0.0};
  truth.angular_acceleration_B = {4.0, 0.0, 0.0};  // dw/dt x r = (0, -0.4, 0)
  expect_near(measured(config, truth).accel_m_s2, {0.0, -0.4, -kTestGravity - 0.5}, 1e-6);
}

TEST(Imu, MountingIsWhatTheFirmwareUndoes) {
  // ROSflight 2.x with IMU_YAW = 90 turns a measured (1, 0, 0) into (0, -1, 0); so a body vector
  // (0, -1, 0) must be measured as (1, 0, 0).
  Imu::Config config = perfect();
  config.rotation_deg = {0.0, 0.0, 90.0};
  Truth truth = at_rest();
  truth.body.w_B = {0.0, -1.0, 0.0};
  expect_near(measured(config, truth).gyro_rad_s, {1.0, 0.0, 0.0}, 1e-7);

  config.rotation_deg = {180.0, 0.0, 0.0};  // upside down
  expect_near(measured(config, at_rest()).accel_m_s2, {0.0, 0.0, kTestGravity}, 1e-6);
}

TEST(Imu, RotationsComeInTheOrderYawPitchRoll) {
  // Against Eigen's own construction of R = Rz(yaw) Ry(pitch) Rx(roll).
  const Vector3 angles_deg{20.0, -50.0, 130.0};
  const Vector3 rad = angles_deg * kPi / 180.0;
  const Eigen::Matrix3d expected =
      (Eigen::AngleAxisd(rad.z(), Vector3::UnitZ()) * Eigen::AngleAxisd(rad.y(), Vector3::UnitY()) *
       Eigen::AngleAxisd(rad.x(), Vector3::UnitX()))
          .toRotationMatrix();
  EXPECT_TRUE(mounting_rotation(angles_deg).isApprox(expected, 1e-14));
}

TEST(Imu, SaturatesAndRoundsInItsOwnAxes) {
  Imu::Config config = perfect();
  config.gyro_rad_s.axis.limit = 2.0;
  config.gyro_rad_s.axis.resolution = 0.25;
  config.rotation_deg = {0.0, 0.0, 90.0};
  Truth truth = at_rest();
  truth.body.w_B = {50.0, 0.6, 0.3};
  expect_near(measured(config, truth).gyro_rad_s, {-0.5, 2.0, 0.25}, 1e-7);
}

TEST(Imu, VibrationGrowsWithRotorSpeed) {
  Imu::Config config = perfect();
  config.accel_vibration_m_s_rad = 1e-3;
  Imu imu(config, kTestGravity, kSource);
  Truth truth = at_rest();
  EXPECT_EQ(measured(imu, truth).accel_m_s2[0], 0.0F);  // rotors stand: no draw, no noise

  truth.rotor_count = 2;
  truth.rotor_speed_rad_s[0] = 700.0;
  truth.rotor_speed_rad_s[1] = 100.0;  // root mean square 500
  constexpr int kSamples = 20'000;
  double squares = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const auto x = static_cast<double>(measured(imu, truth).accel_m_s2[0]);
    squares += x * x;
  }
  EXPECT_NEAR(std::sqrt(squares / kSamples) / 0.5, 1.0, 4.0 / std::sqrt(2.0 * kSamples));
  EXPECT_EQ(measured(imu, truth).gyro_rad_s[0], 0.0F);
}

TEST(Imu, LinesHaveTheFrequenciesOfRotorAndBladesAndThePowerOfTheNoise) {
  Imu::Config config = perfect();
  config.timing.period = Time{500};
  config.shows_lines = true;
  config.blades = 3;
  config.accel_vibration_m_s_rad = 1e-3;
  config.gyro_lines = 2e-4;
  Imu imu(config, kTestGravity, kSource);
  Truth truth = at_rest();
  truth.rotor_count = 1;
  constexpr double kTurns_s = 60.0;  // a whole number in the time below
  truth.rotor_speed_rad_s[0] = 2.0 * kPi * kTurns_s;
  constexpr int kSamples = 2000;  // 1 s
  const double sigma = 1e-3 * truth.rotor_speed_rad_s[0];
  // Amplitude of a line, from the sums of sine and cosine over whole turns.
  struct Line {
    double frequency_hz;
    double sine{0.0}, cosine{0.0}, squares{0.0};
    void add(double t_s, double x) {
      sine += x * std::sin(2.0 * kPi * frequency_hz * t_s);
      cosine += x * std::cos(2.0 * kPi * frequency_hz * t_s);
      squares += x * x;
    }
    double amplitude() const { return 2.0 / kSamples * std::hypot(sine, cosine); }
    double rms() const { return std::sqrt(squares / kSamples); }
  };
  Line x{kTurns_s}, z{3.0 * kTurns_s}, gyro_y{kTurns_s};
  for (int k = 0; k < kSamples; ++k) {
    truth.time = Time{500 * k};
    const auto sample = measured(imu, truth);
    x.add(5e-4 * k, static_cast<double>(sample.accel_m_s2[0]));
    z.add(5e-4 * k, static_cast<double>(sample.accel_m_s2[2]) + kTestGravity);
    gyro_y.add(5e-4 * k, static_cast<double>(sample.gyro_rad_s[1]));
  }
  for (const Line& line : {x, z}) {
    EXPECT_NEAR(line.amplitude(), std::sqrt(2.0) * sigma, 1e-3 * sigma);
    EXPECT_NEAR(line.rms(), sigma, 1e-3 * sigma) << "nothing else";
  }
  EXPECT_NEAR(gyro_y.rms(), 0.2 * sigma, 1e-4 * sigma);
}

TEST(Imu, TemperatureMovesTheBias) {
  Imu::Config config = perfect();
  config.temperature.rise_K = 30.0;
  config.accel_temperature_m_s2_K = {0.01, 0.0, -0.02};
  config.gyro_temperature_rad_s_K = {0.0, 1e-3, 0.0};
  const auto sample = measured(config, at_rest());  // 288.15 + 30 is 20 K above 298.15
  EXPECT_FLOAT_EQ(sample.temperature_K, 318.15F);
  expect_near(sample.accel_m_s2, {0.2, 0.0, -kTestGravity - 0.4}, 1e-6);
  expect_near(sample.gyro_rad_s, {0.0, 0.02, 0.0}, 1e-7);
}

TEST(Imu, WarmsUpExponentially) {
  Imu::Config config = perfect();
  config.temperature.rise_K = 20.0;
  config.warm_up_s = 10.0;
  Imu imu(config, kTestGravity, kSource);
  hal::ImuSample sample;
  for (int i = 0; i < 4000; ++i) sample = measured(imu, at_rest());
  // After one time constant 1 - 1/e of the rise; float has 3e-5 K there.
  EXPECT_NEAR(static_cast<double>(sample.temperature_K), 288.15 + 20.0 * (1.0 - std::exp(-1.0)),
              1e-4);
}

TEST(Imu, ReportsItsBiases) {
  Imu::Config config = perfect();
  config.gyro_rad_s.fixed_bias = {0.1, 0.2, 0.3};
  config.accel_m_s2.axis.turn_on_bias = 0.5;
  config.accel_m_s2.axis.noise_sigma = 0.0;
  Imu imu(config, kTestGravity, kSource);
  const auto sample = measured(imu, at_rest());
  EXPECT_TRUE(imu.gyro_bias().isApprox(Vector3(0.1, 0.2, 0.3), 1e-15));
  expect_near(sample.accel_m_s2, Vector3(0.0, 0.0, -kTestGravity) + imu.accel_bias(), 1e-6);
  EXPECT_GT(imu.accel_bias().cwiseAbs().minCoeff(), 0.0);
  EXPECT_NE(imu.accel_bias().x(), imu.accel_bias().y());
}

TEST(Imu, ReferenceHabitsStandstillQuietAndTransient) {
  Imu::Config config = perfect();
  config.standstill_speed_m_s = 0.05;
  config.quiet_without_rotors = true;
  config.gyro_rad_s.axis.noise_sigma = 1.0;
  config.gyro_transient_rad_s = {0.003, -0.002, 0.001};
  config.gyro_transient_time_s = 400.0;
  Imu imu(config, kTestGravity, kSource);

  Truth truth = at_rest();
  truth.body.v_B = {0.0, 0.04, 0.0};
  truth.specific_force_B = {3.0, 0.0, 0.0};
  truth.body.q_WB = turned(kPi / 2.0, Vector3::UnitX());
  auto sample = measured(imu, truth);
  expect_near(sample.accel_m_s2, {0.0, -kTestGravity, 0.0},
              1e-6);  // right side down: gravity to the left is up
  // First sample: b (1 - T/(T + tau)).
  expect_near(sample.gyro_rad_s, Vector3(0.003, -0.002, 0.001) * (400.0 / 400.0025), 1e-9);

  truth.body.v_B = {0.0, 0.06, 0.0};
  truth.rotor_count = 4;
  truth.rotor_speed_rad_s.fill(1.0);
  sample = measured(imu, truth);
  expect_near(sample.accel_m_s2, {3.0, 0.0, 0.0}, 1e-6);
  EXPECT_GT(std::abs(sample.gyro_rad_s[0]), 0.01F);
}

}  // namespace
}  // namespace rosflight::sim::sensors
