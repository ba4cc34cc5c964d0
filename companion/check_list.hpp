// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cstdint>
#include <map>
#include <variant>

#include "companion/events.hpp"
#include "companion/time.hpp"

namespace rosflight::companion {

/// The firmware's checks before arming: the newest line of each row, and when it arrived. Request them by
/// Session::request_report(), and add the events of the session.
class CheckList {
 public:
  struct Line {
    Time time{};
    link::CheckResult result;
  };

  /// An event of another kind changes nothing. @returns whether it was the last row, and none is missing.
  bool add(Time now, const Event& event) {
    const auto* line = std::get_if<link::CheckResult>(&event);
    if (line == nullptr) return false;
    lines_[line->index] = {now, *line};
    return complete() && line->index + 1 == line->count;
  }
  /// It has every row.
  bool complete() const {
    return !lines_.empty() && lines_.size() == lines_.begin()->second.result.count;
  }
  /// It has every row, and none of them refuses arming.
  bool ready() const {
    return complete() && std::all_of(lines_.begin(), lines_.end(), [](const auto& line) {
             return line.second.result.result ==
                        static_cast<std::uint8_t>(link::CheckOutcome::kPass) ||
                    line.second.result.result ==
                        static_cast<std::uint8_t>(link::CheckOutcome::kWarning);
           });
  }
  /// By index.
  const std::map<std::uint8_t, Line>& lines() const { return lines_; }

 private:
  std::map<std::uint8_t, Line> lines_;
};

}  // namespace rosflight::companion
