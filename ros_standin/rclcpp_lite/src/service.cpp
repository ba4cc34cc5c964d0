// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/service.hpp"

#include <rcl/error_handling.h>
#include <rcutils/logging_macros.h>

#include "rcl_call.hpp"

namespace rclcpp {

ServiceBase::ServiceBase(std::shared_ptr<rcl_node_t> node, const std::string& name,
                         const rosidl_service_type_support_t& type, const rmw_qos_profile_t& qos)
    : node_(std::move(node)), service_(rcl_get_zero_initialized_service()) {
  auto options = rcl_service_get_default_options();
  options.qos = qos;
  detail::check(rcl_service_init(&service_, node_.get(), &type, name.c_str(), &options),
                "offer service '" + name + "'");
}

ServiceBase::~ServiceBase() {
  detail::complain(rcl_service_set_on_new_request_callback(&service_, nullptr, nullptr),
                   "leave a service alone");
  detail::complain(rcl_service_fini(&service_, node_.get()), "end a service");
}

void ServiceBase::set_group(const std::weak_ptr<CallbackGroup>& group) {
  arrivals_.set_group(group);
  detail::check(
      rcl_service_set_on_new_request_callback(&service_, &detail::Arrivals::come, &arrivals_),
      "be told of requests");
}

bool ServiceBase::take_request(rmw_request_id_t& id, void* request) {
  return arrivals_.take([&] {
    return detail::taken(rcl_take_request(&service_, &id, request), RCL_RET_SERVICE_TAKE_FAILED,
                         "take a request");
  });
}

void ServiceBase::send(rmw_request_id_t& id, void* response) {
  const auto code = rcl_send_response(&service_, &id, response);
  if (code == RCL_RET_TIMEOUT) {  // the client has gone
    RCUTILS_LOG_WARN_NAMED(rcl_node_get_logger_name(node_.get()),
                           "nobody takes the response of service %s", get_service_name());
    rcl_reset_error();
    return;
  }
  detail::check(code, std::string("answer on service '") + get_service_name() + "'");
}

}  // namespace rclcpp
