// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace rosflight::autonomy::estimation {

/// What is fused, each with its own gate and record.
enum class Aid : std::uint8_t {
  kGnssHorizontal,
  kGnssAltitude,
  kGnssVelocity,
  kBaro,
  kHeading,
  kRange,
  kPitot,
  kSideslip,  ///< Vane or assumption; specific force of the air along body x and y.
  kRest,
  kPose,         ///< Position of a pose from outside.
  kPoseHeading,  ///< Its heading.
};
inline constexpr std::size_t kAids = 11;

/// Record of one aid.
struct AidHealth {
  std::uint64_t accepted{};
  std::uint64_t rejected{};  ///< Outside the gate.
  double last_accepted_s{-1e9};
  double last_rejected_s{-1e9};
  double rejected_since_s{};  ///< First rejection since the last acceptance; valid if `rejecting`.
  bool rejecting{};
  double nis{};  ///< NIS of the last measurement, divided by its degrees of freedom.

  double rejecting_for_s() const { return rejecting ? last_rejected_s - rejected_since_s : 0.0; }
};

struct EstimatorHealth {
  bool initialised{};
  bool in_air_start{};
  std::array<AidHealth, kAids> aids{};
  std::uint64_t late{};               ///< Older than the lag: not fused.
  std::uint64_t unusable{};           ///< Not finite, or impossible.
  std::uint64_t imu_holes{};          ///< Samples missing for 50 ms and more.
  std::uint64_t realigned{};          ///< The clock of the samples jumped: times were shifted.
  std::uint64_t restarts{};           ///< The state was no number: the last good one was restored.
  std::uint64_t imu_widenings{};      ///< The variances of biases and tilt were widened.
  std::uint64_t heading_widenings{};  ///< Likewise of heading and gyro bias about the vertical.
  std::uint64_t gnss_resets{};        ///< Position or velocity moved to GNSS, or to a pose.
  std::uint64_t gnss_jumps{};         ///< The slow error of the satellites was estimated again.
  std::uint64_t baro_relearned{};
  std::uint64_t wind_relearned{};  ///< A gust had taken the pitot out of its gate.
  std::uint64_t ground_relearned{};
  double gnss_age_s{1e9};  ///< Since the last accepted horizontal aiding.
  bool bridging{};         ///< IMU samples were missing; nothing aided position or velocity since.

  /// Record of one aid.
  const AidHealth& of(Aid aid) const { return aids[static_cast<std::size_t>(aid)]; }
  AidHealth& of(Aid aid) { return aids[static_cast<std::size_t>(aid)]; }
};

}  // namespace rosflight::autonomy::estimation
