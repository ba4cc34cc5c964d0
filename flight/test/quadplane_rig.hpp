// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "flight/test/flight_rig.hpp"

/// Flights of vehicles/quadplane.yaml on missions/quadplane.yaml for tests, judged by the truth: docs/quadplane.md.
namespace rosflight::flight::testing {

using QuadplanePhase = autonomy::quadplane::Phase;

inline FlightChoice quadplane(std::vector<std::string> faults = {}) {
  FlightChoice choice = Rig::with_faults(std::move(faults));
  choice.vehicle = "quadplane";
  return choice;
}

inline const autonomy::quadplane::FlightOutput& details(const Rig& rig) {
  return dynamic_cast<const QuadplaneGuidance&>(rig.flight->guidance()).details();
}

/// What the truth shows of a whole flight.
struct QuadplaneRecord {
  double loss_m{};           ///< Largest sink below the path in a transition.
  double largest_error_m{};  ///< From the path.
  double takeoff_drift_m{};  ///< Horizontally from the start.
  double landing_drift_m{};  ///< Horizontally from the end of the mission.
  double largest_tilt_deg{};
  double sum_m2{};
  int samples{};

  double rms_m() const { return std::sqrt(sum_m2 / samples); }
  void step(const Rig& rig) {
    const auto& guidance = details(rig);
    const sim::Vector3& p_W = rig.flight->truth().body.p_W;
    largest_tilt_deg = std::max(largest_tilt_deg, rig.tilt_deg());
    if (guidance.phase == QuadplanePhase::kTakeoff)
      takeoff_drift_m = std::max(takeoff_drift_m, p_W.head<2>().norm());
    if (guidance.phase == QuadplanePhase::kHover || guidance.phase == QuadplanePhase::kLanding)
      landing_drift_m =
          std::max(landing_drift_m, (p_W - rig.setup->waypoints.back().p_W).head<2>().norm());
    if (!guidance.tracking) return;
    const sim::Vector3 error_W = p_W - guidance.setpoint.p_W;
    sum_m2 += error_W.squaredNorm();
    ++samples;
    largest_error_m = std::max(largest_error_m, error_W.norm());
    if (guidance.phase == QuadplanePhase::kTransition || guidance.phase == QuadplanePhase::kBack)
      loss_m = std::max(loss_m, error_W.z());
  }
};

inline QuadplaneRecord fly(Rig& rig) {
  QuadplaneRecord record;
  while (!rig.flight->finished()) {
    rig.flight->step();
    record.step(rig);
  }
  return record;
}

inline bool reach(Rig& rig, QuadplanePhase phase) {
  while (!rig.flight->finished() && details(rig).phase != phase) rig.flight->step();
  return details(rig).phase == phase;
}

}  // namespace rosflight::flight::testing
