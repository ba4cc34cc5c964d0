// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/detail/intra_process.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "rclcpp/callback_group.hpp"

namespace rclcpp::detail {

namespace {
bool same(const rmw_gid_t& one, const rmw_gid_t& other) {
  return std::memcmp(one.data, other.data, sizeof(one.data)) == 0;
}
}  // namespace

IntraProcessReader::IntraProcessReader(const QoS& qos)
    : depth_(qos.depth()), reliable_(qos.reliability() == ReliabilityPolicy::Reliable) {}

void IntraProcessReader::set_group(std::weak_ptr<CallbackGroup> group) {
  const std::lock_guard<std::mutex> lock(mutex_);
  group_ = std::move(group);
}

void IntraProcessReader::put(Message message) {
  std::shared_ptr<CallbackGroup> group;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (messages_.size() == depth_) messages_.pop_front();
    messages_.push_back(std::move(message));
    empty_ = false;
    group = group_.lock();
  }
  if (group) group->wake_if_waiting();
}

IntraProcessReader::Message IntraProcessReader::take() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (messages_.empty()) return nullptr;
  Message first = std::move(messages_.front());
  messages_.pop_front();
  empty_ = messages_.empty();
  return first;
}

void IntraProcessTopic::add(const std::shared_ptr<IntraProcessReader>& reader) {
  const std::lock_guard<std::mutex> lock(mutex_);
  readers_.push_back(reader);
}

void IntraProcessTopic::add_publisher(const rmw_gid_t& gid) {
  const std::lock_guard<std::mutex> lock(mutex_);
  publishers_.push_back(gid);
}

void IntraProcessTopic::remove_publisher(const rmw_gid_t& gid) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto gone = std::find_if(publishers_.begin(), publishers_.end(),
                                 [&](const rmw_gid_t& ours) { return same(ours, gid); });
  if (gone != publishers_.end()) publishers_.erase(gone);
}

bool IntraProcessTopic::is_publisher(const rmw_gid_t& gid) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::any_of(publishers_.begin(), publishers_.end(),
                     [&](const rmw_gid_t& ours) { return same(ours, gid); });
}

std::vector<std::shared_ptr<IntraProcessReader>> IntraProcessTopic::readers(bool reliable) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto gone = std::remove_if(readers_.begin(), readers_.end(),
                                   [](const auto& reader) { return reader.expired(); });
  readers_.erase(gone, readers_.end());
  std::vector<std::shared_ptr<IntraProcessReader>> found;
  for (const auto& weak : readers_) {
    const auto reader = weak.lock();
    if (reader && (reliable || !reader->is_reliable())) found.push_back(reader);
  }
  return found;
}

std::shared_ptr<IntraProcessTopic> IntraProcessTopics::find(const std::string& topic,
                                                            std::type_index type) {
  const std::lock_guard<std::mutex> lock(mutex_);
  auto& found = topics_[{topic, type}];
  if (!found) found = std::make_shared<IntraProcessTopic>();
  return found;
}

void check_intra_process(const QoS& qos, const std::string& topic) {
  const char* wrong = nullptr;
  if (qos.history() != HistoryPolicy::KeepLast) wrong = "a history other than KeepLast";
  if (qos.depth() == 0) wrong = "a history of depth 0";
  if (qos.durability() != DurabilityPolicy::Volatile) wrong = "a durability other than volatile";
  if (wrong != nullptr) {
    throw std::invalid_argument("topic '" + topic + "' within the process: found " + wrong +
                                ", allowed volatile, KeepLast, depth 1 or more");
  }
}

}  // namespace rclcpp::detail
