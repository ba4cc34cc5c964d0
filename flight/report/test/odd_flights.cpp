// SPDX-License-Identifier: BSD-3-Clause
#include "flight/report/test/odd_flights.hpp"

#include <limits>
#include <stdexcept>
#include <string>

namespace rosflight::report {
namespace {

constexpr const char* kHostile =
    "</script><script>alert('x')</script>&amp;<b a=\"'>]]>--><!-- \xFF\xC0\xAF \x1B[2J";

FlightRecord one() {
  FlightRecord record(0.0);
  record.estimated = record.fixed_wing = true;
  Sample sample;
  sample.p_W_m = {1.0F, 2.0F, -3.0F};
  sample.attitude_rad = {0.1F, 0.2F, 0.3F};
  sample.motors = {0.5F, 0.5F, 0.5F, 0.5F};
  record.add(sample);
  return record;
}

FlightRecord nan() {
  FlightRecord record(0.0);
  record.estimated = record.fixed_wing = true;
  for (int k = 0; k < 100; ++k) {
    Sample sample;
    sample.t_s = 0.1 * k;
    record.add(sample);
  }
  Waypoint nowhere;
  nowhere.p_W_m.fill(std::numeric_limits<double>::quiet_NaN());
  record.waypoints.push_back(nowhere);
  return record;
}

FlightRecord wild() {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  FlightRecord record(0.0);
  record.estimated = record.fixed_wing = true;
  for (int k = 0; k < 50; ++k) {
    Sample sample;
    sample.t_s = k < 25 ? 0.5 * k : 12.5;
    const float huge = k % 2 == 0 ? 3e38F : -3e38F;
    sample.p_W_m = {huge, k % 3 == 0 ? kInf : 1.0F, -kInf};
    sample.v_W_m_s = {huge, huge, 1e-30F};
    sample.attitude_rad = {1e-30F, 1e20F, huge};
    sample.rates_rad_s = {16777216.0F + static_cast<float>(k), 5.0F, kInf};
    sample.motors.fill(huge);
    record.add(sample);
  }
  Waypoint far;
  far.p_W_m = {1e300, -1e300, 1e300};
  record.waypoints.push_back(far);
  record.faults = {{"forever", -5.0, std::numeric_limits<double>::infinity()},
                   {"never", std::numeric_limits<double>::quiet_NaN(), 1.0},
                   {"later", 1e9, 2e9}};
  return record;
}

FlightRecord hostile() {
  FlightRecord record = one();
  record.title = record.vehicle = record.mission = record.seed = kHostile;
  record.command_line = record.verdict = kHostile;
  record.facts = {{kHostile, kHostile, kHostile, true, Tone::kBad},
                  {kHostile, kHostile, kHostile, false, {}}};
  record.faults = {{kHostile, 0.0, 1.0}};
  record.changed_parameters = {{kHostile, kHostile, kHostile, kHostile}};
  record.files = {kHostile};
  record.set_state(kHostile, 0.0, kHostile, Tone::kWarning);
  record.add_event(5.0, Tone::kBad, kHostile, kHostile);
  return record;
}

FlightRecord chatter() {
  FlightRecord record = one();
  for (int k = 0; k < 20'000; ++k) {
    record.set_state("Chatter", 0.0025 * k, std::to_string(k % 2), Tone::kWarning);
    record.add_event(0.0025 * k, Tone::kNote, "fcu", "again and again");
  }
  return record;
}

}  // namespace

FlightRecord odd_flight(std::string_view kind) {
  if (kind == "empty") return FlightRecord{};
  if (kind == "one") return one();
  if (kind == "nan") return nan();
  if (kind == "wild") return wild();
  if (kind == "hostile") return hostile();
  if (kind == "chatter") return chatter();
  throw std::invalid_argument("no flight of kind " + std::string(kind));
}

}  // namespace rosflight::report
