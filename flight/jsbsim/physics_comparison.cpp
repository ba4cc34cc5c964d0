// SPDX-License-Identifier: BSD-3-Clause
#include "flight/jsbsim/physics_comparison.hpp"

namespace rosflight::flight {
namespace {

struct OneFlight {
  explicit OneFlight(const FlightChoice& choice) : setup{choice}, flight{setup} {}
  bool step(sim::Time end) {
    if (flight.finished() || flight.now() >= end) return false;
    flight.step();
    return true;
  }
  double touchdown_speed_m_s() const {
    const FlightScore score = flight.score();
    const auto& touchdown = score.landing.touchdown();
    return touchdown ? touchdown->speed_m_s : ErrorStatistics::kNone;
  }

  FlightSetup setup;
  Flight flight;
};

}  // namespace

PhysicsComparison compare_physics(const FlightChoice& choice, const std::string& physics,
                                  sim::Time end, const DistanceSink& sink) {
  FlightChoice other = choice;
  other.physics = physics;
  const std::array flights{std::make_unique<OneFlight>(choice), std::make_unique<OneFlight>(other)};
  PhysicsComparison result;
  for (;;) {
    const std::array went_on{flights[0]->step(end), flights[1]->step(end)};
    if (!went_on[0] && !went_on[1]) break;
    if (!went_on[0] || !went_on[1]) continue;
    const sim::Truth& a = flights[0]->flight.truth();
    const sim::Truth& b = flights[1]->flight.truth();
    const double distance_m = (a.body.p_W - b.body.p_W).norm();
    result.position_m.add(distance_m);
    if (sink) sink(flights[0]->flight.now(), distance_m);
    if (!a.on_ground && !b.on_ground)
      result.attitude_rad.add(a.body.q_WB.angularDistance(b.body.q_WB));
    result.duration_s = sim::to_seconds(flights[0]->flight.now());
  }
  for (std::size_t k = 0; k < 2; ++k) {
    result.tracking_rms_m[k] = flights[k]->flight.tracking().rms();
    result.touchdown_speed_m_s[k] = flights[k]->touchdown_speed_m_s();
    result.success[k] = flights[k]->flight.score().success();
  }
  return result;
}

}  // namespace rosflight::flight
