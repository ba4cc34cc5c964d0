// SPDX-License-Identifier: BSD-3-Clause
#include "messages/simulation.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace rosflight::messages {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Simulation, PulsesAreThoseOfTheReference) {
  EXPECT_EQ(pulse_us(0.0F), 1000);
  EXPECT_EQ(pulse_us(1.0F), 2000);
  EXPECT_EQ(pulse_us(0.4799F), 1479);  // 1000 + floor(1000 x)
  EXPECT_EQ(pulse_us(0.5F), 1500);
  EXPECT_EQ(pulse_us(0.001F), 1001);
  EXPECT_EQ(pulse_us(-0.2F), 1000);
  EXPECT_EQ(pulse_us(7.0F), 2000);
  EXPECT_EQ(pulse_us(std::numeric_limits<float>::quiet_NaN()), 1000);
}

TEST(Simulation, EveryPulseComesBackAsItself) {
  for (std::uint16_t pulse = 1000; pulse <= 2000; ++pulse)
    EXPECT_EQ(pulse_us(fraction(pulse)), pulse);
}

TEST(Simulation, ALevelThatNoTransmitterSendsReachesTheFirmware) {
  rosflight_msgs::RCRaw message;
  message.values = {1000, 1500, 2000, 0, 1250, 1750, 3000, 1000};
  hal::RcFrame frame;
  from_message(message, frame);
  EXPECT_EQ(frame.channel_count, 8);
  EXPECT_FLOAT_EQ(frame.channels[1], 0.5F);
  EXPECT_FLOAT_EQ(frame.channels[3], -1.0F);
  EXPECT_FLOAT_EQ(frame.channels[6], 2.0F);
}

TEST(Simulation, AtRestOnTheGroundTheAccelerationIsZeroAndTheSpecificForceMinusG) {
  sim::Truth truth;
  truth.specific_force_B = {0.0, 0.0, -9.81};
  const auto message = to_message(truth, 9.81);
  EXPECT_NEAR(message.acceleration.linear.z, 0.0, 1e-12);
  sim::Truth back;
  ASSERT_TRUE(from_message(message, 9.81, back));
  EXPECT_NEAR(back.specific_force_B.z(), -9.81, 1e-12);
}

TEST(Simulation, FreeFallNoseDownIsGAlongX) {
  sim::Truth truth;  // pitched down 90 deg: x points down
  truth.body.q_WB = Eigen::AngleAxisd(-1.5707963267948966, sim::Vector3::UnitY());
  const auto message = to_message(truth, 9.81);
  EXPECT_NEAR(message.acceleration.linear.x, 9.81, 1e-9);
  EXPECT_NEAR(message.acceleration.linear.z, 0.0, 1e-9);
}

TEST(Simulation, TruthGoesThereAndBack) {
  sim::Truth truth;
  truth.body.p_W = {1.0, -2.0, -3.0};
  truth.body.q_WB = sim::Quaternion{0.5, 0.5, -0.5, 0.5};
  truth.body.v_B = {4.0, 5.0, 6.0};
  truth.body.w_B = {0.1, 0.2, 0.3};
  truth.specific_force_B = {7.0, 8.0, 9.0};
  truth.angular_acceleration_B = {1.5, 2.5, 3.5};
  const auto message = to_message(truth, 9.81);
  sim::Truth back;
  ASSERT_TRUE(from_message(message, 9.81, back));
  EXPECT_TRUE(back.body.p_W.isApprox(truth.body.p_W));
  EXPECT_TRUE(back.body.q_WB.isApprox(truth.body.q_WB));
  EXPECT_TRUE(back.body.v_B.isApprox(truth.body.v_B));
  EXPECT_TRUE(back.body.w_B.isApprox(truth.body.w_B));
  EXPECT_TRUE(back.specific_force_B.isApprox(truth.specific_force_B, 1e-12));
  EXPECT_TRUE(back.angular_acceleration_B.isApprox(truth.angular_acceleration_B));
}

TEST(Simulation, ASickTruthIsRefusedAndChangesNothing) {
  rosflight_msgs::SimState message;
  sim::Truth truth;
  truth.body.p_W.x() = 3.0;
  message.pose.orientation.w = 1.0;
  message.pose.position.y = kNan;
  EXPECT_FALSE(from_message(message, 9.81, truth));
  message.pose.position.y = 0.0;
  message.pose.orientation.w = 0.0;
  EXPECT_FALSE(from_message(message, 9.81, truth));
  message.pose.orientation.w = kNan;
  EXPECT_FALSE(from_message(message, 9.81, truth));
  EXPECT_EQ(truth.body.p_W.x(), 3.0);
}

TEST(Simulation, ASickWrenchIsRefusedAndChangesNothing) {
  geometry_msgs::WrenchStamped message;
  message.wrench.force.z = -30.0;
  message.wrench.torque.x = std::numeric_limits<double>::infinity();
  sim::Wrench wrench;
  EXPECT_FALSE(from_message(message, wrench));
  EXPECT_EQ(wrench.force_B.z(), 0.0);
  message.wrench.torque.x = 0.25;
  EXPECT_TRUE(from_message(message, wrench));
  EXPECT_EQ(wrench.force_B.z(), -30.0);
  EXPECT_EQ(wrench.torque_B.x(), 0.25);
}

TEST(Simulation, TheImuGoesThereAndBackAndItsTemperatureIsCelsius) {
  hal::ImuSample sample;
  sample.accel_m_s2 = {1.0F, 2.0F, -9.75F};
  sample.gyro_rad_s = {0.5F, -0.25F, 0.125F};
  sample.temperature_K = 300.15F;
  const auto imu = to_message(sample);
  const auto temperature = imu_temperature(sample);
  EXPECT_NEAR(temperature.temperature, 27.0, 1e-4);
  EXPECT_EQ(imu.orientation_covariance[0], -1.0);
  hal::ImuSample back;
  from_message(imu, back);
  EXPECT_EQ(back.accel_m_s2, sample.accel_m_s2);
  EXPECT_EQ(back.gyro_rad_s, sample.gyro_rad_s);
}

TEST(Simulation, AFixGoesThereAndBack) {
  hal::GnssSample sample;
  sample.fix = hal::GnssFix::k3d;
  sample.satellites = 15;
  sample.latitude_deg = 40.2463724;
  sample.longitude_deg = -111.6474138;
  sample.height_msl_m = 1387.0F;
  sample.velocity_ned_m_s = {1.0F, 2.0F, 3.0F};
  sample.horizontal_accuracy_m = 0.5F;
  sample.vertical_accuracy_m = 0.75F;
  sample.speed_accuracy_m_s = 0.25F;
  sample.unix_s = 1'780'336'800;
  sample.unix_ns = 250'000'000;
  auto message = to_message(sample);
  hal::GnssSample back;
  from_message(message, back);
  EXPECT_EQ(back.fix, sample.fix);
  EXPECT_EQ(back.satellites, sample.satellites);
  EXPECT_EQ(back.latitude_deg, sample.latitude_deg);
  EXPECT_EQ(back.longitude_deg, sample.longitude_deg);
  EXPECT_EQ(back.height_msl_m, sample.height_msl_m);
  EXPECT_EQ(back.velocity_ned_m_s, sample.velocity_ned_m_s);
  EXPECT_EQ(back.horizontal_accuracy_m, sample.horizontal_accuracy_m);
  EXPECT_EQ(back.vertical_accuracy_m, sample.vertical_accuracy_m);
  EXPECT_EQ(back.speed_accuracy_m_s, sample.speed_accuracy_m_s);
  EXPECT_EQ(back.unix_s, sample.unix_s);
  EXPECT_EQ(back.unix_ns, sample.unix_ns);
  message.fix_type = 77;
  from_message(message, back);
  EXPECT_EQ(back.fix, hal::GnssFix::kNone);
}

TEST(Simulation, TheOtherSensorsGoThereAndBack) {
  const auto baro = to_message(hal::BaroSample{{}, 85729.0F, 300.15F});
  hal::BaroSample baro_back;
  from_message(baro, baro_back);
  EXPECT_EQ(baro_back.pressure_Pa, 85729.0F);
  EXPECT_EQ(baro_back.temperature_K, 300.15F);

  const auto pitot = to_message(hal::DiffPressureSample{{}, -12.5F, 299.0F});
  hal::DiffPressureSample pitot_back;
  from_message(pitot, pitot_back);
  EXPECT_EQ(pitot_back.pressure_Pa, -12.5F);
  EXPECT_EQ(pitot_back.temperature_K, 299.0F);

  const auto range = to_message(hal::RangeSample{{}, 2.5F, 0.25F, 8.0F, hal::RangeKind::kLidar});
  EXPECT_EQ(range.radiation_type, sensor_msgs::Range::INFRARED);
  hal::RangeSample range_back;
  from_message(range, range_back);
  EXPECT_EQ(range_back.kind, hal::RangeKind::kLidar);
  EXPECT_EQ(range_back.range_m, 2.5F);
  EXPECT_EQ(range_back.min_m, 0.25F);
  EXPECT_EQ(range_back.max_m, 8.0F);

  const auto battery = to_message(hal::BatterySample{{}, 23.5F, 12.25F});
  hal::BatterySample battery_back;
  from_message(battery, battery_back);
  EXPECT_EQ(battery_back.voltage_V, 23.5F);
  EXPECT_EQ(battery_back.current_A, 12.25F);

  const auto mag = to_message(hal::MagSample{{}, {2.0e-5F, 4.0e-6F, 4.5e-5F}, {}});
  hal::MagSample mag_back;
  from_message(mag, mag_back);
  EXPECT_EQ(mag_back.field_T, (hal::Vec3{2.0e-5F, 4.0e-6F, 4.5e-5F}));
}

}  // namespace
}  // namespace rosflight::messages
