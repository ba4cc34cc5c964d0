// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <string_view>

namespace rosflight::flight {

/// The sources that this program was built from.
struct BuildInfo {
  std::string_view version;  ///< Such as "2.0.0".
  std::string_view commit;   ///< Hexadecimal; empty: not built in a Git checkout.
  bool changed{};            ///< Files differed from the commit.
};

const BuildInfo& build_info();
/// "rosflight 2.0.0, commit 899f7fbd3c21, changed since".
std::string build_info_text();

}  // namespace rosflight::flight
