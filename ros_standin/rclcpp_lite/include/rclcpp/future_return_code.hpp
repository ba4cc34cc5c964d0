// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ostream>
#include <string>

namespace rclcpp {

enum class FutureReturnCode { SUCCESS, INTERRUPTED, TIMEOUT };

std::string to_string(FutureReturnCode code);
inline std::ostream& operator<<(std::ostream& out, FutureReturnCode code) {
  return out << to_string(code);
}

}  // namespace rclcpp
