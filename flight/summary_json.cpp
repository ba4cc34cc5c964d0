// SPDX-License-Identifier: BSD-3-Clause
// summary_json() alone: the JSON library takes seconds to compile.
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/constants.hpp"
#include "flight/flight_summary.hpp"

namespace rosflight::flight {
namespace {

using Json = nlohmann::ordered_json;

/// Rounded to `digits` after the point; null if it is not finite.
Json number(double value, int digits) {
  if (!std::isfinite(value)) return {};
  const double scale = std::pow(10.0, digits);
  return std::round(value * scale) / scale;
}

Json waypoints_json(const FlightSummary& s) {
  Json all = Json::array();
  for (std::size_t k = 0; k < s.waypoints_total; ++k) {
    const bool flown = k < s.arrivals.size();
    all.push_back({{"reached", flown && s.arrivals[k].reached},
                   {"distance_m", flown ? number(s.arrivals[k].distance_m, 4) : Json()},
                   {"time_s", flown ? number(s.arrivals[k].t_s, 4) : Json()}});
  }
  return all;
}

void add_fixedwing(Json& json, const FixedWingRecord& w) {
  json["straight_rms_m"] = number(w.straight.rms(), 6);
  json["arc_rms_m"] = number(w.arc.rms(), 6);
  json["corner_rms_m"] = number(w.corner.rms(), 6);
  json["straight_total_rms_m"] = number(w.straight_total.rms(), 6);
  json["arc_total_rms_m"] = number(w.arc_total.rms(), 6);
  json["height_rms_m"] = number(w.height.rms(), 6);
  json["height_total_rms_m"] = number(w.height_total.rms(), 6);
  json["airspeed_rms_m_s"] = number(w.airspeed.rms(), 6);
  json["largest_roll_deg"] = number(w.roll.max / base::kRadPerDeg, 4);
  json["lowest_airspeed_m_s"] = number(w.lowest_airspeed_m_s, 4);
  if (const auto& t = w.touchdown()) {
    json["touchdown"] = {{"distance_m", number(t->distance_m, 4)},
                         {"along_m", number(t->along_m, 4)},
                         {"sink_m_s", number(t->sink_m_s, 4)},
                         {"roll_deg", number(t->roll_rad / base::kRadPerDeg, 4)},
                         {"pitch_deg", number(t->pitch_rad / base::kRadPerDeg, 4)}};
  }
}

void add_processor(Json& json, const ProcessorFigures& figures, double sim_time_s) {
  json["stack_bytes"] = figures.stack_bytes;
  json["resets"] = figures.resets;
  json["passes"] = figures.passes;
  if (figures.instructions > 0) json["instructions"] = figures.instructions;
  if (figures.uart_sent > 0) {
    json["uart_sent_bytes_per_s"] = number(static_cast<double>(figures.uart_sent) / sim_time_s, 0);
    json["uart_received_bytes_per_s"] =
        number(static_cast<double>(figures.uart_received) / sim_time_s, 0);
    json["uart_lost"] = figures.uart_lost;
  }
}

Json counters_json(const link::Counters& c) {
  return {{"longest_pass_us", c.longest_pass_us},
          {"pass_budget_us", c.pass_budget_us},
          {"passes_over_budget", c.passes_over_budget},
          {"passes", c.passes},
          {"frames_dropped", c.frames_dropped},
          {"tx_dropped", c.tx_dropped},
          {"texts_lost", c.texts_lost},
          {"imu_jitter", c.imu_jitter},
          {"rejected", c.rejected}};
}

}  // namespace

std::string summary_json(const FlightSummary& s) {
  Json json{{"success", s.success},
            {"verdict", s.verdict},
            {"board", s.choice.board},
            {"link", s.choice.link},
            {"link_protocol", s.choice.link_protocol},
            {"vehicle", s.choice.vehicle},
            {"mission", s.choice.mission},
            {"seed", s.choice.seed},
            {"sim_time_s", number(s.sim_time_s, 4)},
            {"flight_time_s", number(s.flight_time_s, 4)},
            {"wall_time_s", number(s.wall_time_s, 4)},
            {"realtime_factor", number(s.realtime_factor(), 1)},
            {"waypoints_total", s.waypoints_total},
            {"waypoints_reached", s.waypoints_reached},
            {"waypoints", waypoints_json(s)},
            {"tracking_rms_m", number(s.tracking.rms(), 6)},
            {"tracking_max_m", number(s.tracking.max, 6)},
            {"own_tracking_rms_m", number(s.own_tracking.rms(), 6)},
            {"own_tracking_max_m", number(s.own_tracking.max, 6)}};
  if (s.fixedwing) add_fixedwing(json, *s.fixedwing);
  json["landed"] = s.landed;
  json["disarmed"] = s.disarmed;
  json["warnings"] = s.warnings;
  json["errors"] = s.errors;
  json["frames_dropped"] = s.frames_dropped;
  json["log"] = s.log ? Json(s.log->path.string()) : Json();
  json["log_sha256"] = s.log ? Json(s.log->sha256) : Json();
  json["log_messages"] = s.log ? s.log->messages : 0;
  json["log_bytes"] = s.log ? s.log->bytes : 0;
  if (s.processor) add_processor(json, *s.processor, s.sim_time_s);
  if (std::isfinite(s.gyro_latency_s)) json["gyro_latency_ms"] = number(1e3 * s.gyro_latency_s, 3);
  if (s.counters) json["counters"] = counters_json(*s.counters);
  // Texts may contain a file name that is no UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace rosflight::flight
