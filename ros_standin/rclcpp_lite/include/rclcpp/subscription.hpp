// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcl/node.h>
#include <rcl/subscription.h>

#include <memory>
#include <rosidl_typesupport_cpp/message_type_support.hpp>
#include <string>
#include <type_traits>

#include "rclcpp/callback_group.hpp"
#include "rclcpp/detail/arrivals.hpp"
#include "rclcpp/detail/entity.hpp"
#include "rclcpp/detail/intra_process.hpp"
#include "rclcpp/detail/message_callback.hpp"
#include "rclcpp/intra_process_setting.hpp"
#include "rclcpp/macros.hpp"
#include "rclcpp/message_info.hpp"
#include "rclcpp/qos.hpp"
#include "rclcpp/serialized_message.hpp"

namespace rclcpp {

template <typename AllocatorT>
struct SubscriptionOptionsWithAllocator {
  CallbackGroup::SharedPtr callback_group;  ///< Null: the node's default group.
  bool ignore_local_publications{false};    ///< Nothing from publishers of the same participant.
  IntraProcessSetting use_intra_process_comm{IntraProcessSetting::NodeDefault};
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
  bool has_work() const override { return arrivals_.any() || (reader_ && !reader_->is_empty()); }
  void set_group(const std::weak_ptr<CallbackGroup>& group) override;

 protected:
  /// Throws std::invalid_argument as check_intra_process does.
  void join(std::shared_ptr<detail::IntraProcessTopic> topic);
  /// A message of this process; null: there was none.
  detail::IntraProcessReader::Message take_own() { return reader_ ? reader_->take() : nullptr; }
  /// False: there was nothing.
  bool take_message(void* message, MessageInfo& info);
  bool take_bytes(rcl_serialized_message_t& bytes, MessageInfo& info);

 private:
  std::shared_ptr<rcl_node_t> node_;
  rcl_subscription_t subscription_;
  detail::Arrivals arrivals_;
  std::shared_ptr<detail::IntraProcessTopic> topic_;  ///< Null: by the middleware only.
  std::shared_ptr<detail::IntraProcessReader> reader_;
};

template <typename MessageT, typename AllocatorT = std::allocator<void>>
class Subscription : public SubscriptionBase {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Subscription)
  /// @param topics  null: by the middleware only
  template <typename CallbackT>
  Subscription(std::shared_ptr<rcl_node_t> node, const std::string& topic, const QoS& qos,
               CallbackT&& callback, bool ignore_local_publications,
               const std::shared_ptr<detail::IntraProcessTopics>& topics)
      : SubscriptionBase(std::move(node), topic,
                         *rosidl_typesupport_cpp::get_message_type_support_handle<MessageT>(), qos,
                         ignore_local_publications),
        callback_(std::forward<CallbackT>(callback)) {
    if (topics && !callback_.wants_bytes()) join(topics->find(get_topic_name(), typeid(MessageT)));
  }

  /// For use without an executor. False: there was nothing.
  bool take(MessageT& message, MessageInfo& info) { return take_message(&message, info); }

  std::shared_ptr<void> take() override {
    auto sample = std::make_shared<Sample>();
    if (const auto own = take_own()) {
      sample->message = std::static_pointer_cast<const MessageT>(own);
      sample->info.get_rmw_message_info().from_intra_process = true;
      return sample;
    }
    bool taken = false;
    if (callback_.wants_bytes()) {
      sample->bytes = std::make_shared<SerializedMessage>();
      taken = take_bytes(sample->bytes->get_rcl_serialized_message(), sample->info);
    } else {
      const auto message = std::make_shared<MessageT>();
      sample->message = message;
      taken = take_message(message.get(), sample->info);
    }
    return taken ? sample : nullptr;
  }
  void execute(std::shared_ptr<void> taken) override {
    auto& sample = *static_cast<Sample*>(taken.get());
    if (callback_.wants_its_own() && sample.info.get_rmw_message_info().from_intra_process)
      sample.message = std::make_shared<MessageT>(*sample.message);
    callback_(std::const_pointer_cast<MessageT>(sample.message), sample.bytes, sample.info);
  }

 private:
  struct Sample {
    std::shared_ptr<const MessageT> message;
    std::shared_ptr<SerializedMessage> bytes;
    MessageInfo info;
  };
  detail::MessageCallback<MessageT> callback_;
};

}  // namespace rclcpp
