// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string_view>

#include "companion/events.hpp"

namespace rosflight::companion {

struct MajorMinor {
  int major{};
  int minor{};
  friend bool operator==(const MajorMinor&, const MajorMinor&) = default;
};

/// Reads the first two numbers of "v2.0.1-12-gabcdef12" or "2.0"; nothing if the text does not
/// start so.
std::optional<MajorMinor> parse_version(std::string_view text);

/// Same major and minor: the two ends were made for each other.
VersionMatch compare_versions(std::string_view companion, std::string_view fcu);

}  // namespace rosflight::companion
