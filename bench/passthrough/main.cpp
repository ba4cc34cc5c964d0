// SPDX-License-Identifier: BSD-3-Clause
// Roll follows a triangle wave by attitude loops of the companion, which command in pass-through at the rate of the
// attitude, on a board.
//
//     board_passthrough BOARD [--link usb] [--attitude firmware] [--seconds S] [--csv FILE]
//
// BOARD: in_process, or one with an emulated chip. With `--attitude firmware` the firmware's filter does without the
// attitude that the companion estimates. Prints one JSON object; all errors are those of the true roll
// of the simulated vehicle.
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/passthrough/passthrough_flight.hpp"

namespace {

using namespace rosflight::bench::passthrough;  // NOLINT(google-build-using-namespace)

constexpr const char* kUsage =
    "usage: board_passthrough BOARD [--link usb] [--attitude firmware] [--seconds S] [--csv FILE]";

void write_csv(const std::string& name, const std::vector<Row>& rows) {
  std::FILE* const file = std::fopen(name.c_str(), "w");
  if (file == nullptr) throw std::runtime_error(name + ": cannot be written");
  std::fprintf(file, "time_s,set_roll_deg,true_roll_deg,estimated_roll_deg\n");
  for (const Row& row : rows) {
    std::fprintf(file, "%.4f,%.4f,%.4f,%.4f\n", row.t_s, row.set_deg, row.true_deg,
                 row.estimated_deg);
  }
  if (std::fclose(file) != 0) throw std::runtime_error(name + ": cannot be written");
}

int run(const std::vector<std::string>& words) {
  if (words.empty() || words.size() % 2 == 0) throw std::runtime_error(kUsage);
  PassthroughPlan plan;
  plan.board = words[0];
  std::string csv;
  for (std::size_t k = 1; k + 1 < words.size(); k += 2) {
    if (words[k] == "--link") {
      plan.link = words[k + 1];
    } else if (words[k] == "--attitude" && words[k + 1] == "firmware") {
      plan.shares_attitude = false;
    } else if (words[k] == "--seconds") {
      plan.duration_s = std::stod(words[k + 1]);
    } else if (words[k] == "--csv") {
      csv = words[k + 1];
    } else {
      throw std::runtime_error(kUsage);
    }
  }
  constexpr double kMaxDuration_s = 300.0;
  const bool allowed = plan.duration_s >= 1.0 && plan.duration_s <= kMaxDuration_s;
  if (!allowed)
    throw std::runtime_error("--seconds: found " + std::to_string(plan.duration_s) +
                             ", allowed 1 to 300");
  const PassthroughResult flown = fly_passthrough(plan);
  const Following following = judge(flown.rows);
  if (!csv.empty()) write_csv(csv, flown.rows);
  std::cout << nlohmann::ordered_json{{"board", plan.board},
                                      {"link", plan.link},
                                      {"seconds", plan.duration_s},
                                      {"roll_rms_deg", following.rms_deg},
                                      {"roll_max_deg", following.max_deg},
                                      {"roll_estimated_rms_deg", following.estimated_rms_deg},
                                      {"lag_ms", 1e3 * following.lag_s},
                                      {"roll_rms_without_lag_deg", following.rms_without_lag_deg},
                                      {"commands_hz", flown.commands_hz},
                                      {"attitudes_hz", flown.attitudes_hz},
                                      {"dropped", flown.dropped},
                                      {"height_min_m", flown.height_min_m},
                                      {"height_max_m", flown.height_max_m}}
                   .dump()
            << "\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::cerr << "board_passthrough: " << error.what() << "\n";
    return 1;
  }
}
