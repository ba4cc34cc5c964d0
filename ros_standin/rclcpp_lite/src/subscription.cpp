// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/subscription.hpp"

#include "rcl_call.hpp"

namespace rclcpp {

SubscriptionBase::SubscriptionBase(std::shared_ptr<rcl_node_t> node, const std::string& topic,
                                   const rosidl_message_type_support_t& type, const QoS& qos,
                                   bool ignore_local_publications)
    : node_(std::move(node)), subscription_(rcl_get_zero_initialized_subscription()) {
  auto options = rcl_subscription_get_default_options();
  options.qos = qos.get_rmw_qos_profile();
  options.rmw_subscription_options.ignore_local_publications = ignore_local_publications;
  detail::check(rcl_subscription_init(&subscription_, node_.get(), &type, topic.c_str(), &options),
                "subscribe to topic '" + topic + "'");
}

SubscriptionBase::~SubscriptionBase() {
  detail::complain(rcl_subscription_set_on_new_message_callback(&subscription_, nullptr, nullptr),
                   "leave a topic alone");
  detail::complain(rcl_subscription_fini(&subscription_, node_.get()), "end a subscription");
}

void SubscriptionBase::set_group(const std::weak_ptr<CallbackGroup>& group) {
  if (reader_) reader_->set_group(group);
  arrivals_.set_group(group);
  detail::check(rcl_subscription_set_on_new_message_callback(&subscription_,
                                                             &detail::Arrivals::come, &arrivals_),
                "be told of messages");
}

void SubscriptionBase::join(std::shared_ptr<detail::IntraProcessTopic> topic) {
  const QoS qos = get_actual_qos();
  detail::check_intra_process(qos, get_topic_name());
  reader_ = std::make_shared<detail::IntraProcessReader>(qos);
  topic_ = std::move(topic);
  topic_->add(reader_);
}

std::size_t SubscriptionBase::get_publisher_count() const {
  std::size_t count = 0;
  detail::check(rcl_subscription_get_publisher_count(&subscription_, &count), "count publishers");
  return count;
}

QoS SubscriptionBase::get_actual_qos() const {
  const auto* const profile = rcl_subscription_get_actual_qos(&subscription_);
  if (profile == nullptr) {
    exceptions::throw_from_rcl_error(RCL_RET_ERROR, "read a subscription's QoS");
  }
  return QoS(QoSInitialization::from_rmw(*profile), *profile);
}

namespace {
bool taken(rcl_ret_t code) {
  return detail::taken(code, RCL_RET_SUBSCRIPTION_TAKE_FAILED, "take a message");
}
}  // namespace

bool SubscriptionBase::take_message(void* message, MessageInfo& info) {
  return arrivals_.take([&] {
    while (taken(rcl_take(&subscription_, message, &info.get_rmw_message_info(), nullptr))) {
      if (!topic_ || !topic_->is_publisher(info.get_rmw_message_info().publisher_gid)) return true;
    }
    return false;
  });
}

bool SubscriptionBase::take_bytes(rcl_serialized_message_t& bytes, MessageInfo& info) {
  return arrivals_.take([&] {
    return taken(
        rcl_take_serialized_message(&subscription_, &bytes, &info.get_rmw_message_info(), nullptr));
  });
}

}  // namespace rclcpp
