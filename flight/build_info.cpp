// SPDX-License-Identifier: BSD-3-Clause
#include "flight/build_info.hpp"

#include "flight/build_info_values.hpp"

namespace rosflight::flight {

const BuildInfo& build_info() {
  return kBuildInfo;
}

std::string build_info_text() {
  constexpr std::size_t kDigits = 12;
  std::string text = "rosflight " + std::string(kBuildInfo.version);
  if (kBuildInfo.commit.empty()) return text;
  text += ", commit " + std::string(kBuildInfo.commit.substr(0, kDigits));
  return kBuildInfo.changed ? text + ", changed since" : text;
}

}  // namespace rosflight::flight
