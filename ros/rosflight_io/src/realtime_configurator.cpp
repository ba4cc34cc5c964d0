// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_io/realtime_configurator.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>

#include <charconv>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <system_error>

namespace rosflight_io {
namespace {

constexpr const char* kPolicyWord = "--policy:=";
constexpr const char* kPriorityWord = "--priority:=";

/// Text behind the prefix, if the word has it.
bool value_of(const std::string& word, const std::string& prefix, std::string& value) {
  if (word.rfind(prefix, 0) != 0) return false;
  value = word.substr(prefix.size());
  return true;
}

std::int64_t involuntary_switches() {
  rusage usage{};
  ::getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_nivcsw;
}

}  // namespace

RealtimeConfigurator::RealtimeConfigurator(int argc, const char* const* argv) {
  for (int k = 1; k < argc; ++k) read(argv[k]);
}

void RealtimeConfigurator::read(const std::string& word) {
  std::string value;
  if (word == "--realtime") {
    realtime_ = true;
  } else if (word == "--publish-context-switches") {
    publishes_ = true;
  } else if (value_of(word, kPolicyWord, value)) {
    if (value != "RR" && value != "FIFO")
      throw std::invalid_argument("--policy: found '" + value + "', allowed RR or FIFO");
    policy_ = value == "FIFO" ? Policy::kFifo : Policy::kRoundRobin;
  } else if (value_of(word, kPriorityWord, value)) {
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), priority_);
    const bool whole = error == std::errc{} && end == value.data() + value.size();
    if (!whole || priority_ < 1 || priority_ > 99)
      throw std::invalid_argument("--priority: found '" + value + "', allowed 1 to 99");
  }
}

void RealtimeConfigurator::apply() const {
  if (!realtime_) return;
  sched_param parameters{};
  parameters.sched_priority = priority_;
  const int policy = policy_ == Policy::kFifo ? SCHED_FIFO : SCHED_RR;
  const int refused = ::pthread_setschedparam(::pthread_self(), policy, &parameters);
  if (refused != 0) {
    throw std::runtime_error("--realtime: priority " + std::to_string(priority_) +
                             " refused: " + std::generic_category().message(refused) +
                             " (see rtprio in /etc/security/limits.conf)");
  }
}

RealtimeConfigurator::Watch RealtimeConfigurator::watch(rclcpp::Node& node) const {
  if (!publishes_) return {};
  Watch watch;
  watch.publisher = node.create_publisher<std_msgs::msg::Int32>(
      std::string(node.get_name()) + "/context_switches", 10);
  const auto before = std::make_shared<std::int64_t>(involuntary_switches());
  watch.timer = node.create_wall_timer(
      std::chrono::seconds(1), [publisher = watch.publisher, before] {  // const: rclcpp calls it so
        const std::int64_t now = involuntary_switches();
        std_msgs::msg::Int32 message;
        message.data = static_cast<std::int32_t>(now - *before);
        *before = now;
        publisher->publish(message);
      });
  return watch;
}

}  // namespace rosflight_io
