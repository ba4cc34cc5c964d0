// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <rcl/error_handling.h>

#include <string>

#include "rclcpp/exceptions.hpp"

namespace rclcpp::detail {

/// Throws what rcl complained about; `doing` completes "could not ...".
inline void check(rcl_ret_t code, const std::string& doing) {
  if (code != RCL_RET_OK) exceptions::throw_from_rcl_error(code, doing);
}

/// After a take: false when rcl had nothing, which is what `nothing` says; throws as check.
inline bool taken(rcl_ret_t code, rcl_ret_t nothing, const char* doing) {
  if (code == nothing) {
    rcl_reset_error();
    return false;
  }
  check(code, doing);
  return true;
}

/// For destructors: nobody is left to tell but the log.
void complain(rcl_ret_t code, const char* doing);

}  // namespace rclcpp::detail
