// SPDX-License-Identifier: BSD-3-Clause
// The safety claims of the ROSflight 2.0 paper, flown.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "companion/offboard.hpp"
#include "flight/test/flight_rig.hpp"

namespace rosflight::flight::testing {
namespace {

using sim::rc::Control;
namespace bits = core::override_bit;

constexpr double kRcFrame_s = 0.02;
constexpr double kStep_s = 0.0025;

/// A secondary mixer that hands entries 0..3 straight to motors 0..3. All gains are given: a
/// secondary that followed the primary has left its gains in the parameters.
FlightChoice identity_secondary() {
  FlightChoice choice;
  choice.overrides = {"firmware.SECONDARY_MIXER=11"};
  for (int input = 0; input < 10; ++input) {
    for (int channel = 0; channel < 10; ++channel) {
      choice.overrides.push_back("firmware.SEC_MIXER_" + std::to_string(input) + "_" +
                                 std::to_string(channel) + "=" +
                                 (input == channel && input < 4 ? "1" : "0"));
    }
  }
  return choice;
}

/// Attitude and height kept by the companion alone: motor commands at 400 Hz from the true state.
class MotorPilot {
 public:
  explicit MotorPilot(const Flight& flight)
      : hover_{static_cast<float>(flight.setup().hover_throttle *
                                  firmware_value(flight.setup().firmware, "RC_MAX_THR"))} {}

  link::OffboardControl command(const sim::Truth& truth, double height_m) const {
    const sim::Quaternion& q = truth.body.q_WB;
    const double roll =
        std::atan2(2 * (q.w() * q.x() + q.y() * q.z()), 1 - 2 * (q.x() * q.x() + q.y() * q.y()));
    const double pitch = std::asin(2 * (q.w() * q.y() - q.z() * q.x()));
    const sim::Vector3& w = truth.body.w_B;
    const double climb = -(q * truth.body.v_B).z();
    const double x = -0.25 * roll - 0.05 * w.x();
    const double y = -0.25 * pitch - 0.05 * w.y();
    const double z = -0.1 * w.z();
    const double up = 0.05 * (height_m + truth.body.p_W.z()) - 0.08 * climb;
    const auto motor = [&](double qx, double qy, double qz) {
      return static_cast<float>(std::min(
          1.0, std::max(0.0, static_cast<double>(hover_) + up + qx * x + qy * y + qz * z)));
    };
    // Front right, rear right, rear left, front left.
    return companion::pass_through(
        {motor(-1, 1, 1), motor(-1, -1, -1), motor(1, -1, 1), motor(1, 1, -1), 0, 0, 0, 0, 0, 0});
  }

 private:
  float hover_;
};

TEST(Safety, CompanionDrivesTheFourMotorsDirectly) {
  Rig rig(identity_secondary());
  ASSERT_TRUE(rig.reach(Stage::kFly));
  ASSERT_FALSE(rig.firmware().mixer().mixers_agree());
  rig.flight->runner().set_offboard_paused(true);
  const MotorPilot motors(*rig.flight);
  constexpr double kHeight_m = 4.0;
  const double start_s = sim::to_seconds(rig.flight->now());
  link::OffboardControl last{};
  rig.flight->set_script([&](Flight& flight, sim::Time t) {
    const double height_m = std::min(kHeight_m, sim::to_seconds(t) - start_s);  // climbs at 1 m/s
    last = motors.command(flight.truth(), height_m);
    static_cast<void>(flight.session().offboard().send(last));
  });
  rig.run_for(8.0);
  EXPECT_EQ(rig.firmware().command().primary_axes() & 0x3FU, 0U);
  // A command crosses the cable in less than one step and is flown with the next IMU sample.
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(rig.firmware().mixer().outputs()[k], last.u[k], 0.02F) << k;
  }
  EXPECT_NEAR(rig.height_m(), kHeight_m, 0.7);
  EXPECT_LT(rig.tilt_deg(), 5.0);

  // The pilot takes the whole vehicle by one stick, although only roll moved: the mixers differ.
  rig.flight->pilot().set(Control::kRoll, 0.75F);
  rig.run_for(kRcFrame_s + 2 * kStep_s);
  EXPECT_TRUE(rig.firmware().command().override_word() & bits::kStickRoll);
  EXPECT_EQ(rig.firmware().command().primary_axes() & 0x3FU, 0x3FU);
  rig.flight->pilot().set(Control::kRoll, 0.5F);
  rig.run_for(0.9);
  EXPECT_EQ(rig.firmware().command().primary_axes() & 0x3FU, 0x3FU) << "held 1 s after release";
  rig.run_for(0.2);
  EXPECT_EQ(rig.firmware().command().primary_axes() & 0x3FU, 0U) << "given back";
  rig.run_for(3.0);
  EXPECT_LT(rig.tilt_deg(), 10.0);
}

TEST(Safety, PilotTakesOneAxisByStickAndGivesBack) {
  Rig rig(FlightChoice{});
  ASSERT_TRUE(rig.reach_mission());
  rig.run_for(2.0);
  const auto& command = rig.firmware().command();
  EXPECT_EQ(command.primary_axes() & 0x3FU, 0U);
  rig.flight->pilot().set(Control::kYaw, 0.7F);
  rig.run_for(kRcFrame_s + 2 * kStep_s);
  EXPECT_EQ(command.override_word() & (bits::kStickRoll | bits::kStickPitch | bits::kStickYaw),
            bits::kStickYaw);
  EXPECT_EQ(command.primary_axes() & 0x3FU, 0x20U) << "yaw only";
  const float full_yaw_rad_s = 1.507F;  // RC_MAX_YAWRATE
  EXPECT_NEAR(command.combined().value[5], 0.4F * full_yaw_rad_s, 1e-4F);
  rig.flight->pilot().center_sticks();
  rig.run_for(1.1);
  EXPECT_EQ(command.primary_axes() & 0x3FU, 0U);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
}

TEST(Safety, PilotTakesAllBySwitchAndGivesBack) {
  Rig rig(FlightChoice{});
  ASSERT_TRUE(rig.reach_mission());
  rig.run_for(2.0);
  rig.flight->pilot().set_switch(Control::kAttitudeOverride, true);
  rig.flight->pilot().set_switch(Control::kThrottleOverride, true);
  rig.run_for(kRcFrame_s + 2 * kStep_s);
  const auto& command = rig.firmware().command();
  EXPECT_EQ(command.override_word() & 0x3U, 0x3U);
  EXPECT_EQ(command.primary_axes() & 0x3FU, 0x3FU);
  rig.run_for(2.0);
  EXPECT_LT(rig.tilt_deg(), 5.0) << "sticks centred: level";
  rig.flight->pilot().set_switch(Control::kAttitudeOverride, false);
  rig.flight->pilot().set_switch(Control::kThrottleOverride, false);
  rig.run_for(kRcFrame_s + 2 * kStep_s);
  EXPECT_EQ(command.primary_axes() & 0x3FU, 0U);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
}

/// OFFBOARD_HOLD [s]: that of ROSflight 2.x, and that of the vehicle file.
class SilentCompanion : public ::testing::TestWithParam<double> {};
TEST_P(SilentCompanion, HandsOverAfterTheTimeoutAndTheHold) {
  FlightChoice choice;
  choice.overrides = {fmt::format("firmware.OFFBOARD_HOLD={:.0f}", 1e3 * GetParam())};
  Rig rig(choice);
  ASSERT_TRUE(rig.reach_mission());
  rig.run_for(2.0);
  rig.flight->runner().set_offboard_paused(true);
  const double start_s = sim::to_seconds(rig.flight->now());
  const auto& command = rig.firmware().command();
  double handed_over_s = std::numeric_limits<double>::infinity();
  double tilt_after_1s_deg = 0.0;
  while (sim::to_seconds(rig.flight->now()) < start_s + 2.0) {
    rig.flight->step();
    const double t_s = sim::to_seconds(rig.flight->now()) - start_s;
    if (!command.offboard_active()) handed_over_s = std::min(handed_over_s, t_s);
    if (t_s < 1.1) tilt_after_1s_deg = rig.tilt_deg();
  }
  EXPECT_GE(handed_over_s, 0.1 + GetParam() - 0.01) << "the last command was up to 10 ms old";
  EXPECT_LE(handed_over_s, 0.1 + GetParam() + 3 * kStep_s);
  EXPECT_EQ(command.override_word() & 0x3C0U, 0x3C0U);
  EXPECT_EQ(command.primary_axes() & 0x3FU, 0x3FU);
  EXPECT_LT(tilt_after_1s_deg, 8.0) << "level, the hold and the pilot alike";
}
INSTANTIATE_TEST_SUITE_P(Holds, SilentCompanion, ::testing::Values(0.0, 1.2));

TEST(Safety, FirmwareThatRestartsInFlightRearmsAndFliesOn) {
  Rig rig(FlightChoice{});
  ASSERT_TRUE(rig.reach_mission());
  rig.run_for(2.0);
  const double height_m = rig.height_m();
  rig.flight->autopilot().break_down(rig.flight->now(), Autopilot::Breakdown::kCrash);
  EXPECT_TRUE(rig.firmware().state().armed());
  rig.run_for(1.0);
  EXPECT_TRUE(rig.firmware().state().armed());
  EXPECT_LT(rig.tilt_deg(), 30.0);
  EXPECT_NEAR(rig.height_m(), height_m, 1.5);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
}

}  // namespace
}  // namespace rosflight::flight::testing
