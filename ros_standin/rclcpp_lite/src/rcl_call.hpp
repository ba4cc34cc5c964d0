// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "rclcpp/exceptions.hpp"

namespace rclcpp::detail {

/// Throws what rcl complained about; `doing` completes "could not ...".
inline void check(rcl_ret_t code, const std::string& doing) {
  if (code != RCL_RET_OK) exceptions::throw_from_rcl_error(code, doing);
}

/// For destructors: nobody is left to tell but the log.
void complain(rcl_ret_t code, const char* doing);

}  // namespace rclcpp::detail
