// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/multirotor/types.hpp"

namespace rosflight::autonomy::multirotor {

struct LandingConfig {
  double speed_m_s{1.0};             ///< Descent above slow_height_m.
  double touchdown_speed_m_s{0.35};  ///< Descent at the height of the start, and below it.
  double slow_height_m{1.5};         ///< Above the start; from here on it slows down.
  double acceleration_m_s2{1.0};     ///< Acceleration at the start of the descent.
  double contact_s{0.4};  ///< Sinking too slowly for this long means there may be ground.
  double unload_s{1.0};   ///< Time from hover thrust to none while probing the ground.
};

/// Lands on ground of unknown altitude and detects touchdown.
///
/// Descend: down velocity as above. If the vehicle sinks at less than 0.4 of the commanded speed
/// for contact_s while the thrust is below that of hovering, it probably stands; also if a range sensor
/// shows the ground for contact_s, whatever the estimated speed. Unload: level, thrust ramped down. If it then sinks faster than 0.4 m/s it was no ground, and the descent goes
/// on, unless a range sensor shows the ground; if the thrust has fallen to a fifth of hovering and
/// nothing moved for 0.3 s, it has touched down.
///
/// The thrust of hovering is what the vehicle was commanded in flight, averaged over 2 s, so
/// neither its mass nor a tired battery matters.
class Landing {
 public:
  struct Input {
    double dt_s{};
    double down_speed_m_s{};
    double height_m{};  ///< Above the position of take-off.
    double thrust_N{};  ///< Commanded in the step before.
    double hover_thrust_N{};
    bool at_ground{};  ///< A range sensor reads what it did when the vehicle stood.
  };
  struct Output {
    bool unloading{};
    double down_speed_m_s{};  ///< Command while descending.
    double thrust_N{};        ///< Command while unloading.
    bool touched{};
  };

  Landing() = default;
  /// Takes a copy; start() begins the landing.
  explicit Landing(const LandingConfig& config) : config_(config) {}
  /// Begins to descend: forgets an earlier landing.
  void start();
  /// One period of the descent: a speed to descend at, or a thrust while unloading, until it
  /// has touched the ground.
  Output step(const Input& in);

 private:
  double descent_speed(double height_m) const;

  LandingConfig config_{};
  double since_start_s_{};
  double slow_s_{};   ///< How long it has been sinking too slowly, or at the ground.
  double still_s_{};  ///< How long it has stood still without thrust.
  double thrust_N_{};
  bool unloading_{false};
};

}  // namespace rosflight::autonomy::multirotor
