// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcl/domain_id.h>

#include <cstddef>

namespace rclcpp {

class InitOptions {
 public:
  bool auto_initialize_logging() const { return logging_; }
  InitOptions& auto_initialize_logging(bool on) {
    logging_ = on;
    return *this;
  }
  void set_domain_id(std::size_t id) { domain_id_ = id; }
  /// RCL_DEFAULT_DOMAIN_ID: what the environment says.
  std::size_t get_domain_id() const { return domain_id_; }
  bool shutdown_on_signal{true};

 private:
  bool logging_{true};
  std::size_t domain_id_{RCL_DEFAULT_DOMAIN_ID};
};

}  // namespace rclcpp
