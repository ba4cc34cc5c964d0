// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "autonomy/common/raw_motion.hpp"
#include "autonomy/fixedwing/controller.hpp"
#include "autonomy/fixedwing/flight_config.hpp"

namespace rosflight::autonomy::fixedwing {

/// Brings a fixed wing down whose state is lost: motor off, wings level, the pitch of a glide, straight on.
///
/// A sink of V/E, with the speed V and ratio E of a glide, is soft enough to touch down with: 1.4 m/s at 14 m/s
/// and a ratio of 10. There is no flare, as nothing is known of the airspeed; below kRound_m by the range sensor
/// the nose comes up to kRound_rad.
///
/// It has come to rest when altitude of the barometer and rates have not moved for kRests_s, unless the range
/// sensor shows height below it; without the barometer once the time has passed in which a glide comes down from
/// the last known height at kSlowest_m_s. No heap, no clock.
class LevelGlide {
 public:
  static constexpr double kRound_m = 2.0;
  static constexpr double kRound_rad = 0.0;
  static constexpr double kRests_s = 5.0;
  static constexpr double kSlowest_m_s = 0.7;
  static constexpr double kSpare_s = 15.0;  ///< On top of that time.

  /// @param height_m          last known height above the landing point.
  /// @param standing_range_m  what the range sensor reads on the ground.
  void start(double height_m, double standing_range_m);
  /// Once a control period. @returns whether it has come to rest.
  bool step(const RawMotion& raw, std::optional<double> range_m, double dt_s);

  /// What the controller flies.
  Controller::Direct direct(const SafetyConfig& safety) const;
  /// A state for the controller: an attitude, and nothing else that is known.
  static StateEstimate state(const RawMotion& raw);

 private:
  double height_m_{};
  double standing_range_m_{};
  double since_s_{};
  double still_s_{};
  std::optional<double> still_up_m_;  ///< Altitude of the barometer that it is compared with.
  bool low_{false};
};

}  // namespace rosflight::autonomy::fixedwing
