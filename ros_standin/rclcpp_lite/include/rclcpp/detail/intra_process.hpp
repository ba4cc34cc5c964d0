// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rmw/types.h>

#include <atomic>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <typeindex>
#include <utility>
#include <vector>

#include "rclcpp/qos.hpp"

namespace rclcpp {
class CallbackGroup;
}

namespace rclcpp::detail {

/// Messages of one process that a subscription has not taken yet, as pointers to what was published; the oldest go first when there
/// are more than its depth. Safe to use from several threads.
class IntraProcessReader {
 public:
  using Message = std::shared_ptr<const void>;
  explicit IntraProcessReader(const QoS& qos);
  /// Whose executor is woken. Null: none.
  void set_group(std::weak_ptr<CallbackGroup> group);
  void put(Message message);
  /// Null: there is none.
  Message take();
  bool is_empty() const { return empty_; }
  bool is_reliable() const { return reliable_; }

 private:
  const std::size_t depth_;
  const bool reliable_;
  std::atomic_bool empty_{true};
  std::mutex mutex_;
  std::deque<Message> messages_;
  std::weak_ptr<CallbackGroup> group_;
};

/// One topic with one type of message, between the publishers and subscriptions of a context that pass messages on as pointers.
class IntraProcessTopic {
 public:
  void add(const std::shared_ptr<IntraProcessReader>& reader);
  void add_publisher(const rmw_gid_t& gid);
  void remove_publisher(const rmw_gid_t& gid);
  /// Did one of these publishers send it? Then it has come as a pointer, too.
  bool is_publisher(const rmw_gid_t& gid) const;
  /// Subscriptions that take what a publisher of this reliability sends.
  std::vector<std::shared_ptr<IntraProcessReader>> readers(bool reliable) const;

 private:
  mutable std::mutex mutex_;
  mutable std::vector<std::weak_ptr<IntraProcessReader>> readers_;
  std::vector<rmw_gid_t> publishers_;
};

/// The topics of a context.
class IntraProcessTopics {
 public:
  std::shared_ptr<IntraProcessTopic> find(const std::string& topic, std::type_index type);

 private:
  std::mutex mutex_;
  std::map<std::pair<std::string, std::type_index>, std::shared_ptr<IntraProcessTopic>> topics_;
};

/// Throws std::invalid_argument as rclcpp 16 does: history must be KeepLast with a depth, durability volatile.
void check_intra_process(const QoS& qos, const std::string& topic);

}  // namespace rclcpp::detail
