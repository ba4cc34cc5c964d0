// SPDX-License-Identifier: BSD-3-Clause
// A motor that stops within glide range of the runway, in wind: docs/faults.md.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string_view>

#include "autonomy/common/angles.hpp"
#include "autonomy/fixedwing/glide.hpp"
#include "flight/test/fixedwing_rig.hpp"

namespace rosflight::flight::testing {
namespace {

namespace fixedwing_autonomy = autonomy::fixedwing;

/// Whether some path leads down to the start from where the vehicle is, with its true wind and the
/// glide ratio of the vehicle file less a tenth.
bool in_range(const Rig& rig) {
  constexpr double kTenthLess = 0.9;
  constexpr double kStep_m = 2.0;
  const auto& config = std::get<FixedWingPlan>(rig.setup->plan).autonomy.flight;
  const sim::Truth& truth = rig.flight->truth();
  const sim::Vector3 v_W = truth.body.q_WB * truth.body.v_B;
  fixedwing_autonomy::GlideConfig glide;
  glide.airspeed_m_s = config.safety.glide_m_s;
  glide.ratio = kTenthLess * config.safety.glide_ratio;
  glide.radius_m = 65.0;  // 22 m/s down the wind at 37 degrees of bank
  const fixedwing_autonomy::GlidePlanner planner(glide);
  const fixedwing_autonomy::Pose from{truth.body.p_W.head<2>(), std::atan2(v_W.y(), v_W.x())};
  // A path may be missing because the vehicle is too high for it.
  for (double height_m = rig.height_m(); height_m > 0.0; height_m -= kStep_m) {
    if (planner.plan(from, height_m, {}, truth.air.wind_W.head<2>())) return true;
  }
  return false;
}

/// Steps until the autopilot has found out; the mission may be over before.
bool reach_glide(Rig& rig) {
  const auto gliding = [&] { return std::string_view(rig.flight->autonomy().phase) == "glide"; };
  while (!rig.flight->finished() && !gliding()) rig.flight->step();
  return gliding();
}

/// The motor stops at any moment of the mission, in wind of up to 8 m/s from anywhere, with gusts.
TEST(GlideInWind, EndsAtTheLandingPointWhenItIsInRange) {
  std::mt19937 random(1);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  int flown = 0;
  int near = 0;
  for (int k = 0; k < 60; ++k) {
    FlightChoice choice =
        fixedwing("default", {fmt::format("motor0_dead@{:.1f}", between(40.0, 165.0))});
    const double wind_m_s = between(0.0, 8.0);
    choice.wind =
        fmt::format("{:.1f},{:.0f},{:.1f}", wind_m_s, between(0.0, 360.0), between(0.0, wind_m_s));
    Rig rig(choice);
    if (!reach_glide(rig) || !in_range(rig)) continue;
    ++flown;
    SCOPED_TRACE(choice.faults[0] + ", wind " + *choice.wind);
    rig.flight->run();
    EXPECT_LE(record(rig).roll.max, 60.0 * autonomy::kRadPerDeg);
    EXPECT_GE(record(rig).lowest_airspeed_m_s, 10.0);  // through gusts
    expect_touchdown(rig, 45.0, 2.0);
    if (record(rig).touchdown() && record(rig).touchdown()->distance_m <= 30.0) ++near;
  }
  EXPECT_GE(flown, 30);
  EXPECT_GE(near, 0.9 * flown);
}

}  // namespace
}  // namespace rosflight::flight::testing
