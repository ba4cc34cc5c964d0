// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>

#include "autonomy/common/angles.hpp"
#include "autonomy/common/gap_watch.hpp"
#include "autonomy/fixedwing/types.hpp"

namespace rosflight::autonomy::fixedwing {

/// Decides whether a take-off that was given up on the runway begins again, which it does once.
///
/// It begins again when the vehicle has come to rest, link and receiver have been there for kHealthy_s, and it stands on its
/// runway: at most kBeside_m from the line of the first take-off, turned from it by kTurned_rad at most, and no farther than
/// kBeyond_m from where that began. A vehicle at rest waits kWait_s at most for link and receiver. Only a short
/// interruption is followed by another try: after a longer one somebody may stand before the vehicle, and what has kept a
/// vehicle with a link and a receiver on the ground would do so again. No clock.
class TakeoffRetry {
 public:
  static constexpr double kHealthy_s = 2.0;
  static constexpr double kWait_s = 10.0;
  static constexpr double kBeside_m = 5.0;
  static constexpr double kTurned_rad = 15.0 * kRadPerDeg;
  static constexpr double kBeyond_m = 300.0;

  struct Input {
    const StateEstimate& state;
    bool stands{};
    double healthy_s{};  ///< Since link or receiver were missing last.
    double dt_s{};
  };

  /// The first take-off of a flight begins here.
  void start(const Vector3& start_W, double course_rad) {
    start_W_ = start_W;
    course_rad_ = course_rad;
    used_ = open_ = due_ = false;
  }
  /// A take-off was given up. @param interrupted_s  time without link or receiver; 0: that was not the reason.
  void give_up(double interrupted_s) {
    open_ = interrupted_s > 0.0 && interrupted_s <= GapWatch::kGoesOn_s && !used_;
    due_ = false;
    rested_s_ = 0.0;
  }
  /// Once a step of the rollout.
  void step(const Input& in) {
    due_ = false;
    if (!open_ || !in.stands) return;
    rested_s_ += in.dt_s;
    const bool healthy = in.healthy_s > kHealthy_s;
    due_ = healthy && on_runway(in.state);
    open_ = !healthy && rested_s_ < kWait_s;
    used_ = used_ || due_;
  }
  /// The take-off begins again now.
  bool due() const { return due_; }
  /// A vehicle at rest may still begin again.
  bool waits() const { return open_; }

 private:
  bool on_runway(const StateEstimate& state) const {
    if (state.horizontal != Quality::kGood || state.heading != Quality::kGood || state.bridging)
      return false;
    const Vector2 from_start_m = (state.p_W - start_W_).head<2>();
    const double turned_rad = wrap_angle(heading_of(state.q_WB) - course_rad_);
    return std::abs(from_start_m.dot(right_of(course_rad_))) <= kBeside_m &&
           from_start_m.norm() <= kBeyond_m && std::abs(turned_rad) <= kTurned_rad;
  }

  Vector3 start_W_{Vector3::Zero()};
  double course_rad_{};
  double rested_s_{};
  bool used_{false};
  bool open_{false};
  bool due_{false};
};

}  // namespace rosflight::autonomy::fixedwing
