// SPDX-License-Identifier: BSD-3-Clause
// Flies a mission with our integrator and with another engine, and prints as JSON how the flights differ.
//
// usage: worlds ENGINE VEHICLE MISSION [--wind WIND] [--set KEY=VALUE] [--csv FILE]
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>

#include "base/constants.hpp"
#include "flight/jsbsim/physics_comparison.hpp"

namespace {

using rosflight::base::kRadPerDeg;
namespace flight = rosflight::flight;
namespace sim = rosflight::sim;

constexpr const char* kUsage =
    "usage: worlds ENGINE VEHICLE MISSION [--wind WIND] [--set KEY=VALUE] [--csv FILE]";
constexpr sim::Time kBetweenRows = std::chrono::milliseconds{100};

struct Options {
  std::string engine;
  flight::FlightChoice choice;
  std::string csv;  ///< Empty: no file.
};

Options parse(const std::vector<std::string>& words) {
  if (words.size() < 3 || words.size() % 2 == 0) throw std::invalid_argument(kUsage);
  Options options{words[0], {}, {}};
  options.choice.vehicle = words[1];
  options.choice.mission = words[2];
  for (std::size_t k = 3; k < words.size(); k += 2) {
    if (words[k] == "--wind") {
      options.choice.wind = words[k + 1];
    } else if (words[k] == "--set") {
      options.choice.overrides.push_back(words[k + 1]);
    } else if (words[k] == "--csv") {
      options.csv = words[k + 1];
    } else {
      throw std::invalid_argument(kUsage);
    }
  }
  return options;
}

/// A number, or null where the flight has none.
std::string json(double value) {
  return std::isnan(value) ? "null" : fmt::format("{:.6g}", value);
}

template <class Pair>
std::string json_pair(const Pair& pair) {
  return fmt::format("[{}, {}]", json(pair[0]), json(pair[1]));
}

void print(const flight::PhysicsComparison& found) {
  fmt::print(
      "{{\"position_rms_m\": {}, \"position_max_m\": {}, \"attitude_rms_deg\": {}, "
      "\"attitude_max_deg\": {}, \"tracking_rms_m\": {}, \"touchdown_m_s\": {}, \"success\": [{}, "
      "{}], "
      "\"duration_s\": {}}}\n",
      json(found.position_m.rms()), json(found.position_m.largest()),
      json(found.attitude_rad.rms() / kRadPerDeg), json(found.attitude_rad.largest() / kRadPerDeg),
      json_pair(found.tracking_rms_m), json_pair(found.touchdown_speed_m_s), found.success[0],
      found.success[1], json(found.duration_s));
}

int run(const Options& options) {
  std::ofstream csv;
  if (!options.csv.empty()) {
    csv.open(options.csv);
    csv << "time_s,distance_m\n";
    if (!csv) throw std::runtime_error(options.csv + ": cannot be written");
  }
  sim::Time next{};
  const auto found = flight::compare_physics(
      options.choice, options.engine, sim::Time::max(), [&](sim::Time now, double distance_m) {
        if (!csv.is_open() || now < next) return;
        next = now + kBetweenRows;
        csv << fmt::format("{:.3f},{:.7f}\n", sim::to_seconds(now), distance_m);
      });
  print(found);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(parse({argv + 1, argv + argc}));
  } catch (const std::exception& e) {
    std::cerr << "worlds: " << e.what() << "\n";
    return 2;
  }
}
