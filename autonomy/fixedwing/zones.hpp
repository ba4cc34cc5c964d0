// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/fixedwing/phase_path.hpp"

namespace rosflight::autonomy::fixedwing {

/// Part of a flight by its altitude; the numbers of ROSflight's alt_zone.
enum class AltitudeZone : std::uint8_t { kTakeOff = 0, kClimb = 1, kDescend = 2, kHold = 3 };

struct ZoneConfig {
  double takeoff_m{5.0};  ///< Above where it stood: the take-off ends.
  double hold_m{10.0};    ///< Below the wanted height: the climb ends.
};

/// Take-off for a controller that receives no flight phase: its commands come from a path manager
/// or a tuning tool with course, altitude and airspeed only.
///
///     kTakeOff -> kClimb    height above the start >= takeoff_m
///     kClimb   -> kHold     height >= wanted height - hold_m
///
/// Wings level up to kHold. A take-off happens once between arming and disarming, so low flight is
/// no take-off. Armed in the air begins in kHold. While the pilot holds an axis the take-off starts
/// again from where the vehicle is. After rosplane 2.0.0 of ROSflight, whose zones can go back.
class AltitudeZones {
 public:
  struct Input {
    double t_s{};
    const StateEstimate& state;
    bool armed{};
    bool pilot{};
    double wanted_height_m{};
  };

  AltitudeZones() = default;
  /// Altitude limits of the zones; starts disarmed.
  explicit AltitudeZones(const ZoneConfig& config) : config_(config) {}
  /// Limits change, the zone stays.
  void configure(const ZoneConfig& config) { config_ = config; }

  /// Nothing while disarmed: the controller must not fly.
  std::optional<Controller::Direct> step(const Input& in, const FlightConfig& flight);
  AltitudeZone zone() const { return zone_; }

 private:
  void begin(const Input& in);

  ZoneConfig config_{};
  AltitudeZone zone_{AltitudeZone::kTakeOff};
  bool armed_{false};
  double since_s_{};
  double start_height_m_{};
  double start_course_rad_{};
};

}  // namespace rosflight::autonomy::fixedwing
