// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcl/node.h>
#include <rcl/subscription.h>

#include <memory>
#include <rosidl_typesupport_cpp/message_type_support.hpp>
#include <string>
#include <type_traits>

#include "rclcpp/callback_group.hpp"
#include "rclcpp/detail/entity.hpp"
#include "rclcpp/detail/message_callback.hpp"
#include "rclcpp/macros.hpp"
#include "rclcpp/message_info.hpp"
#include "rclcpp/qos.hpp"
#include "rclcpp/serialized_message.hpp"

namespace rclcpp {

template <typename AllocatorT>
struct SubscriptionOptionsWithAllocator {
  CallbackGroup::SharedPtr callback_group;  ///< Null: the node's default group.
  bool ignore_local_publications{false};    ///< Nothing from publishers of the same participant.
};
using SubscriptionOptions = SubscriptionOptionsWithAllocator<std::allocator<void>>;

class SubscriptionBase : public detail::Entity {
 public:
  RCLCPP_SMART_PTR_ALIASES_ONLY(SubscriptionBase)
  SubscriptionBase(std::shared_ptr<rcl_node_t> node, const std::string& topic,
                   const rosidl_message_type_support_t& type, const QoS& qos,
                   bool ignore_local_publications);
  SubscriptionBase(const SubscriptionBase&) = delete;
  SubscriptionBase& operator=(const SubscriptionBase&) = delete;
  ~SubscriptionBase() override;

  const char* get_topic_name() const { return rcl_subscription_get_topic_name(&subscription_); }
  std::size_t get_publisher_count() const;
  QoS get_actual_qos() const;

  Kind kind() const override { return Kind::kSubscription; }
  void add_to(rcl_wait_set_t& set) override;
  bool is_ready(const rcl_wait_set_t& set) const override {
    return set.subscriptions[index_] != nullptr;
  }

 protected:
  /// False: there was nothing.
  bool take_message(void* message, MessageInfo& info);
  bool take_bytes(rcl_serialized_message_t& bytes, MessageInfo& info);

 private:
  std::shared_ptr<rcl_node_t> node_;
  rcl_subscription_t subscription_;
  std::size_t index_{0};
};

template <typename MessageT, typename AllocatorT = std::allocator<void>>
class Subscription : public SubscriptionBase {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Subscription)
  template <typename CallbackT>
  Subscription(std::shared_ptr<rcl_node_t> node, const std::string& topic, const QoS& qos,
               CallbackT&& callback, bool ignore_local_publications)
      : SubscriptionBase(std::move(node), topic,
                         *rosidl_typesupport_cpp::get_message_type_support_handle<MessageT>(), qos,
                         ignore_local_publications),
        callback_(std::forward<CallbackT>(callback)) {}

  /// For use without an executor. False: there was nothing.
  bool take(MessageT& message, MessageInfo& info) { return take_message(&message, info); }

  std::shared_ptr<void> take() override {
    auto sample = std::make_shared<Sample>();
    bool taken = false;
    if (callback_.wants_bytes()) {
      sample->bytes = std::make_shared<SerializedMessage>();
      taken = take_bytes(sample->bytes->get_rcl_serialized_message(), sample->info);
    } else {
      sample->message = std::make_shared<MessageT>();
      taken = take_message(sample->message.get(), sample->info);
    }
    return taken ? sample : nullptr;
  }
  void execute(std::shared_ptr<void> taken) override {
    auto& sample = *static_cast<Sample*>(taken.get());
    callback_(sample.message, sample.bytes, sample.info);
  }

 private:
  struct Sample {
    std::shared_ptr<MessageT> message;
    std::shared_ptr<SerializedMessage> bytes;
    MessageInfo info;
  };
  detail::MessageCallback<MessageT> callback_;
};

}  // namespace rclcpp
