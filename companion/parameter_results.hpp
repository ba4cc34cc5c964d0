// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "companion/parameter.hpp"

namespace rosflight::companion {

enum class ParameterOutcome : std::uint8_t {
  kPending,
  kRead,       ///< The value was read.
  kUnchanged,  ///< Already had the requested value, confirmed by the FCU.
  kSet,        ///< Has the requested value now, confirmed by the FCU.
  kClamped,    ///< The FCU set another value than requested.
  kRefused,    ///< The FCU kept its value, or the number is no valid parameter value.
  kUnknown,    ///< The FCU has no such parameter.
  kWrongType,  ///< The parameter of the FCU has another type.
  kNoAnswer
};

/// A word for messages.
constexpr const char* outcome_name(ParameterOutcome outcome) {
  constexpr const char* kNames[] = {"pending", "read",    "unchanged",  "set",      "clamped",
                                    "refused", "unknown", "wrong type", "no answer"};
  return kNames[static_cast<std::size_t>(outcome)];
}

struct ParameterResult {
  std::string name;
  ParameterOutcome outcome{ParameterOutcome::kPending};
  double wanted{};                      ///< For sets.
  std::optional<ParameterValue> value;  ///< In force on the FCU at the end, if it was received.
  std::string text;                     ///< One line with name, outcome and reason.

  bool ok() const {
    return outcome == ParameterOutcome::kRead || outcome == ParameterOutcome::kUnchanged ||
           outcome == ParameterOutcome::kSet;
  }
};

/// The result of each value of a loaded set, in the order of the set.
struct LoadReport {
  std::vector<ParameterResult> entries;

  /// Number of values with that outcome.
  std::size_t count(ParameterOutcome outcome) const {
    return static_cast<std::size_t>(
        std::count_if(entries.begin(), entries.end(),
                      [outcome](const ParameterResult& e) { return e.outcome == outcome; }));
  }
  bool ok() const {
    return std::all_of(entries.begin(), entries.end(),
                       [](const ParameterResult& e) { return e.ok(); });
  }
};

}  // namespace rosflight::companion
