// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/detail/wake_up.hpp"

#include <stdexcept>

#include "rcl_call.hpp"

namespace rclcpp::detail {

WakeUp::WakeUp(const Context::SharedPtr& context)
    : context_(context->get_rcl_context()), condition_(rcl_get_zero_initialized_guard_condition()) {
  if (!context_) throw std::runtime_error("rclcpp::init has not been called");
  check(rcl_guard_condition_init(&condition_, context_.get(),
                                 rcl_guard_condition_get_default_options()),
        "make a guard condition");
}

WakeUp::~WakeUp() {
  complain(rcl_guard_condition_fini(&condition_), "end a guard condition");
}

void WakeUp::trigger() {
  complain(rcl_trigger_guard_condition(&condition_), "wake an executor");
}

}  // namespace rclcpp::detail
