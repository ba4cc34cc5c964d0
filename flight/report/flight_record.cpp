// SPDX-License-Identifier: BSD-3-Clause
#include "flight/report/flight_record.hpp"

#include <algorithm>

namespace rosflight::report {
namespace {

/// Steps of simulated time are sums; a sample a hair early is still due.
constexpr double kEarly = 0.999;
/// Samples at 100 Hz, so that most flights never copy them to make room. Memory that is not written costs nothing.
constexpr std::size_t kTwoMinutes = 12'000;

}  // namespace

bool FlightRecord::wants(double t_s) const {
  return samples_.empty() || t_s - samples_.back().t_s >= kEarly * interval_s_;
}

void FlightRecord::add(const Sample& sample) {
  if (!wants(sample.t_s)) return;
  if (samples_.empty()) samples_.reserve(kTwoMinutes);
  samples_.push_back(sample);
}

void FlightRecord::set_state(std::string_view lane, double t_s, std::string_view label, Tone tone) {
  auto found =
      std::find_if(lanes_.begin(), lanes_.end(), [&](const Lane& l) { return l.name == lane; });
  if (found == lanes_.end()) found = lanes_.insert(lanes_.end(), Lane{std::string(lane), {}});
  auto& changes = found->changes;
  if (!changes.empty() && changes.back().label == label && changes.back().tone == tone) return;
  changes.push_back({t_s, std::string(label), tone});
}

void FlightRecord::add_event(double t_s, Tone tone, std::string_view source,
                             std::string_view text) {
  events_.push_back({t_s, tone, std::string(source), std::string(text)});
}

double FlightRecord::end_s() const {
  double end = 0.0;
  if (!samples_.empty()) end = std::max(end, samples_.back().t_s);
  for (const Lane& lane : lanes_) {
    if (!lane.changes.empty()) end = std::max(end, lane.changes.back().t_s);
  }
  for (const Event& event : events_) end = std::max(end, event.t_s);
  return end;
}

}  // namespace rosflight::report
