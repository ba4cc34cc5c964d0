// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "sim/types.hpp"

namespace rosflight::flight {

/// Limits of a soft landing and the landing area. Those of each kind of aircraft: docs/scoring.md.
struct LandingLimits {
  sim::Vector3 aim_W{sim::Vector3::Zero()};
  double max_speed_m_s{1.5};  ///< Downwards, before the first contact.
  double max_bank_rad{};      ///< 0: no limit besides LandingScore::kCrashTilt_rad.
  double half_length_m{3.0};  ///< Landing area along its course; without a course its radius.
  double half_width_m{3.0};
  std::optional<double> course_rad;  ///< Course of the landing area.
};

/// How a flight came down, by the truth alone.
///
/// The touchdown is the first contact after which the vehicle stays down: rebounds up to a height belong
/// to it, and the hardest of their contacts counts for the limits. A contact after which it flies on is
/// counted apart. A vehicle that has stood at rest and takes off again has landed before: the hardest of those
/// landings has to be within the limits too.
class LandingScore {
 public:
  static constexpr double kCrashSpeed_m_s = 4.0;
  static constexpr double kCrashTilt_rad = 0.785398163397448309616;  // 45 deg
  static constexpr double kRest_m_s = 1.0, kRest_s = 1.0;  ///< Slower for so long: at rest.

  /// @param rebound_m  above the height of the contact.
  explicit LandingScore(double rebound_m = 0.5) : rebound_m_{rebound_m} {}

  struct Touchdown {
    double t_s{};
    double speed_m_s{};    ///< Downwards, in the step before the contact.
    double hardest_m_s{};  ///< The same of the hardest contact, this or of a rebound.
    double tilt_rad{};     ///< Between the body's z axis and down.
    double bank_rad{};
    sim::Vector3 p_W{sim::Vector3::Zero()};
    double course_rad{};  ///< Course of the velocity over ground.
  };

  /// Once per step from arming on.
  void step(const sim::Truth& truth);

  bool airborne() const { return airborne_; }  ///< It has taken off.
  /// Empty: still in the air, or never there.
  const std::optional<Touchdown>& touchdown() const { return touchdown_; }
  /// The hardest of it and of landings before another take-off; null without a touchdown.
  const Touchdown* hardest() const;
  /// Contacts between take-off and touchdown.
  int early_contacts() const { return early_contacts_; }
  /// Time on the ground without a break [s].
  double down_for_s() const { return down_for_s_; }
  /// Tilt now [rad].
  double tilt_rad() const { return tilt_rad_; }

  /// From the aim, horizontally [m]. NaN without a touchdown.
  double distance_m(const LandingLimits& limits) const;
  bool inside(const LandingLimits& limits) const;
  /// Speed and bank within the limits, and it still stands upright.
  bool soft(const LandingLimits& limits) const;
  /// Beyond what a landing gear may bear, overturned, or a contact before the landing.
  bool crashed() const;

 private:
  double rebound_m_;
  bool airborne_{false};
  bool contact_{false};
  std::optional<Touchdown> touchdown_;
  std::optional<Touchdown> earlier_;  ///< The worst of each before another take-off.
  bool rested_{false};                ///< Since the touchdown.
  double rests_for_s_{0.0};
  int early_contacts_{0};
  double ground_height_m_{0.0};  ///< Altitude of the centre of mass at the last contact.
  double down_for_s_{0.0};
  double tilt_rad_{0.0};
  double sink_m_s_{0.0};
  double last_s_{0.0};
};

}  // namespace rosflight::flight
