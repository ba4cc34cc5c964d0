// SPDX-License-Identifier: BSD-3-Clause
#include "companion/version.hpp"

#include <charconv>

namespace rosflight::companion {

std::optional<MajorMinor> parse_version(std::string_view text) {
  if (!text.empty() && (text.front() == 'v' || text.front() == 'V')) {
    text.remove_prefix(1);
  }
  // from_chars would take a sign.
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  MajorMinor result;
  const char* const begin = text.data();
  const char* const end = begin + text.size();
  if (text.empty() || !is_digit(text.front())) {
    return std::nullopt;
  }
  const auto major = std::from_chars(begin, end, result.major);
  if (major.ec != std::errc{} || end - major.ptr < 2 || *major.ptr != '.' ||
      !is_digit(major.ptr[1])) {
    return std::nullopt;
  }
  const auto minor = std::from_chars(major.ptr + 1, end, result.minor);
  if (minor.ec != std::errc{}) {
    return std::nullopt;
  }
  return result;
}

VersionMatch compare_versions(std::string_view companion, std::string_view fcu) {
  const auto ours = parse_version(companion);
  const auto theirs = parse_version(fcu);
  if (!ours || !theirs) {
    return VersionMatch::kUnreadable;
  }
  return *ours == *theirs ? VersionMatch::kSame : VersionMatch::kDiffers;
}

}  // namespace rosflight::companion
