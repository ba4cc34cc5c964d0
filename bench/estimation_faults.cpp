// SPDX-License-Identifier: BSD-3-Clause
// Does the estimate know when it is wrong? Flies each fault of the campaign (bench/faults) with both
// vehicles and counts, while the vehicle is in the air: how often each state is outside its own
// 3 sigma, how long the true position error exceeds 15 m before the estimate reports that its position
// is unreliable, and the largest errors and banks. No logs.
//
// usage: estimation_faults [SEEDS]        (default 2)
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/constants.hpp"
#include "bench/estimate_error.hpp"
#include "bench/faults/cases.hpp"

namespace {

using namespace rosflight::flight;  // NOLINT(google-build-using-namespace): a program of one file
using rosflight::autonomy::StateEstimate;
using rosflight::base::kDegPerRad;
using rosflight::bench::in_sigmas;
using rosflight::bench::kStates;
using rosflight::bench::TruePast;
using rosflight::sim::Time;
using rosflight::sim::Vector3;

/// No fault, every fault of the campaign that a vehicle of this kind can have, and a pair.
std::vector<std::string> faults_of(bool fixed_wing) {
  std::vector<std::string> out{""};
  for (const auto& row : rosflight::bench::faults::fault_rows(fixed_wing)) out.push_back(row.text);
  out.push_back("gyro_step_x=0.02+gnss:20");
  return out;
}

/// Counts over a flight.
struct Count {
  std::uint64_t samples{};
  std::array<std::uint64_t, 9> outside{};
  double max_error_m{}, max_turn_deg{}, max_bank_deg{};
  double far_since_s{-1.0};  ///< The true position error has exceeded 15 m since then.
  bool far{};                ///< It once did.
  bool said_in_time{true};   ///< Whether the estimate reported it within 10 s, each time.
  bool said{};               ///< Whether it was reported at some time.
  std::string outcome;

  void look(Flight& flight, Time t, const TruePast& past, double fault_s) {
    if (flight.runner().stage() != Stage::kFly || !flight.autonomy().in_air) return;
    const auto& source = flight.estimate_source();
    if (!source.health().initialised) return;
    const StateEstimate e = source.estimate();
    const double now_s = rosflight::sim::to_seconds(t);
    constexpr double kStale_s = 0.1;  // of a cut link nobody sees the estimate
    if (now_s - e.t_s > kStale_s) return;
    const TruePast::Moment* then = past.at(e.t_s);
    if (then == nullptr) return;
    const auto& truth = flight.truth().body;
    const auto off = in_sigmas(e, *then);
    ++samples;
    for (std::size_t k = 0; k < kStates.size(); ++k) {
      outside[k] += std::abs(off(static_cast<Eigen::Index>(k))) > 3.0 ? 1U : 0U;
    }
    const double cosine = (truth.q_WB * Vector3::UnitZ()).z();
    max_bank_deg = std::max(max_bank_deg, kDegPerRad * std::acos(std::clamp(cosine, -1.0, 1.0)));
    if (now_s < fault_s) return;
    const double off_m = (e.p_W - then->seen_W).head<2>().norm();
    max_error_m = std::max(max_error_m, off_m);
    max_turn_deg = std::max(max_turn_deg, kDegPerRad * then->body.q_WB.angularDistance(e.q_WB));
    said = said || e.position_unreliable;
    if (off_m <= StateEstimate::kUnreliable_m || e.position_unreliable) {
      far_since_s = -1.0;
    } else if (far_since_s < 0.0) {
      far_since_s = now_s;
    }
    far = far || off_m > StateEstimate::kUnreliable_m;
    constexpr double kInTime_s = 10.0;
    if (far_since_s >= 0.0 && now_s - far_since_s > kInTime_s) said_in_time = false;
  }
};

Count fly(const std::string& vehicle, const std::string& fault, std::uint64_t seed) {
  FlightChoice choice;
  choice.vehicle = vehicle;
  choice.seed = seed;
  const double fault_s = vehicle == "anaconda" ? 80.0 : 20.0;
  for (std::size_t at = 0; at < fault.size();) {  // of a pair both
    const std::size_t end = std::min(fault.find('+', at), fault.size());
    std::string one = fault.substr(at, end - at);
    const std::size_t colon = one.find(':');
    const std::string lasts = colon == std::string::npos ? "" : one.substr(colon);
    choice.faults.push_back(one.substr(0, colon) + "@" + std::to_string(fault_s) + lasts);
    at = end + 1;
  }
  const FlightSetup setup(choice);
  const auto flight = std::make_unique<Flight>(setup);
  Count count;
  TruePast past;
  int step = 0;
  flight->set_script([&](Flight& f, Time t) {
    past.add(f, t);
    constexpr int kEvery = 20;
    if (++step % kEvery == 0) count.look(f, t, past, fault_s);
  });
  flight->run();
  count.outcome = outcome_name(flight->score().outcome);
  return count;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const int seeds = argc > 1 ? static_cast<int>(std::strtol(argv[1], nullptr, 10)) : 2;
    if (seeds < 1) throw std::invalid_argument("SEEDS is a number from 1");
    Count all;
    std::uint64_t far = 0, in_time = 0, nominal_said = 0;
    nlohmann::ordered_json json;
    for (const char* vehicle : {"multirotor", "anaconda"}) {
      for (const std::string& fault : faults_of(vehicle == std::string("anaconda"))) {
        for (int seed = 1; seed <= seeds; ++seed) {
          const Count c = fly(vehicle, fault, static_cast<std::uint64_t>(seed));
          all.samples += c.samples;
          std::string worst = "none";
          std::uint64_t most = 0;
          for (std::size_t k = 0; k < kStates.size(); ++k) {
            all.outside[k] += c.outside[k];
            if (c.outside[k] > most) worst = kStates[k];
            most = std::max(most, c.outside[k]);
          }
          far += c.far ? 1U : 0U;
          in_time += c.far && c.said_in_time ? 1U : 0U;
          if (fault.empty() && c.said) ++nominal_said;
          std::fprintf(stderr,
                       "%-10s %-26s seed %d %-18s position %6.1f m attitude %6.1f deg bank %5.1f "
                       "deg %s outside most: %s %.1f %%\n",
                       vehicle, fault.empty() ? "none" : fault.c_str(), seed, c.outcome.c_str(),
                       c.max_error_m, c.max_turn_deg, c.max_bank_deg,
                       c.said ? "unreliable" : "          ", worst.c_str(),
                       100.0 * static_cast<double>(most) /
                           static_cast<double>(std::max<std::uint64_t>(1, c.samples)));
        }
      }
    }
    double worst_share = 0.0;
    for (std::size_t k = 0; k < kStates.size(); ++k) {
      const double share = static_cast<double>(all.outside[k]) / static_cast<double>(all.samples);
      json[std::string("outside_") + kStates[k]] = share;
      worst_share = std::max(worst_share, share);
    }
    json["outside_worst"] = worst_share;
    json["far"] = far;
    json["said_in_time"] = in_time;
    json["said_in_time_share"] =
        far > 0 ? static_cast<double>(in_time) / static_cast<double>(far) : 1.0;
    json["nominal_said"] = nominal_said;
    std::cout << json.dump(1) << "\n";
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "estimation_faults: %s\n", e.what());
    return 1;
  }
}
