// SPDX-License-Identifier: BSD-3-Clause
// A motor that stops within glide range of the runway, in wind: docs/faults.md.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string_view>
#include <vector>

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
///
/// Four series of such draws, 204 flights: with W20 up to 3 m/s 147 of 149 ended within 30 m, the farthest at 48 m; with more 36 of 55, the farthest
/// at 73 m, because the margin for gusts shortens the glide that the planner counts on. Half of all ended within 10 m.
/// Before glides knew of the wind, half ended within 30 m and the farthest at 494 m.
TEST(GlideInWind, EndsAtTheLandingPointWhenItIsInRange) {
  std::mt19937 random(1);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  constexpr double kGusts_m_s = 3.0;
  std::vector<double> distances_m;
  std::vector<bool> near;  // in little turbulence
  for (int k = 0; k < 60; ++k) {
    const double at_s = between(40.0, 165.0);
    const double wind_m_s = between(0.0, 8.0);
    const double from_deg = between(0.0, 360.0);
    const double w20_m_s = between(0.0, wind_m_s);
    FlightChoice choice = fixedwing("default", {fmt::format("motor0_dead@{:.1f}", at_s)});
    choice.wind = fmt::format("{:.1f},{:.0f},{:.1f}", wind_m_s, from_deg, w20_m_s);
    Rig rig(choice);
    if (!reach_glide(rig) || !in_range(rig)) continue;
    SCOPED_TRACE(choice.faults[0] + ", wind " + *choice.wind);
    rig.flight->run();
    EXPECT_LE(record(rig).roll.max, 60.0 * autonomy::kRadPerDeg);
    EXPECT_GE(record(rig).lowest_airspeed_m_s, 10.0);  // through gusts
    expect_touchdown(rig, 150.0, 2.0);
    if (!record(rig).touchdown()) continue;
    distances_m.push_back(record(rig).touchdown()->distance_m);
    if (w20_m_s <= kGusts_m_s) near.push_back(distances_m.back() <= 30.0);
  }
  std::sort(distances_m.begin(), distances_m.end());
  ASSERT_GE(distances_m.size(), 30U);
  EXPECT_LE(distances_m[distances_m.size() / 2], 20.0);
  EXPECT_LE(distances_m.back(), 100.0);
  ASSERT_GE(near.size(), 25U);
  EXPECT_GE(20 * std::count(near.begin(), near.end(), true), 19 * std::ssize(near));
}

}  // namespace
}  // namespace rosflight::flight::testing
