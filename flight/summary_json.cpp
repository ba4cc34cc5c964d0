// SPDX-License-Identifier: BSD-3-Clause
// summary_json() alone: the JSON library takes seconds to compile.
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/constants.hpp"
#include "flight/build_info.hpp"
#include "flight/flight_summary.hpp"

namespace rosflight::flight {
namespace {

using Json = nlohmann::ordered_json;

/// Rounded to `digits` after the point; null if it is not finite.
Json rounded(double value, int digits) {
  if (!std::isfinite(value)) return {};
  const double scale = std::pow(10.0, digits);
  return std::round(value * scale) / scale;
}

Json waypoints_json(const FlightSummary& s) {
  Json all = Json::array();
  for (const WaypointPass& pass : s.score.waypoints) {
    all.push_back({{"reached", pass.within(s.score.score_radius_m)},
                   {"measure", measure_name(pass.measure)},
                   {"truth_distance_m", rounded(pass.truth_distance_m, 4)},
                   {"estimate_distance_m", rounded(pass.estimate_distance_m, 4)},
                   {"time_s", rounded(pass.t_s, 4)}});
  }
  return all;
}

void add_touchdown(Json& json, const FlightScore& score) {
  const auto& t = score.landing.touchdown();
  json["touchdown_speed_m_s"] = t ? rounded(t->speed_m_s, 4) : Json();
  json["touchdown_tilt_deg"] = t ? rounded(t->tilt_rad / base::kRadPerDeg, 4) : Json();
  json["touchdown_distance_m"] = rounded(score.landing.distance_m(score.limits), 4);
}

void add_fixedwing(Json& json, const FixedWingRecord& w) {
  json["straight_rms_m"] = rounded(w.straight.rms(), 6);
  json["arc_rms_m"] = rounded(w.arc.rms(), 6);
  json["corner_rms_m"] = rounded(w.corner.rms(), 6);
  json["straight_total_rms_m"] = rounded(w.straight_total.rms(), 6);
  json["arc_total_rms_m"] = rounded(w.arc_total.rms(), 6);
  json["height_rms_m"] = rounded(w.height.rms(), 6);
  json["height_total_rms_m"] = rounded(w.height_total.rms(), 6);
  json["airspeed_rms_m_s"] = rounded(w.airspeed.rms(), 6);
  json["largest_roll_deg"] = rounded(w.roll.largest() / base::kRadPerDeg, 4);
  json["lowest_airspeed_m_s"] = rounded(w.lowest_airspeed_m_s, 4);
  if (const auto& t = w.touchdown()) {
    json["touchdown"] = {{"distance_m", rounded(t->distance_m, 4)},
                         {"along_m", rounded(t->along_m, 4)},
                         {"sink_m_s", rounded(t->sink_m_s, 4)},
                         {"roll_deg", rounded(t->roll_rad / base::kRadPerDeg, 4)},
                         {"pitch_deg", rounded(t->pitch_rad / base::kRadPerDeg, 4)}};
  }
}

void add_processor(Json& json, const ProcessorFigures& figures, double sim_time_s) {
  json["stack_bytes"] = figures.stack_bytes;
  json["resets"] = figures.resets;
  json["passes"] = figures.passes;
  if (figures.imu_to_output_us > 0) {
    json["imu_to_output_us"] = figures.imu_to_output_us;
    json["transfer_to_output_us"] = figures.transfer_to_output_us;
    json["imu_to_output_mean_us"] = rounded(figures.imu_to_output_mean_us, 1);
    json["stamp_error_us"] = rounded(figures.stamp_error_us, 2);
  }
  if (figures.armed_us > 0.0)
    json["idle_fraction"] = rounded(figures.slept_us / figures.armed_us, 4);
  if (figures.instructions > 0) json["instructions"] = figures.instructions;
  if (figures.uart_sent > 0) {
    json["uart_sent_bytes_per_s"] = rounded(static_cast<double>(figures.uart_sent) / sim_time_s, 0);
    json["uart_received_bytes_per_s"] =
        rounded(static_cast<double>(figures.uart_received) / sim_time_s, 0);
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
  const FlightScore& score = s.score;
  Json json{{"success", score.success()},
            {"outcome", outcome_name(score.outcome)},
            {"verdict", score.verdict},
            {"board", s.choice.board},
            {"link", s.choice.link},
            {"link_protocol", s.choice.link_protocol},
            {"vehicle", s.choice.vehicle},
            {"mission", s.choice.mission},
            {"seed", s.choice.seed},
            {"pilot", s.choice.pilot},
            {"state", s.choice.state},
            {"physics", s.choice.physics},
            {"world", s.choice.world.empty() ? Json() : Json(s.choice.world)},
            {"wind", s.choice.wind ? Json(*s.choice.wind) : Json()},
            {"faults", s.choice.faults},
            {"faults_too_late", s.faults_too_late},
            {"overrides", s.choice.overrides},
            {"plugins", s.choice.plugins},
            {"version", build_info().version},
            {"commit", build_info().commit.empty() ? Json() : Json(build_info().commit)},
            {"changed_since_commit", build_info().changed},
            {"arguments", s.arguments},
            {"sim_time_s", rounded(s.sim_time_s, 4)},
            {"flight_time_s", rounded(s.flight_time_s, 4)},
            {"wall_time_s", rounded(s.wall_time_s, 4)},
            {"realtime_factor", rounded(s.realtime_factor(), 1)},
            {"score_radius_m", score.score_radius_m},
            {"waypoints_total", score.waypoints.size()},
            {"waypoints_reached", score.waypoints_reached()},
            {"waypoints", waypoints_json(s)},
            {"tracking_rms_m", rounded(s.tracking.rms(), 6)},
            {"tracking_max_m", rounded(s.tracking.largest(), 6)},
            {"own_tracking_rms_m", rounded(s.own_tracking.rms(), 6)},
            {"own_tracking_max_m", rounded(s.own_tracking.largest(), 6)}};
  add_touchdown(json, score);
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
  if (std::isfinite(s.gyro_latency_s)) json["gyro_latency_ms"] = rounded(1e3 * s.gyro_latency_s, 3);
  if (s.counters) json["counters"] = counters_json(*s.counters);
  // Texts may contain a file name that is no UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace rosflight::flight
