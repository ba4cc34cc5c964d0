// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "flight/autopilot/in_process_autopilot.hpp"
#include "flight/flight.hpp"

/// A flight for tests: choices in, what happened out.
namespace rosflight::flight::testing {

inline sim::Time at_s(double t_s) {
  return sim::Time{static_cast<std::int64_t>(t_s * 1e6)};
}

struct Rig {
  explicit Rig(const FlightChoice& choice, FlightParts parts = {})
      : setup{std::make_unique<FlightSetup>(choice)},
        flight{std::make_unique<Flight>(*setup, std::move(parts))} {}

  static FlightChoice with_faults(std::vector<std::string> faults) {
    FlightChoice choice;
    choice.faults = std::move(faults);
    return choice;
  }

  /// Steps until the mission runner is in `stage`, or finished.
  bool reach(Stage stage) {
    while (!flight->runner().finished() && flight->runner().stage() != stage) flight->step();
    return flight->runner().stage() == stage;
  }
  /// Steps until autonomy follows the mission.
  bool reach_mission() {
    if (!reach(Stage::kFly)) return false;
    while (!flight->runner().finished() && !flight->autonomy().tracking) flight->step();
    return flight->autonomy().tracking;
  }
  void run_for(double duration_s) {
    const sim::Time end = flight->now() + at_s(duration_s);
    while (flight->now() < end) flight->step();
  }
  void run_until(double t_s) {
    while (flight->now() < at_s(t_s)) flight->step();
  }

  const core::Firmware& firmware() const { return flight->in_process().firmware(); }
  /// Whether the mission was completed by the true motion.
  bool completed() const { return flight->score().success(); }
  double tilt_deg() const {
    const double c = (flight->truth().body.q_WB * sim::Vector3::UnitZ()).z();
    return std::acos(std::min(1.0, std::max(-1.0, c))) * 180.0 / 3.14159265358979323846;
  }
  double sink_m_s() const { return (flight->truth().body.q_WB * flight->truth().body.v_B).z(); }
  double height_m() const { return -flight->truth().body.p_W.z(); }

  std::unique_ptr<FlightSetup> setup;
  std::unique_ptr<Flight> flight;
};

}  // namespace rosflight::flight::testing
