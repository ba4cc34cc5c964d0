// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcl/node.h>
#include <rcl/publisher.h>

#include <chrono>
#include <memory>
#include <rosidl_typesupport_cpp/message_type_support.hpp>
#include <string>

#include "rclcpp/callback_group.hpp"
#include "rclcpp/detail/intra_process.hpp"
#include "rclcpp/intra_process_setting.hpp"
#include "rclcpp/macros.hpp"
#include "rclcpp/qos.hpp"
#include "rclcpp/serialized_message.hpp"

namespace rclcpp {

template <typename AllocatorT>
struct PublisherOptionsWithAllocator {
  CallbackGroup::SharedPtr callback_group;  ///< Without effect.
  IntraProcessSetting use_intra_process_comm{IntraProcessSetting::NodeDefault};
};
using PublisherOptions = PublisherOptionsWithAllocator<std::allocator<void>>;

class PublisherBase {
 public:
  RCLCPP_SMART_PTR_ALIASES_ONLY(PublisherBase)
  PublisherBase(std::shared_ptr<rcl_node_t> node, const std::string& topic,
                const rosidl_message_type_support_t& type, const QoS& qos);
  PublisherBase(const PublisherBase&) = delete;
  PublisherBase& operator=(const PublisherBase&) = delete;
  virtual ~PublisherBase();

  const char* get_topic_name() const { return rcl_publisher_get_topic_name(&publisher_); }
  std::size_t get_queue_size() const { return get_actual_qos().depth(); }
  std::size_t get_subscription_count() const;
  std::size_t get_intra_process_subscription_count() const { return readers().size(); }
  QoS get_actual_qos() const;
  bool can_loan_messages() const { return false; }
  /// Reliable only: true when every subscriber has all messages; false after the timeout (-1:
  /// none).
  bool wait_for_all_acked(std::chrono::nanoseconds timeout = std::chrono::nanoseconds(-1)) const;

 protected:
  /// Throws RCLError; does nothing after shutdown.
  void publish_bytes(const rcl_serialized_message_t& bytes);
  void publish_message(const void* message);
  /// Throws std::invalid_argument as check_intra_process does.
  void join(std::shared_ptr<detail::IntraProcessTopic> topic);
  bool is_intra_process() const { return topic_ != nullptr; }
  std::vector<std::shared_ptr<detail::IntraProcessReader>> readers() const;

 private:
  void check(rcl_ret_t code);
  std::shared_ptr<rcl_node_t> node_;
  rcl_publisher_t publisher_;
  std::shared_ptr<detail::IntraProcessTopic> topic_;  ///< Null: by the middleware only.
  rmw_gid_t gid_{};
  bool reliable_{false};
};

/// Safe to publish with from several threads. Subscriptions of the process get a pointer where both ask for it; the middleware sends
/// it if there are others.
template <typename MessageT, typename AllocatorT = std::allocator<void>>
class Publisher : public PublisherBase {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Publisher)
  /// @param topics  null: by the middleware only
  Publisher(std::shared_ptr<rcl_node_t> node, const std::string& topic, const QoS& qos,
            const std::shared_ptr<detail::IntraProcessTopics>& topics)
      : PublisherBase(std::move(node), topic,
                      *rosidl_typesupport_cpp::get_message_type_support_handle<MessageT>(), qos) {
    if (topics) join(topics->find(get_topic_name(), typeid(MessageT)));
  }
  void publish(const MessageT& message) {
    if (!is_intra_process()) return publish_message(&message);
    publish(std::make_unique<MessageT>(message));
  }
  void publish(std::unique_ptr<MessageT> message) {
    const auto within = readers();
    const std::shared_ptr<const MessageT> shared = std::move(message);
    for (const auto& reader : within) reader->put(shared);
    if (!is_intra_process() || get_subscription_count() > within.size())
      publish_message(shared.get());
  }
  void publish(const SerializedMessage& message) {
    publish_bytes(message.get_rcl_serialized_message());
  }
  void publish(const rcl_serialized_message_t& message) { publish_bytes(message); }
};

}  // namespace rclcpp
