// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "autonomy/fixedwing/types.hpp"

namespace rosflight::autonomy::fixedwing {

struct LandingConfig {
  double approach_height_m{35.0};  ///< Above the aim point, where the glide path begins.
  double glide_slope{0.09};        ///< Slope of the glide path: 5 degrees.
  double level_m{120.0};           ///< Straight and level before it.
  double airspeed_m_s{14.5};       ///< On the glide path.
  double flare_time_s{1.6};        ///< tau of the flare.
  double touchdown_m_s{0.45};      ///< Sink the flare ends with.
  double flare_throttle{0.2};      ///< Down to this over the flare; idle once on the ground.
  double max_roll_rad{12.0 * kRadPerDeg};  ///< In the flare.
  double max_pitch_rad{9.0 * kRadPerDeg};  ///< In the flare: the tail must stay clear.
};

/// The geometry of a landing.
///
/// The flare lets the sink die out with the height above ground h,
///
///     h_dot = -(h + b)/tau,  b = tau s_td,   from  h_f = tau (Vg g) - b  on                 (1)
///
/// which joins the glide path of slope g without a step in sink and touches with s_td after
///
///     t = tau ln((h_f + b)/b),  x = Vg t                                                    (2)
///
/// so the glide path is aimed x - h_f/g short of the aim point. Exponential flare: Blakelock,
/// Automatic Control of Aircraft and Missiles, 1991, sec. 2-5. Vg is the approach speed less the
/// head wind of the estimate.
struct LandingPath {
  double flare_height_m{};
  double flare_distance_m{};
  /// Beginning of the level part (kDubins), of the glide path and its end on the ground (kLine).
  std::array<Waypoint, 3> waypoints{};

  /// Path and flare for a landing on aim_W, the position of the standing vehicle [m].
  /// @param course_rad     of the landing, over ground.
  /// @param cruise_m_s     airspeed up to the level part.
  /// @param head_wind_m_s  along the course, negative with a tail wind; the ground speed of (1) is
  ///                       never taken below 0.3 of the airspeed.
  static LandingPath plan(const LandingConfig& config, const Vector3& aim_W, double course_rad,
                          double cruise_m_s, double head_wind_m_s);
};

/// (1): climb rate at a height above ground.
double flare_climb(const LandingConfig& config, double height_m);

}  // namespace rosflight::autonomy::fixedwing
