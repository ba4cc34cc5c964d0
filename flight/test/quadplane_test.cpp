// SPDX-License-Identifier: BSD-3-Clause
// The quad-plane of vehicles/quadplane.yaml on missions/quadplane.yaml, judged by the truth: docs/quadplane.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "flight/test/flight_rig.hpp"

namespace rosflight::flight::testing {
namespace {

using autonomy::quadplane::Phase;
using sim::rc::Control;

FlightChoice quadplane(std::vector<std::string> faults = {}) {
  FlightChoice choice = Rig::with_faults(std::move(faults));
  choice.vehicle = "quadplane";
  return choice;
}

const autonomy::quadplane::FlightOutput& details(const Rig& rig) {
  return dynamic_cast<const QuadplaneGuidance&>(rig.flight->guidance()).details();
}

/// What the truth shows of a whole flight.
struct Record {
  double loss_m{};  ///< Largest sink below the path in a transition.
  double largest_tilt_deg{};
  double sum_m2{};
  int samples{};

  double rms_m() const { return std::sqrt(sum_m2 / samples); }
  void step(const Rig& rig) {
    const auto& guidance = details(rig);
    if (!guidance.tracking) return;
    const sim::Vector3 error_W = rig.flight->truth().body.p_W - guidance.setpoint.p_W;
    sum_m2 += error_W.squaredNorm();
    ++samples;
    largest_tilt_deg = std::max(largest_tilt_deg, rig.tilt_deg());
    if (guidance.phase == Phase::kTransition || guidance.phase == Phase::kBack)
      loss_m = std::max(loss_m, error_W.z());
  }
};

Record fly(Rig& rig) {
  Record record;
  while (!rig.flight->finished()) {
    rig.flight->step();
    record.step(rig);
  }
  return record;
}

bool reach(Rig& rig, Phase phase) {
  while (!rig.flight->finished() && details(rig).phase != phase) rig.flight->step();
  return details(rig).phase == phase;
}

class Winds : public ::testing::TestWithParam<std::tuple<const char*, int>> {};

/// Transition forward to the north: wind from 0 is a head wind, from 180 a tail wind; the way back
/// meets them as well.
TEST_P(Winds, KeepHeightAndPath) {
  FlightChoice choice = quadplane();
  choice.wind = std::string("8,") + std::get<0>(GetParam()) + ",8";
  choice.seed = static_cast<std::uint64_t>(std::get<1>(GetParam()));
  Rig rig(choice);
  const Record record = fly(rig);
  EXPECT_TRUE(rig.completed()) << rig.flight->score().verdict;
  EXPECT_LE(record.loss_m, 5.0);
  EXPECT_LE(record.rms_m(), 3.0);
  EXPECT_LE(record.largest_tilt_deg, 60.0);
}

INSTANTIATE_TEST_SUITE_P(From, Winds,
                         ::testing::Combine(::testing::Values("0", "90", "180", "270"),
                                            ::testing::Values(1, 2, 3)),
                         [](const auto& instance) {
                           return std::string("from") + std::get<0>(instance.param) + "seed" +
                                  std::to_string(std::get<1>(instance.param)) + "th";
                         });

TEST(Quadplane, CruisesOnTheWingAlone) {
  Rig rig(quadplane());
  ASSERT_TRUE(reach(rig, Phase::kCruise));
  rig.run_for(8.0);
  const sim::Truth& truth = rig.flight->truth();
  for (std::size_t k = 0; k < 4; ++k) EXPECT_LT(truth.rotor_speed_rad_s[k], 20.0);
  EXPECT_GT(truth.rotor_speed_rad_s[4], 200.0);
  EXPECT_NEAR(truth.body.v_B.x(), 17.0, 0.7);
}

/// V_s = sqrt(2 m g/(rho S C_L,max)) of the vehicle file: 5.7 kg, 0.52 m^2, C_L,max 1.26 (Raymer's 0.9 of the
/// section's 1.4), air at 1387 m of the standard atmosphere, 1.0697 kg/m^3.
TEST(Quadplane, StallSpeedIsTheClosedForm) {
  const FlightSetup setup(quadplane());
  const auto& facts = std::get<QuadplanePlan>(setup.plan).autonomy.flight.vehicle;
  EXPECT_NEAR(facts.stall_speed_m_s(), std::sqrt(2.0 * 5.7 * 9.80665 / (1.0697 * 0.52 * 1.26)),
              0.1);
}

class Takeover : public ::testing::TestWithParam<std::tuple<Phase, int>> {};

/// The pilot of these tests sees the vehicle: he keeps a rate of climb by throttle, sticks centred.
void hold_climb(Rig& rig, double climb_m_s) {
  const double carrying = rig.setup->hover_throttle;
  const double error = climb_m_s + rig.sink_m_s();
  const double stick = std::clamp(carrying * (1.0 + 0.25 * error), 0.0, 1.0);
  rig.flight->pilot().set(Control::kThrottle, static_cast<float>(stick));
}

TEST_P(Takeover, LandsByRadioOnThePrimaryMixerAlone) {
  const auto [phase, switches] = GetParam();
  FlightChoice choice = quadplane();
  choice.overrides = {"firmware.RC_THR_OVRD_CHN=7"};
  Rig rig(choice);
  ASSERT_TRUE(reach(rig, phase));
  rig.run_for(phase == Phase::kTakeoff ? 9.0 : 3.0);
  ASSERT_EQ(details(rig).phase, phase);
  if ((switches & 1) != 0) rig.flight->pilot().set_switch(Control::kAttitudeOverride, true);
  if ((switches & 2) != 0) rig.flight->pilot().set_switch(Control::kThrottleOverride, true);
  const double from_m = rig.height_m();
  double largest_tilt = 0.0;
  double lowest_m = from_m;
  float pusher = 0.0F;
  const sim::Time begin = rig.flight->now();
  const auto elapsed_s = [&] { return sim::to_seconds(rig.flight->now() - begin); };
  while (elapsed_s() < 20.0) {  // slows down, height kept
    hold_climb(rig, 0.3 * (from_m - rig.height_m()));
    rig.flight->step();
    if (elapsed_s() < 0.2) continue;
    pusher = std::max(pusher, rig.firmware().mixer().outputs()[4]);
    largest_tilt = std::max(largest_tilt, rig.tilt_deg());
    lowest_m = std::min(lowest_m, rig.height_m());
  }
  EXPECT_EQ(details(rig).phase, Phase::kPilot);
  // The primary mixer has no gain for it: what the motor model adds for its friction does not turn it.
  EXPECT_LT(pusher, 0.01F);
  EXPECT_LT(rig.flight->truth().body.v_B.norm(), 4.0);
  while (!rig.flight->truth().on_ground && elapsed_s() < 200.0) {
    hold_climb(rig, rig.height_m() > 4.0 ? -1.5 : -0.5);
    rig.flight->step();
    largest_tilt = std::max(largest_tilt, rig.tilt_deg());
  }
  ASSERT_TRUE(rig.flight->truth().on_ground);
  EXPECT_LT(rig.sink_m_s(), 1.0);
  EXPECT_LT(rig.tilt_deg(), 10.0);
  EXPECT_LT(largest_tilt, 45.0);
  EXPECT_GT(lowest_m, from_m - 8.0);
}

std::string takeover_name(const ::testing::TestParamInfo<std::tuple<Phase, int>>& instance) {
  const std::string phase = autonomy::quadplane::name(std::get<0>(instance.param));
  const int switches = std::get<1>(instance.param);
  if (switches == 1) return phase + "_attitude";
  return phase + (switches == 2 ? "_throttle" : "_both");
}

INSTANTIATE_TEST_SUITE_P(In, Takeover,
                         ::testing::Combine(::testing::Values(Phase::kTakeoff, Phase::kTransition,
                                                              Phase::kCruise, Phase::kBack),
                                            ::testing::Values(1, 2, 3)),
                         takeover_name);

class WeakMotor : public ::testing::TestWithParam<std::tuple<Phase, int>> {};

TEST_P(WeakMotor, InATransitionCompletesTheMission) {
  const auto [phase, motor] = GetParam();
  Rig rig(quadplane());
  ASSERT_TRUE(reach(rig, phase));
  rig.run_for(1.0);
  const double now_s = sim::to_seconds(rig.flight->now());
  rig.flight->faults().add(
      sim::parse_fault("motor" + std::to_string(motor) + "_partial=0.8@" + std::to_string(now_s)));
  const Record record = fly(rig);
  EXPECT_TRUE(rig.completed()) << rig.flight->score().verdict;
  EXPECT_LE(record.loss_m, 5.0);
  EXPECT_LE(record.rms_m(), 3.0);
}

INSTANTIATE_TEST_SUITE_P(In, WeakMotor,
                         ::testing::Combine(::testing::Values(Phase::kTransition, Phase::kBack),
                                            ::testing::Values(0, 1, 2, 3)),
                         [](const auto& instance) {
                           return std::string(
                                      autonomy::quadplane::name(std::get<0>(instance.param))) +
                                  "_motor" + std::to_string(std::get<1>(instance.param)) + "th";
                         });

class Silence : public ::testing::TestWithParam<std::tuple<Phase, const char*>> {};

/// The link is cut or the receiver silent for 3 s from the second second of a transition on.
TEST_P(Silence, InATransitionEndsOnTheGroundAtTheAim) {
  const auto [phase, fault] = GetParam();
  Rig rig(quadplane());
  ASSERT_TRUE(reach(rig, phase));
  rig.run_for(2.0);
  const double now_s = sim::to_seconds(rig.flight->now());
  rig.flight->faults().add(
      sim::parse_fault(std::string(fault) + "@" + std::to_string(now_s) + ":3"));
  const double from_m = rig.height_m();
  double largest_tilt = 0.0;
  for (int k = 0; k < 1200; ++k) {
    rig.flight->step();
    largest_tilt = std::max(largest_tilt, rig.tilt_deg());
  }
  EXPECT_LT(largest_tilt, 30.0);
  EXPECT_GT(rig.height_m(), from_m - 5.0);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->score().verdict;
}

INSTANTIATE_TEST_SUITE_P(In, Silence,
                         ::testing::Combine(::testing::Values(Phase::kTransition, Phase::kBack),
                                            ::testing::Values("link_cut", "rc_silence")),
                         [](const auto& instance) {
                           return std::string(
                                      autonomy::quadplane::name(std::get<0>(instance.param))) +
                                  "_" + std::get<1>(instance.param);
                         });

/// For good the link takes everything but the firmware and the pilot's sticks: level, upright, given up after 60 s.
TEST(Quadplane, ALinkCutForGoodLeavesALevelVehicle) {
  Rig rig(quadplane());
  ASSERT_TRUE(reach(rig, Phase::kTransition));
  rig.run_for(4.0);
  rig.flight->faults().add(
      sim::parse_fault("link_cut@" + std::to_string(sim::to_seconds(rig.flight->now()))));
  double largest_tilt = 0.0;
  while (!rig.flight->finished()) {
    rig.flight->step();
    largest_tilt = std::max(largest_tilt, rig.tilt_deg());
    if (rig.flight->runner().stage() == Stage::kFailed) break;
  }
  EXPECT_EQ(rig.flight->runner().failure(), "link lost in flight");
  EXPECT_LT(largest_tilt, 30.0);
}

}  // namespace
}  // namespace rosflight::flight::testing
