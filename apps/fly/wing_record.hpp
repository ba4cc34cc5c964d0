// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "apps/fly/tracking.hpp"
#include "apps/report/flight_record.hpp"
#include "autonomy/fixedwing/flight_manager.hpp"
#include "sim/types.hpp"

namespace rosflight::apps {

/// How a fixed wing flew its mission and came down, by the truth.
///
/// Cross-track and height errors are against the path beside the vehicle, height against the ramped
/// reference, airspeed against the commanded one; all only on the mission's path. After a corner
/// that no arc rounds off (path: line) no wing can follow: the turn itself takes up to two radii to
/// the side, and the field of the follower brings the aircraft back over some three. The straight
/// and height, airspeed count from kCapture radii on; what lies before is in `corner`.
class WingRecord {
 public:
  static constexpr double kCapture = 3.0;

  struct Touchdown {
    double t_s{};
    double distance_m{};  ///< Horizontally from the aim point.
    double along_m{};     ///< Of it, beyond the aim point.
    double sink_m_s{};    ///< Of the centre of mass, in the step before.
    double roll_rad{};
    double pitch_rad{};
  };

  /// @param radius_m  of the mission's turns.
  WingRecord(const sim::Vector3& aim_N, double radius_m) : aim_N_{aim_N}, radius_m_{radius_m} {}

  /// Once per step. @param seen_N  the true position less what no filter on board can see.
  void step(const sim::Truth& truth, const sim::Vector3& seen_N,
            const autonomy::fixedwing::FlightOutput& output);

  Tracking straight;  ///< Cross-track, as seen.
  Tracking arc;
  Tracking corner;          ///< The same within kCapture radii after a sharp corner.
  Tracking straight_total;  ///< The same of the truth.
  Tracking arc_total;
  Tracking height;  ///< As seen.
  Tracking height_total;
  Tracking airspeed;                ///< [m/s]
  Tracking roll;                    ///< Largest bank in the air [rad].
  double lowest_airspeed_m_s{1e9};  ///< From climb to approach.
  const std::optional<Touchdown>& touchdown() const { return touchdown_; }

 private:
  bool captured(const autonomy::fixedwing::FlightOutput& output);

  sim::Vector3 aim_N_;
  double radius_m_;
  autonomy::fixedwing::Segment segment_{};
  bool after_corner_{false};
  bool was_in_air_{false};
  double sink_m_s_{};
  std::optional<Touchdown> touchdown_;
};

/// What the report shows of a fixed wing at one moment.
/// @param seen_N  the true position less what no filter on board can see.
report::Wing wing_sample(const autonomy::fixedwing::FlightOutput& output, const sim::Truth& truth,
                         const sim::Vector3& seen_N);

}  // namespace rosflight::apps
