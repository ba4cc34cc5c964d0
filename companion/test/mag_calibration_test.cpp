// SPDX-License-Identifier: BSD-3-Clause
#include "companion/mag_calibration.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "companion/test/rig.hpp"

namespace rosflight::companion::test {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kGravity_m_s2 = 9.80665;

std::vector<FakeFcu::Parameter> mag_table() {
  std::vector<FakeFcu::Parameter> table;
  for (const char* name : {"MAG_X_BIAS", "MAG_Y_BIAS", "MAG_Z_BIAS"}) {
    table.push_back({name, ParameterValue::of(1e-5f)});  // of an earlier calibration
  }
  for (char i = '0'; i < '3'; ++i) {
    for (char j = '0'; j < '3'; ++j) {
      table.push_back({std::string("MAG_CAL_A") + i + j, ParameterValue::of(i == j ? 1.5f : 0.0f)});
    }
  }
  return table;
}

/// A vehicle in a person's hands, 400 Hz IMU and 100 Hz magnetometer, and an FCU that applies its
/// correction.
struct Bench : Rig {
  Bench() : Rig(mag_table()), calibration(session) {
    fcu.imu = false;
    calibration.on_prompt([this](const std::string& line) { prompts.push_back(line); });
    run_until([this] { return session.parameters().complete() && session.connected(); });
  }

  Vector3d raw() const {
    // Inclination 60 deg, 50 uT; soft iron stretches x and y apart.
    const Vector3d field_W(25e-6, 0.0, 43.3e-6);
    Matrix3d soft;
    soft << 1.1, 0.05, 0.0, 0.05, 0.95, 0.0, 0.0, 0.0, 1.0;
    return soft * (q_WB.conjugate() * field_W) + Vector3d(15e-6, -10e-6, 5e-6);
  }
  Vector3d corrected() const {
    FakeFcu& unit = const_cast<FakeFcu&>(fcu);
    Vector3d b;
    Matrix3d a;
    for (int i = 0; i < 3; ++i) {
      const char* const axes = "XYZ";
      b(i) = unit.find(std::string("MAG_") + axes[i] + "_BIAS")->value.number();
      for (int j = 0; j < 3; ++j) {
        a(i, j) = unit.find("MAG_CAL_A" + std::to_string(i) + std::to_string(j))->value.number();
      }
    }
    return a * (raw() - b);
  }

  /// Turns with constant rate (in W) for a while.
  void move(const Vector3d& rate_W_rad_s, Time duration) {
    for (const Time end = now + duration; now < end;) {
      const double dt_s = to_seconds(kStep);
      if (rate_W_rad_s.norm() > 0.0) {
        q_WB =
            Quaterniond(AngleAxisd(rate_W_rad_s.norm() * dt_s, rate_W_rad_s.normalized())) * q_WB;
      }
      const Vector3d force_B = q_WB.conjugate() * Vector3d(0, 0, -kGravity_m_s2);
      const Vector3d rate_B = q_WB.conjugate() * rate_W_rad_s;
      link::Imu imu;
      imu.time_boot_us = static_cast<std::uint64_t>(fcu.boot_clock().count() / 1000);
      for (int i = 0; i < 3; ++i) {
        imu.accel_m_s2[static_cast<std::size_t>(i)] = static_cast<float>(force_B(i));
        imu.gyro_rad_s[static_cast<std::size_t>(i)] = static_cast<float>(rate_B(i));
      }
      fcu.send(imu);
      if (++passes % 4 == 0) {
        link::Mag mag;
        for (int i = 0; i < 3; ++i) {
          mag.field_T[static_cast<std::size_t>(i)] = static_cast<float>(corrected()(i));
        }
        fcu.send(mag);
      }
      step();
    }
  }
  void hold(Time duration) { move(Vector3d::Zero(), duration); }
  void circle() { move({0, 0, std::numbers::pi / 4}, 8500ms); }
  /// Puts it on a face: body axis `down` points down.
  void tilt(const Vector3d& down) {
    const Vector3d now_down = q_WB * down;
    const Quaterniond turn = Quaterniond::FromTwoVectors(now_down, Vector3d(0, 0, 1));
    const AngleAxisd angle(turn);
    move(angle.axis() * angle.angle(), 1s);
  }
  void all_faces() {
    for (const Vector3d& down : {Vector3d(0, 0, 1), Vector3d(1, 0, 0), Vector3d(0, 1, 0),
                                 Vector3d(-1, 0, 0), Vector3d(0, -1, 0), Vector3d(0, 0, -1)}) {
      tilt(down);
      hold(2500ms);
      circle();
    }
  }
  float parameter(const char* name) { return fcu.find(name)->value.as_float(); }

  Quaterniond q_WB{Quaterniond::Identity()};
  int passes{0};
  MagCalibration calibration;
  std::vector<std::string> prompts;
};

TEST(MagCalibration, SixFacesGiveAConstantFieldStrength) {
  Bench bench;
  const auto job = bench.calibration.start();
  bench.hold(200ms);
  EXPECT_EQ(bench.parameter("MAG_CAL_A00"), 1.0f);  // nothing corrects while it measures
  EXPECT_EQ(bench.parameter("MAG_X_BIAS"), 0.0f);
  bench.all_faces();
  ASSERT_TRUE(bench.run_job(job, 1s)) << job.text();
  ASSERT_TRUE(job.done()) << job.text();
  EXPECT_NE(job.text().find("error 0.0 %"), std::string::npos) << job.text();
  EXPECT_LT(job.result().residual, 1e-4);
  EXPECT_NEAR(bench.parameter("MAG_X_BIAS"), 15e-6, 1e-9);
  EXPECT_NEAR(bench.parameter("MAG_Y_BIAS"), -10e-6, 1e-9);
  EXPECT_NEAR(bench.parameter("MAG_Z_BIAS"), 5e-6, 1e-9);
  // The direction is right, the strength that of the field times cbrt(det soft) = 1.0135.
  EXPECT_LT(std::acos(bench.corrected().normalized().dot(
                (bench.q_WB.conjugate() * Vector3d(25e-6, 0, 43.3e-6)).normalized())),
            1e-3);
  EXPECT_NEAR(bench.corrected().norm(), 50e-6 * std::cbrt(1.1 * 0.95 - 0.05 * 0.05), 0.01e-6);
  EXPECT_EQ(bench.calibration.progress().state, MagCalibration::State::kIdle);
}

TEST(MagCalibration, CanBeRepeated) {
  Bench bench;
  for (int i = 0; i < 2; ++i) {
    const auto job = bench.calibration.start();
    bench.hold(200ms);
    bench.all_faces();
    ASSERT_TRUE(bench.run_job(job, 1s));
    EXPECT_TRUE(job.done()) << job.text();
    EXPECT_NEAR(bench.parameter("MAG_X_BIAS"), 15e-6, 1e-9);
  }
}

TEST(MagCalibration, ReportsTheNextInstructionAndTheProgress) {
  Bench bench;
  const auto job = bench.calibration.start();
  bench.hold(200ms);
  EXPECT_EQ(bench.prompts.back(),
            "0 of 6 faces done: put the vehicle on another face and hold it still");
  bench.hold(2500ms);
  EXPECT_EQ(bench.prompts.back(), "level: turn a full circle about the vertical");
  EXPECT_EQ(bench.calibration.progress().state, MagCalibration::State::kTurn);
  bench.circle();
  EXPECT_EQ(bench.calibration.progress().faces_done, 1U);
  bench.hold(10s);  // the same face again does not count
  EXPECT_EQ(bench.calibration.progress().state, MagCalibration::State::kFindFace);
  bench.tilt({1, 0, 0});
  bench.hold(2500ms);
  EXPECT_EQ(bench.prompts.back(), "nose down: turn a full circle about the vertical");
  bench.tilt({0, 1, 0});  // gave up that face half-way
  bench.hold(1500ms);
  EXPECT_EQ(bench.prompts.back(),
            "1 of 6 faces done: put the vehicle on another face and hold it still");
  EXPECT_TRUE(job.pending());
}

TEST(MagCalibration, HalfACircleIsNotEnough) {
  Bench bench;
  bench.calibration.start();
  bench.hold(2700ms);
  bench.move({0, 0, std::numbers::pi / 8}, 8s);
  bench.move({0, 0, -std::numbers::pi / 8}, 8s);
  EXPECT_EQ(bench.calibration.progress().faces_done, 0U);
  EXPECT_LT(bench.calibration.progress().turned, 1.0);
}

TEST(MagCalibration, TheNoiseOfAVehicleAtRestIsNoCircle) {
  Random random(3);
  const auto noise = [&random] { return 0.01 * (random.uniform() - 0.5); };  // 1 %
  std::vector<MagFit::Vector> samples;
  for (int i = 0; i < 5000; ++i) {
    samples.push_back({0.5 + noise(), noise(), 0.86 + noise()});
  }
  EXPECT_EQ(circle_coverage(samples, 20), 0.0);
  for (int i = 0; i < 5000; ++i) {  // inclination 85 deg
    const double turn = 2.0 * std::numbers::pi * i / 5000.0;
    samples[static_cast<std::size_t>(i)] = {0.087 * std::cos(turn) + noise(),
                                            0.087 * std::sin(turn) + noise(), 0.996 + noise()};
  }
  EXPECT_EQ(circle_coverage(samples, 20), 1.0);
}

TEST(MagCalibration, CancelPutsTheOldCorrectionBack) {
  Bench bench;
  const auto job = bench.calibration.start();
  bench.hold(500ms);
  bench.calibration.cancel();
  ASSERT_TRUE(bench.run_job(job, 1s));
  EXPECT_EQ(job.text(), "magnetometer calibration: cancelled; old correction put back");
  EXPECT_EQ(bench.parameter("MAG_CAL_A11"), 1.5f);
  EXPECT_EQ(bench.parameter("MAG_Z_BIAS"), 1e-5f);
}

TEST(MagCalibration, IdlenessAndALostConnectionEndIt) {
  Bench bench;
  auto job = bench.calibration.start();
  bench.hold(130s);
  ASSERT_TRUE(bench.run_job(job, 1s));
  EXPECT_EQ(job.text(),
            "magnetometer calibration: nothing new for too long; old correction put back");
  job = bench.calibration.start();
  bench.hold(500ms);
  bench.fcu.silent = true;
  ASSERT_TRUE(bench.run_job(job, 20s));
  EXPECT_EQ(job.text().find(
                "magnetometer calibration: connection lost; old correction could not be put back"),
            0U)
      << job.text();
}

TEST(MagCalibration, RefusesToStartTwiceArmedOrWithoutParameters) {
  Bench bench;
  const auto job = bench.calibration.start();
  EXPECT_EQ(bench.calibration.start().text(), "magnetometer calibration: already in progress");
  bench.hold(100ms);
  bench.calibration.cancel();
  ASSERT_TRUE(bench.run_job(job, 1s));
  link::Status status;
  status.armed = true;
  bench.fcu.send(status);
  bench.hold(100ms);
  EXPECT_EQ(bench.calibration.start().text(),
            "magnetometer calibration: refused: the vehicle is armed");
  Rig other;
  MagCalibration calibration(other.session);
  EXPECT_TRUE(calibration.start().failed());
}

}  // namespace
}  // namespace rosflight::companion::test
