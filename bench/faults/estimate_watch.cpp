// SPDX-License-Identifier: BSD-3-Clause
#include "bench/faults/estimate_watch.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::bench::faults {

using autonomy::StateEstimate;

void EstimateCount::add(const EstimateCount& other) {
  samples += other.samples;
  for (std::size_t k = 0; k < outside.size(); ++k) outside[k] += other.outside[k];
  far += other.far;
  in_time += other.in_time;
  said += other.said;
}

std::size_t EstimateCount::worst() const {
  return static_cast<std::size_t>(std::ranges::max_element(outside) - outside.begin());
}

double EstimateCount::worst_share() const {
  if (samples == 0) return 0.0;
  return static_cast<double>(outside[worst()]) / static_cast<double>(samples);
}

void EstimateWatch::look(const flight::Flight& flight, sim::Time t) {
  const double now_s = sim::to_seconds(t);
  if (now_s < begin_s_ - kKept_s || flight.runner().stage() != flight::Stage::kFly) return;
  past_.add(flight, t);
  if (now_s < begin_s_) return;
  if (!begun_) began_before_lift_off_ = !flight.score().landing.airborne();
  begun_ = true;
  constexpr int kEvery = 20;  // twenty times a second
  if (++step_ % kEvery != 0 || flight.truth().on_ground) return;
  const auto& source = flight.estimate_source();
  if (!source.health().initialised) return;
  const StateEstimate e = source.estimate();
  constexpr double kStale_s = 0.1;
  if (now_s - e.t_s > kStale_s) return;
  const TruePast::Moment* then = past_.at(e.t_s);
  if (then == nullptr) return;
  sample(now_s, in_sigmas(e, *then), (e.p_W - then->seen_W).head<2>().norm(),
         e.position_unreliable);
}

void EstimateWatch::sample(double t_s, const Eigen::Matrix<double, 9, 1>& sigmas, double off_m,
                           bool unreliable) {
  ++count_.samples;
  for (std::size_t k = 0; k < count_.outside.size(); ++k) {
    const double off = std::abs(sigmas(static_cast<Eigen::Index>(k)));
    count_.outside[k] += off <= 3.0 ? 0U : 1U;  // a state that is no number is outside
  }
  said_ = said_ || unreliable;
  const bool far = off_m > StateEstimate::kUnreliable_m;
  if (!far) {
    far_since_s_ = -1.0;
  } else if (unreliable) {
    reported_ = true;
    far_since_s_ = -1.0;
  } else if (far_since_s_ < 0.0) {
    far_since_s_ = t_s;
  }
  constexpr double kInTime_s = 10.0;
  if (far_since_s_ >= 0.0 && t_s - far_since_s_ > kInTime_s) late_ = true;
}

EstimateCount EstimateWatch::count() const {
  EstimateCount out = count_;
  out.far = reported_ || late_ ? 1 : 0;
  out.in_time = reported_ && !late_ ? 1 : 0;
  out.said = said_ ? 1 : 0;
  return out;
}

}  // namespace rosflight::bench::faults
