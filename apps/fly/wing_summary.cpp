// SPDX-License-Identifier: BSD-3-Clause
#include "apps/fly/wing_summary.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include "autonomy/common/types.hpp"

namespace rosflight::apps {

std::string wing_json(const WingRecord* w) {
  if (w == nullptr) return "";
  std::string out = fmt::format(
      "\"straight_rms_m\": {:.6f}, \"arc_rms_m\": {:.6f}, \"corner_rms_m\": {:.6f}, "
      "\"straight_total_rms_m\": {:.6f}, "
      "\"arc_total_rms_m\": {:.6f}, \"height_rms_m\": {:.6f}, \"height_total_rms_m\": {:.6f}, "
      "\"airspeed_rms_m_s\": {:.6f}, \"largest_roll_deg\": {:.4f}, "
      "\"lowest_airspeed_m_s\": {:.4f}, ",
      w->straight.rms_m(), w->arc.rms_m(), w->corner.rms_m(), w->straight_total.rms_m(),
      w->arc_total.rms_m(), w->height.rms_m(), w->height_total.rms_m(), w->airspeed.rms_m(),
      w->roll.max_m / autonomy::kRadPerDeg, w->lowest_airspeed_m_s);
  if (const auto& t = w->touchdown()) {
    out += fmt::format(
        "\"touchdown\": {{\"distance_m\": {:.4f}, \"along_m\": {:.4f}, \"sink_m_s\": {:.4f}, "
        "\"roll_deg\": {:.4f}, \"pitch_deg\": {:.4f}}}, ",
        t->distance_m, t->along_m, t->sink_m_s, t->roll_rad / autonomy::kRadPerDeg,
        t->pitch_rad / autonomy::kRadPerDeg);
  }
  return out;
}

void print_wing(std::ostream& out, const WingRecord& w) {
  fmt::print(out, "cross-track      {:.2f} m rms on straights, {:.2f} m on arcs\n",
             w.straight.rms_m(), w.arc.rms_m());
  fmt::print(out, "height, airspeed {:.2f} m, {:.2f} m/s rms\n", w.height.rms_m(),
             w.airspeed.rms_m());
  if (const auto& t = w.touchdown()) {
    fmt::print(out, "touch-down       {:.1f} m from the aim point, sink {:.2f} m/s\n",
               t->distance_m, t->sink_m_s);
  }
}

void add_wing_facts(report::FlightRecord& record, const WingRecord& w) {
  const auto fact = [&record](const char* label, double value, const char* unit) {
    record.facts.push_back(
        {label, fmt::format("{:.2f}", value), unit, true, report::Tone::kNeutral});
  };
  fact("Cross-track, straights, rms", w.straight.rms_m(), "m");
  fact("Cross-track, arcs, rms", w.arc.rms_m(), "m");
  if (w.corner.count > 0) fact("After sharp corners, rms", w.corner.rms_m(), "m");
  fact("Height, rms", w.height.rms_m(), "m");
  fact("Airspeed, rms", w.airspeed.rms_m(), "m/s");
  if (const auto& t = w.touchdown()) {
    fact("Touch-down from aim", t->distance_m, "m");
    fact("Sink at touch-down", t->sink_m_s, "m/s");
  }
}

}  // namespace rosflight::apps
