// SPDX-License-Identifier: BSD-3-Clause
#include "flight/flight_summary.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rosflight::flight {
FlightSummary summarise(const Flight& flight) {
  FlightSummary s;
  const MissionRunner& runner = flight.runner();
  s.choice = flight.setup().choice;
  s.sim_time_s = sim::to_seconds(flight.now());
  if (runner.armed_at() > sim::Time{0})
    s.flight_time_s = sim::to_seconds(flight.now() - runner.armed_at());
  s.arrivals = runner.arrivals();
  s.waypoints_total = flight.setup().waypoints.size();
  s.waypoints_reached = static_cast<std::size_t>(
      std::count_if(s.arrivals.begin(), s.arrivals.end(), [](const auto& a) { return a.reached; }));
  s.tracking = flight.tracking();
  s.own_tracking = flight.own_tracking();
  if (const FixedWingRecord* record = flight.fixedwing_record()) s.fixedwing = *record;
  s.landed = flight.autonomy().landed;
  s.disarmed = runner.disarmed();
  s.processor = flight.autopilot().figures();
  s.success = runner.stage() == Stage::kDone && s.waypoints_reached == s.waypoints_total &&
              s.landed && s.disarmed;
  if (s.success) {
    s.verdict = "All waypoints reached, landed and disarmed.";
  } else if (!runner.failure().empty()) {
    s.verdict = fmt::format("Failed: {}.", runner.failure());
  } else {
    s.verdict = fmt::format("Failed: {} of {} waypoints reached{}.", s.waypoints_reached,
                            s.waypoints_total, s.landed ? "" : ", not landed");
  }
  return s;
}

}  // namespace rosflight::flight
