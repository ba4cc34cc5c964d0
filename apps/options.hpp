// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

namespace rosflight::apps {

/// For CLI11: empty if `text` is a whole number without a sign, else what is wrong.
inline std::string whole_number(const std::string& text) {
  const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
  return digits ? std::string() : "found '" + text + "', allowed a whole number from 0";
}

}  // namespace rosflight::apps
