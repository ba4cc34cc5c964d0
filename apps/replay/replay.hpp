// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "apps/replay/csv.hpp"

/// Recorded inputs through the real firmware, one main-loop pass per row (docs/replay.md).
namespace rosflight::apps {

struct ReplayOptions {
  std::string input;
  std::optional<std::string> params;
  std::optional<std::string> output;
  bool force{false};
  bool compare{false};
  std::optional<std::string> waivers;
};

/// Runs the whole command. Results go to `out`.
/// @returns 0, or 1 if a comparison failed. @throws InputError for bad input; nothing is written
/// then.
int replay(const ReplayOptions& options, std::ostream& out);

}  // namespace rosflight::apps
