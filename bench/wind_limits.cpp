// SPDX-License-Identifier: BSD-3-Clause
// Finds the strongest wind in which each shipped vehicle flies its default mission: steady wind with
// gusts of the same w20, from the north, east, south and west, five seeds each, whole metres a
// second from calm upwards until a flight does not end as mission_done. Prints one JSON object,
// VEHICLE -> {"wind_limit_m_s": SPEED, "failed": "flight that ended the search"}.
//
// usage: wind_limits [VEHICLE...]
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "flight/campaign.hpp"

namespace {

using namespace rosflight::flight;  // NOLINT(google-build-using-namespace): a program of one file

struct Vehicle {
  const char* name;
  const char* mission;
};
constexpr Vehicle kVehicles[]{{"multirotor", "default"},
                              {"anaconda", "fixedwing"},
                              {"openvsp_anaconda", "fixedwing"},
                              {"xflr5_anaconda", "fixedwing"},
                              {"aerosonde", "wide_circuit"}};
constexpr int kFrom_deg[]{0, 90, 180, 270};
constexpr std::uint64_t kSeeds = 5;
constexpr int kStrongest_m_s = 30;

/// What went wrong at this speed; empty if all flights were successes.
std::string first_failure(const Vehicle& vehicle, int speed_m_s) {
  for (const int from_deg : kFrom_deg) {
    CampaignOptions options;
    options.choice.vehicle = vehicle.name;
    options.choice.mission = vehicle.mission;
    options.choice.wind = fmt::format("{0},{1},{0}", speed_m_s, from_deg);
    options.last_seed = kSeeds;
    for (const FlightSummary& flight : fly_campaign(options)) {
      if (flight.score.outcome == Outcome::kMissionDone) continue;
      return fmt::format("--wind {} --seed {}: {}", *options.choice.wind, flight.choice.seed,
                         outcome_name(flight.score.outcome));
    }
  }
  return {};
}

std::string limit_of(const Vehicle& vehicle) {
  int limit_m_s = -1;
  std::string failure;
  while (limit_m_s < kStrongest_m_s && failure.empty()) {
    failure = first_failure(vehicle, limit_m_s + 1);
    if (failure.empty()) ++limit_m_s;
  }
  return fmt::format("\"{}\": {{\"wind_limit_m_s\": {}, \"failed\": \"{}\"}}", vehicle.name,
                     limit_m_s, failure);
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> wanted(argv + 1, argv + argc);
  std::string text;
  for (const Vehicle& vehicle : kVehicles) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), vehicle.name) == wanted.end()) {
      continue;
    }
    text += (text.empty() ? "{" : ",\n ") + limit_of(vehicle);
  }
  std::printf("%s}\n", text.empty() ? "{" : text.c_str());
  return text.empty() ? 2 : 0;
}
