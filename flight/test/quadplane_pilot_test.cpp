// SPDX-License-Identifier: BSD-3-Clause
// The pilot of a quad-plane: takes over in every phase, lands by radio on the primary mixer alone, gives back.
// Neither of the two pilots has the vehicle's estimate or its exact state. docs/quadplane.md
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <deque>
#include <tuple>

#include "flight/test/quadplane_rig.hpp"

namespace rosflight::flight::testing {
namespace {

using Phase = QuadplanePhase;
using sim::rc::Control;

constexpr int kAttitude = 1;
constexpr int kThrottle = 2;
constexpr int kBoth = 3;

constexpr float kMiddle = 0.5F;  // of a surface's output

std::string switch_name(int switches) {
  return switches == kAttitude ? "attitude" : switches == kThrottle ? "throttle" : "both";
}

/// Attitude and throttle on switches of their own.
FlightChoice two_switches() {
  FlightChoice choice = quadplane();
  choice.overrides = {"firmware.RC_THR_OVRD_CHN=7"};
  return choice;
}

void set_switches(Rig& rig, int switches, bool on) {
  if ((switches & kAttitude) != 0) rig.flight->pilot().set_switch(Control::kAttitudeOverride, on);
  if ((switches & kThrottle) != 0) rig.flight->pilot().set_switch(Control::kThrottleOverride, on);
}

/// Flies to a moment of a phase, and lets the pilot take over.
void take_over(Rig& rig, Phase phase, int switches) {
  ASSERT_TRUE(reach(rig, phase));
  rig.run_for(phase == Phase::kTakeoff ? 9.0 : phase == Phase::kHover ? 1.0 : 3.0);
  ASSERT_EQ(details(rig).phase, phase);
  set_switches(rig, switches, true);
}

/// What the truth shows from the takeover to the ground.
struct Descent {
  double largest_tilt_deg{};
  double lowest_m{1e9};
  double touchdown_m_s{1e9};
  float pusher{};   ///< Output, 0 to 1.
  float surface{};  ///< Largest output off the middle.

  void step(Rig& rig, double since_s) {
    touchdown_m_s = rig.sink_m_s();
    rig.flight->step();
    if (since_s < 0.2) return;  // the switches take two frames of the radio
    largest_tilt_deg = std::max(largest_tilt_deg, rig.tilt_deg());
    lowest_m = std::min(lowest_m, rig.height_m());
    const auto& outputs = rig.firmware().mixer().outputs();
    pusher = std::max(pusher, outputs[4]);
    for (std::size_t k = 5; k < 8; ++k) surface = std::max(surface, std::abs(outputs[k] - kMiddle));
  }
  /// Whole, upright, softly, with lifting rotors alone.
  void expect_landed(const Rig& rig) const {
    EXPECT_TRUE(rig.flight->truth().on_ground) << rig.height_m();
    EXPECT_LT(touchdown_m_s, 1.5);
    EXPECT_LT(rig.tilt_deg(), 10.0);
    EXPECT_LT(largest_tilt_deg, 45.0);
    // No gain in the primary mixer: what the motor model adds for its friction does not turn the pusher.
    EXPECT_LT(pusher, 0.01F);
    EXPECT_LT(surface, 0.01F);
  }
};

class Takeover : public ::testing::TestWithParam<std::tuple<Phase, int>> {};

/// A pilot who sees nothing: sticks in the middle, throttle at 0.95 of what carries, which he knows from earlier flights.
/// The rotors damp the descent to 1 m/s. 100 s later he closes the throttle.
TEST_P(Takeover, ABlindPilotLandsByAFixedSchedule) {
  const auto [phase, switches] = GetParam();
  Rig rig(two_switches());
  take_over(rig, phase, switches);
  rig.flight->pilot().set(Control::kThrottle, static_cast<float>(0.95 * rig.setup->hover_throttle));
  Descent descent;
  const sim::Time begin = rig.flight->now();
  const auto since_s = [&] { return sim::to_seconds(rig.flight->now() - begin); };
  while (since_s() < 100.0 && !rig.flight->truth().on_ground) descent.step(rig, since_s());
  descent.expect_landed(rig);
  EXPECT_EQ(details(rig).phase, Phase::kPilot);
  rig.run_for(std::max(0.0, 100.0 - since_s()));
  rig.flight->pilot().set(Control::kThrottle, 0.0F);
  rig.run_for(4.0);
  EXPECT_TRUE(rig.flight->truth().on_ground);
  EXPECT_LT(rig.flight->truth().body.v_B.norm(), 0.1);
  EXPECT_LT(rig.tilt_deg(), 5.0);
}

/// A pilot beside the field. He looks three times a second and acts 0.3 s later: height to a tenth of it and not below a
/// metre, climb to 0.5 m/s, drift along and across the nose to 1 m/s. He leans against the drift, and comes down: in a wind the
/// wing carries too, so he lowers the stick until the vehicle does.
class SeeingPilot {
 public:
  explicit SeeingPilot(Rig& rig) : rig_{rig}, keep_m_{rig.height_m()} {}

  void step(double since_s) {
    if (since_s < next_s_) return;
    next_s_ += kLook_s;
    looks_.push_back(look());
    if (looks_.size() < 2) return;  // he acts on the look before
    act(looks_.front(), since_s);
    looks_.pop_front();
  }

 private:
  static constexpr double kLook_s = 0.3;
  static constexpr double kSlowsDown_s = 20.0;
  struct Look {
    double height_m, climb_m_s, forward_m_s, right_m_s;
  };

  static double rounded(double value, double step) { return step * std::round(value / step); }

  Look look() const {
    const double height_m = rig_.height_m();
    const auto& body = rig_.flight->truth().body;
    const sim::Vector3 v_W = body.q_WB * body.v_B;
    const sim::Vector3 nose_W = body.q_WB * sim::Vector3::UnitX();
    const double heading = std::atan2(nose_W.y(), nose_W.x());
    const double forward = v_W.x() * std::cos(heading) + v_W.y() * std::sin(heading);
    const double right = v_W.y() * std::cos(heading) - v_W.x() * std::sin(heading);
    return {rounded(height_m, std::max(1.0, 0.1 * height_m)), rounded(-v_W.z(), 0.5),
            rounded(forward, 1.0), rounded(right, 1.0)};
  }
  void act(const Look& seen, double since_s) {
    const double keeps_m_s = std::clamp(0.2 * (keep_m_ - seen.height_m), -1.0, 1.0);
    const double sinks_m_s = std::clamp(0.1 * seen.height_m, 0.4, 1.5);
    const double climb_m_s = since_s > kSlowsDown_s ? -sinks_m_s : keeps_m_s;
    const double error_m_s = climb_m_s - seen.climb_m_s;
    throttle_ = std::clamp(throttle_ + 0.015 * error_m_s, -0.6, 0.3);
    const double throttle = rig_.setup->hover_throttle * (1.0 + throttle_ + 0.15 * error_m_s);
    rig_.flight->pilot().set(Control::kThrottle,
                             static_cast<float>(std::clamp(throttle, 0.0, 1.0)));
    stick(Control::kRoll, -seen.right_m_s, roll_);
    stick(Control::kPitch, seen.forward_m_s, pitch_);
  }
  /// Against the drift, and more the longer it lasts.
  void stick(Control control, double against_m_s, double& held) {
    held = std::clamp(held + 0.004 * against_m_s, -0.2, 0.2);
    const double to = 0.5 + std::clamp(held + 0.025 * against_m_s, -0.3, 0.3);
    rig_.flight->pilot().set(control, static_cast<float>(to));
  }

  Rig& rig_;
  double keep_m_;
  double next_s_{};
  double throttle_{}, roll_{}, pitch_{};
  std::deque<Look> looks_;
};

void expect_seeing_pilot_lands(Rig& rig, double drift_m_s) {
  const double height_m = rig.height_m();
  SeeingPilot pilot(rig);
  Descent descent;
  const sim::Time begin = rig.flight->now();
  const auto since_s = [&] { return sim::to_seconds(rig.flight->now() - begin); };
  double lowest_m = height_m;
  while (since_s() < 150.0 && !rig.flight->truth().on_ground) {
    pilot.step(since_s());
    descent.step(rig, since_s());
    if (since_s() < 20.0) lowest_m = std::min(lowest_m, rig.height_m());
  }
  descent.expect_landed(rig);
  EXPECT_GT(lowest_m, height_m - 5.0);
  EXPECT_LT(rig.flight->truth().body.v_B.norm(), drift_m_s);
}

TEST_P(Takeover, APilotWhoSeesTheVehicleLands) {
  const auto [phase, switches] = GetParam();
  Rig rig(two_switches());
  take_over(rig, phase, switches);
  expect_seeing_pilot_lands(rig, 2.0);
}

TEST_P(Takeover, APilotWhoSeesTheVehicleLandsInWindAndGusts) {
  const auto [phase, switches] = GetParam();
  FlightChoice choice = two_switches();
  choice.wind = "8,90,8";
  Rig rig(choice);
  take_over(rig, phase, switches);
  expect_seeing_pilot_lands(rig, 3.0);
}

INSTANTIATE_TEST_SUITE_P(In, Takeover,
                         ::testing::Combine(::testing::Values(Phase::kTakeoff, Phase::kTransition,
                                                              Phase::kCruise, Phase::kBack,
                                                              Phase::kHover),
                                            ::testing::Values(kAttitude, kThrottle, kBoth)),
                         [](const auto& instance) {
                           return fmt::format("{}_{}", name(std::get<0>(instance.param)),
                                              switch_name(std::get<1>(instance.param)));
                         });

class GivenBack : public ::testing::TestWithParam<std::tuple<Phase, int>> {};

/// The pilot's sticks are where they are in every flight: centred, with a throttle that carries. The mission is completed.
TEST_P(GivenBack, TheMissionGoesOn) {
  const auto [phase, duration_s] = GetParam();
  for (const int switches : {kAttitude, kThrottle, kBoth}) {
    Rig rig(two_switches());
    take_over(rig, phase, switches);
    rig.run_for(duration_s);
    ASSERT_EQ(details(rig).phase, Phase::kPilot);
    set_switches(rig, switches, false);
    rig.run_for(0.5);
    EXPECT_NE(details(rig).phase, Phase::kPilot) << switch_name(switches);
    const double height_m = rig.height_m();
    double lowest_m = height_m;
    double largest_tilt_deg = 0.0;
    for (int k = 0; k < 800; ++k) {
      rig.flight->step();
      lowest_m = std::min(lowest_m, rig.height_m());
      largest_tilt_deg = std::max(largest_tilt_deg, rig.tilt_deg());
    }
    EXPECT_LT(largest_tilt_deg, 50.0);
    // The path is lower than where a vehicle of 17 m/s whose rotors carry it has climbed to; it is not left below.
    EXPECT_GT(lowest_m, std::min(height_m, -details(rig).setpoint.p_W.z()) - 5.0);
    rig.flight->run();
    EXPECT_TRUE(rig.completed()) << switch_name(switches) << rig.flight->score().verdict;
  }
}

INSTANTIATE_TEST_SUITE_P(In, GivenBack,
                         ::testing::Combine(::testing::Values(Phase::kTakeoff, Phase::kTransition,
                                                              Phase::kCruise, Phase::kBack,
                                                              Phase::kHover),
                                            ::testing::Values(1, 5, 12)),
                         [](const auto& instance) {
                           return fmt::format("{}_after{}s", name(std::get<0>(instance.param)),
                                              std::get<1>(instance.param));
                         });

}  // namespace
}  // namespace rosflight::flight::testing
