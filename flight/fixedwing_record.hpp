// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <limits>
#include <optional>

#include "autonomy/fixedwing/flight_manager.hpp"
#include "flight/error_statistics.hpp"
#include "sim/types.hpp"

namespace rosflight::flight {

/// How a fixed wing flew its mission and came down, by the truth.
///
/// Cross-track and height errors are against the path beside the vehicle, height against the ramped
/// reference, airspeed against the commanded one; all only on the mission's path. After a corner
/// that no arc rounds off (path: line) no fixed wing can follow: the turn itself takes up to two radii to
/// the side, and the field of the follower brings the aircraft back over some three. The straight
/// and height, airspeed count from kCapture radii on; what lies before is in `corner`.
class FixedWingRecord {
 public:
  static constexpr double kCapture = 3.0;

  struct Touchdown {
    double t_s{};
    double distance_m{};  ///< Horizontally from the aim point.
    double along_m{};     ///< Part of distance_m along the course, beyond the aim point.
    double sink_m_s{};    ///< Sink rate of the centre of mass, in the step before.
    double roll_rad{};
    double pitch_rad{};
  };

  /// @param radius_m  of the mission's turns.
  FixedWingRecord(const sim::Vector3& aim_W, double radius_m)
      : aim_W_{aim_W}, radius_m_{radius_m} {}

  /// Once per step. @param seen_W  the true position less what no filter on board can see.
  void step(const sim::Truth& truth, const sim::Vector3& seen_W,
            const autonomy::fixedwing::FlightOutput& output);

  ErrorStatistics straight;  ///< Cross-track, as seen.
  ErrorStatistics arc;
  ErrorStatistics corner;          ///< The same within kCapture radii after a sharp corner.
  ErrorStatistics straight_total;  ///< The same of the truth.
  ErrorStatistics arc_total;
  ErrorStatistics height;  ///< As seen.
  ErrorStatistics height_total;
  ErrorStatistics airspeed;  ///< [m/s]
  ErrorStatistics roll;      ///< Largest bank in the air [rad].
  /// From climb to approach; infinite where it never climbed.
  double lowest_airspeed_m_s{std::numeric_limits<double>::infinity()};
  const std::optional<Touchdown>& touchdown() const { return touchdown_; }

 private:
  bool captured(const autonomy::fixedwing::FlightOutput& output);

  sim::Vector3 aim_W_;
  double radius_m_;
  autonomy::fixedwing::Segment segment_{};
  bool after_corner_{false};
  bool was_in_air_{false};
  double sink_m_s_{};
  std::optional<Touchdown> touchdown_;
};

}  // namespace rosflight::flight
