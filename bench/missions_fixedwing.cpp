// SPDX-License-Identifier: BSD-3-Clause
// Flies every mission of a fixed wing that the project answers for, in lock-step and on the
// estimate, and prints how it went: one JSON object, NAME -> {QUANTITY: number}, like missions.cpp.
//
// usage: missions_fixedwing [NAME...]
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "base/constants.hpp"
#include "bench/mission_rows.hpp"
#include "flight/flight.hpp"

namespace {

using namespace rosflight::flight;  // NOLINT(google-build-using-namespace): a program of one file
using rosflight::bench::Figures;

using rosflight::base::kDegPerRad;
constexpr const char* kLoops = "autonomy.energy.longitudinal=successive_loops";

struct Row {
  const char* name;
  const char* mission;
  const char* wind;      ///< "" for calm; SPEED,FROM[,W20].
  const char* fault;     ///< "" for none.
  const char* override;  ///< "" for none.
  int seeds{1};
};

// The mission starts some 20 s after power-up; 80 s is on its long leg.
constexpr Row kRows[]{
    {"fixedwing_line", "hourglass_line", "", "", ""},
    {"fixedwing_fillet", "fixedwing", "", "", ""},
    {"fixedwing_dubins", "hourglass_dubins", "", "", ""},
    {"fixedwing_racetrack_wind", "racetrack", "8,250", "", ""},
    {"fixedwing_energy", "climb_and_descent", "", "", ""},
    {"fixedwing_loops", "climb_and_descent", "", "", kLoops},
    {"fixedwing_landing_range", "fixedwing", "", "", ""},
    {"fixedwing_landing_no_range", "fixedwing", "", "range@0", ""},
    {"fixedwing_landing_wind", "fixedwing", "5,250,2", "", ""},
    {"fixedwing_pitot_blocked", "fixedwing", "", "pitot_blocked@80", ""},
    {"fixedwing_gnss_loss", "fixedwing", "", "gnss@80:20", ""},
    {"fixedwing_motor_off", "fixedwing", "", "motor0_dead@80", ""},
    {"fixedwing_gusts", "fixedwing", "6,270,6", "", "", 100},
};

Figures fly(const Row& row, std::uint64_t seed) {
  FlightChoice choice;
  choice.vehicle = "anaconda";
  choice.mission = row.mission;
  choice.seed = seed;
  if (std::strlen(row.wind) > 0) choice.wind = row.wind;
  if (std::strlen(row.fault) > 0) choice.faults = {row.fault};
  if (std::strlen(row.override) > 0) choice.overrides = {row.override};
  const FlightSetup setup(choice);
  const auto flight = std::make_unique<Flight>(setup);
  flight->run();
  const FlightScore judged = flight->score();
  const FixedWingRecord& record = *flight->fixedwing_record();
  Figures out;
  out["landed"] = judged.landing.soft(judged.limits) && flight->runner().disarmed() ? 1.0 : 0.0;
  out["completed"] = judged.success() ? 1.0 : 0.0;
  out["straight_rms_m"] = record.straight.rms();
  out["arc_rms_m"] = record.arc.rms();
  out["corner_rms_m"] = record.corner.rms();
  out["corner_max_m"] = record.corner.max;
  out["straight_total_rms_m"] = record.straight_total.rms();
  out["arc_total_rms_m"] = record.arc_total.rms();
  out["height_rms_m"] = record.height.rms();
  out["airspeed_rms_m_s"] = record.airspeed.rms();
  out["max_bank_deg"] = kDegPerRad * record.roll.max;
  out["min_airspeed_m_s"] = record.lowest_airspeed_m_s;
  if (const auto& touch = record.touchdown()) {
    out["touchdown_distance_m"] = touch->distance_m;
    out["touchdown_sink_m_s"] = touch->sink_m_s;
    out["touchdown_bank_deg"] = kDegPerRad * std::abs(touch->roll_rad);
  }
  std::erase_if(out, [](const auto& figure) { return !std::isfinite(figure.second); });
  return out;
}

/// Over many seeds: the number completed, and the worst of the rest.
Figures worst_of(const Row& row) {
  Figures out{{"completed", 0.0}, {"landed", 0.0}};
  for (int seed = 1; seed <= row.seeds; ++seed) {
    for (const auto& [key, value] : fly(row, static_cast<std::uint64_t>(seed))) {
      if (key == "completed" || key == "landed") {
        out[key] += value;
      } else if (key == "min_airspeed_m_s") {
        const auto [entry, fresh] = out.emplace(key, value);
        if (!fresh) entry->second = std::min(entry->second, value);
      } else {
        const auto [entry, fresh] = out.emplace(key, value);
        if (!fresh) entry->second = std::max(entry->second, value);
      }
    }
  }
  return out;
}

Figures figures_of(const Row& row) {
  return row.seeds == 1 ? fly(row, 1) : worst_of(row);
}

}  // namespace

int main(int argc, char** argv) {
  return rosflight::bench::print_rows("missions_fixedwing", kRows, figures_of, argc, argv);
}
