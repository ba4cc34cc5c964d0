// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as the three tables of a replay, with a form feed between them: refused with one line,
// or flown, with outputs that are numbers from 0 to 1.
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

#include "flight/replay/replay.hpp"

namespace {

using namespace rosflight::flight;  // NOLINT(google-build-using-namespace): a program of one file

constexpr std::size_t kOutputs = 14;

void check_outputs(const std::string& csv) {
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    for (std::size_t k = 0; k < kOutputs; ++k) {
      const std::size_t comma = line.rfind(',');
      const double value = std::stod(line.substr(comma + 1));
      if (!(value >= 0.0 && value <= 1.0)) std::abort();
      line.erase(comma);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream parts(std::string(data, data + size));
  std::string table, params, waivers;
  std::getline(parts, table, '\f');
  const bool has_params{std::getline(parts, params, '\f')};
  const bool has_waivers{std::getline(parts, waivers, '\f')};
  try {
    const ReplayInput input{CsvTable("table", table),
                            has_params ? std::make_unique<CsvTable>("params", params) : nullptr,
                            has_waivers ? std::make_unique<CsvTable>("waivers", waivers) : nullptr};
    check_outputs(replay(input, has_waivers).csv);
  } catch (const InputError& error) {
    if (std::string(error.what()).find('\n') != std::string::npos) std::abort();
  }
  return 0;
}
