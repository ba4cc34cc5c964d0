// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/publisher.hpp"

#include <rcl/context.h>
#include <rcl/error_handling.h>
#include <rmw/rmw.h>

#include <stdexcept>

#include "rcl_call.hpp"

namespace rclcpp {

PublisherBase::PublisherBase(std::shared_ptr<rcl_node_t> node, const std::string& topic,
                             const rosidl_message_type_support_t& type, const QoS& qos)
    : node_(std::move(node)), publisher_(rcl_get_zero_initialized_publisher()) {
  auto options = rcl_publisher_get_default_options();
  options.qos = qos.get_rmw_qos_profile();
  detail::check(rcl_publisher_init(&publisher_, node_.get(), &type, topic.c_str(), &options),
                "publish topic '" + topic + "'");
}

PublisherBase::~PublisherBase() {
  if (topic_) topic_->remove_publisher(gid_);
  detail::complain(rcl_publisher_fini(&publisher_, node_.get()), "end a publisher");
}

void PublisherBase::join(std::shared_ptr<detail::IntraProcessTopic> topic) {
  const QoS qos = get_actual_qos();
  detail::check_intra_process(qos, get_topic_name());
  detail::check(rmw_get_gid_for_publisher(rcl_publisher_get_rmw_handle(&publisher_), &gid_),
                "read a publisher's identity");
  reliable_ = qos.reliability() == ReliabilityPolicy::Reliable;
  topic_ = std::move(topic);
  topic_->add_publisher(gid_);
}

std::vector<std::shared_ptr<detail::IntraProcessReader>> PublisherBase::readers() const {
  if (!topic_) return {};
  return topic_->readers(reliable_);
}

std::size_t PublisherBase::get_subscription_count() const {
  std::size_t count = 0;
  const auto code = rcl_publisher_get_subscription_count(&publisher_, &count);
  if (code == RCL_RET_PUBLISHER_INVALID) {  // after shutdown there is nobody
    rcl_reset_error();
    return 0;
  }
  detail::check(code, "count subscriptions");
  return count;
}

QoS PublisherBase::get_actual_qos() const {
  const auto* const profile = rcl_publisher_get_actual_qos(&publisher_);
  if (profile == nullptr) exceptions::throw_from_rcl_error(RCL_RET_ERROR, "read a publisher's QoS");
  return QoS(QoSInitialization::from_rmw(*profile), *profile);
}

bool PublisherBase::wait_for_all_acked(std::chrono::nanoseconds timeout) const {
  const auto code = rcl_publisher_wait_for_all_acked(&publisher_, timeout.count());
  if (code == RCL_RET_TIMEOUT) return false;
  detail::check(code, "wait for acknowledgements");
  return true;
}

void PublisherBase::publish_message(const void* message) {
  check(rcl_publish(&publisher_, message, nullptr));
}

void PublisherBase::publish_bytes(const rcl_serialized_message_t& bytes) {
  if (topic_) {
    throw std::runtime_error(std::string("topic '") + get_topic_name() +
                             "' within the process: bytes are not passed on");
  }
  check(rcl_publish_serialized_message(&publisher_, &bytes, nullptr));
}

void PublisherBase::check(rcl_ret_t code) {
  if (code == RCL_RET_OK) return;
  if (code == RCL_RET_PUBLISHER_INVALID && rcl_publisher_is_valid_except_context(&publisher_)) {
    auto* const context = rcl_publisher_get_context(&publisher_);
    if (context != nullptr && !rcl_context_is_valid(context)) {
      rcl_reset_error();
      return;
    }
  }
  detail::check(code, std::string("publish on '") + get_topic_name() + "'");
}

}  // namespace rclcpp
