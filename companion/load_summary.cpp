// SPDX-License-Identifier: BSD-3-Clause
#include "companion/load_summary.hpp"

#include <algorithm>

namespace rosflight::companion {

std::string count_text(const LoadReport& report) {
  std::string text = std::to_string(report.entries.size()) + " parameters";
  const char* separator = ": ";
  for (int i = 0; i <= static_cast<int>(ParameterOutcome::kNoAnswer); ++i) {
    const auto outcome = static_cast<ParameterOutcome>(i);
    if (const std::size_t n = report.count(outcome); n > 0) {
      text += separator + std::to_string(n) + " " + outcome_name(outcome);
      separator = ", ";
    }
  }
  return text;
}

std::string load_summary(const LoadReport& report) {
  const auto bad = std::find_if(report.entries.begin(), report.entries.end(),
                                [](const ParameterResult& e) { return !e.ok(); });
  return count_text(report) + (bad == report.entries.end() ? "" : "; first: " + bad->text);
}

}  // namespace rosflight::companion
