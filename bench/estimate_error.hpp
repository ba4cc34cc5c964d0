// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cmath>
#include <deque>

#include "flight/flight.hpp"
#include "flight/link_state_estimator.hpp"

namespace rosflight::bench {

/// Names of the states whose errors the benches of the estimator compare with their sigmas.
inline constexpr std::array<const char*, 9> kStates{"north",  "east", "down",  "v_north", "v_east",
                                                    "v_down", "roll", "pitch", "yaw"};

/// The truth of the last moments, for an estimate is that of its own time, some 5 ms ago: to roll at 1 rad/s
/// is 0.3 degrees meanwhile.
class TruePast {
 public:
  struct Moment {
    double t_s{};
    sim::BodyState body;
    /// Position in the frame of the filter: horizontally as the satellites have it, the altitude counted from the ground.
    sim::Vector3 seen_W;
  };

  /// Once per step.
  void add(const flight::Flight& flight, sim::Time t) {
    constexpr std::size_t kKept = 80;
    sim::Vector3 seen_W = flight.seen_position_W();
    seen_W.z() = flight.truth().body.p_W.z();
    past_.push_back({sim::to_seconds(t), flight.truth().body, seen_W});
    if (past_.size() > kKept) past_.pop_front();
  }
  /// The step next to a time; null: none is.
  const Moment* at(double t_s) const {
    constexpr double kHalfStep_s = 1.3e-3;
    for (const Moment& moment : past_) {
      if (std::abs(moment.t_s - t_s) < kHalfStep_s) return &moment;
    }
    return nullptr;
  }

 private:
  std::deque<Moment> past_;
};

/// Errors of position, velocity and attitude (body axes) by their own standard deviations, as kStates.
inline Eigen::Matrix<double, 9, 1> in_sigmas(const autonomy::StateEstimate& e,
                                             const TruePast::Moment& truth) {
  Eigen::Matrix<double, 9, 1> error, sigma;
  error << e.p_W - truth.seen_W, e.v_W - truth.body.q_WB * truth.body.v_B,
      autonomy::estimation::log_rotation(truth.body.q_WB.conjugate() * e.q_WB);
  sigma << e.p_sigma_W_m, e.v_sigma_W_m_s, e.attitude_sigma_B_rad;
  return error.cwiseQuotient(sigma);
}

}  // namespace rosflight::bench
