// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/time.hpp"

#include <rcl/time.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace rclcpp {

namespace {
constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr auto kMax = std::numeric_limits<std::int64_t>::max();

std::int64_t sum(std::int64_t left, std::int64_t right) {
  std::int64_t result = 0;
  if (__builtin_add_overflow(left, right, &result)) {
    throw std::overflow_error("sum of times does not fit into 64 bits of nanoseconds");
  }
  return result;
}

std::int64_t difference(std::int64_t left, std::int64_t right) {
  std::int64_t result = 0;
  if (__builtin_sub_overflow(left, right, &result)) {
    throw std::overflow_error("difference of times does not fit into 64 bits of nanoseconds");
  }
  return result;
}

/// Whole seconds rounded down and the rest, as messages hold them.
template <typename Message>
Message split(std::int64_t nanoseconds) {
  auto seconds = nanoseconds / kNanosecondsPerSecond;
  auto rest = nanoseconds % kNanosecondsPerSecond;
  if (rest < 0) {
    rest += kNanosecondsPerSecond;
    --seconds;
  }
  Message message;
  if (seconds > std::numeric_limits<std::int32_t>::max()) {
    seconds = std::numeric_limits<std::int32_t>::max();
    rest = std::numeric_limits<std::uint32_t>::max();
  } else if (seconds < std::numeric_limits<std::int32_t>::min()) {
    seconds = std::numeric_limits<std::int32_t>::min();
    rest = 0;
  }
  message.sec = static_cast<std::int32_t>(seconds);
  message.nanosec = static_cast<std::uint32_t>(rest);
  return message;
}

std::int64_t joined(std::int32_t seconds, std::uint32_t nanoseconds) {
  return std::int64_t{seconds} * kNanosecondsPerSecond + nanoseconds;
}

Duration of(std::int64_t nanoseconds) {
  return Duration::from_nanoseconds(nanoseconds);
}
}  // namespace

Duration::Duration(std::int32_t seconds, std::uint32_t nanoseconds)
    : rcl_duration_{joined(seconds, nanoseconds)} {}
Duration::Duration(std::chrono::nanoseconds nanoseconds) : rcl_duration_{nanoseconds.count()} {}
Duration::Duration(const builtin_interfaces::msg::Duration& message)
    : rcl_duration_{joined(message.sec, message.nanosec)} {}
Duration::Duration(const rcl_duration_t& duration) : rcl_duration_(duration) {}

Duration& Duration::operator=(const builtin_interfaces::msg::Duration& message) {
  return *this = Duration(message);
}
Duration::operator builtin_interfaces::msg::Duration() const {
  return split<builtin_interfaces::msg::Duration>(ns());
}

Duration Duration::operator+(const Duration& other) const {
  return of(sum(ns(), other.ns()));
}
Duration Duration::operator-(const Duration& other) const {
  return of(difference(ns(), other.ns()));
}
Duration Duration::operator*(double scale) const {
  if (!std::isfinite(scale)) throw std::runtime_error("a duration times no finite number");
  const auto product = static_cast<long double>(ns()) * static_cast<long double>(scale);
  if (std::fabs(product) >= static_cast<long double>(kMax)) {
    throw std::overflow_error("product of a duration does not fit into 64 bits of nanoseconds");
  }
  return of(static_cast<std::int64_t>(product));
}

Duration Duration::max() {
  return Duration(std::numeric_limits<std::int32_t>::max(), 999'999'999);
}
Duration Duration::from_seconds(double seconds) {
  return of(static_cast<std::int64_t>(std::llround(seconds * 1e9)));
}
Duration Duration::from_nanoseconds(rcl_duration_value_t nanoseconds) {
  return Duration(rcl_duration_t{nanoseconds});
}
Duration Duration::from_rmw_time(rmw_time_t duration) {
  constexpr auto kMaxSeconds = static_cast<std::uint64_t>(kMax / kNanosecondsPerSecond);
  if (duration.sec >= kMaxSeconds) return of(kMax);
  return of(static_cast<std::int64_t>(duration.sec) * kNanosecondsPerSecond +
            static_cast<std::int64_t>(duration.nsec));
}
double Duration::seconds() const {
  return static_cast<double>(ns()) * 1e-9;
}
rmw_time_t Duration::to_rmw_time() const {
  if (ns() < 0) throw std::runtime_error("the middleware takes no negative duration");
  return {static_cast<std::uint64_t>(ns() / kNanosecondsPerSecond),
          static_cast<std::uint64_t>(ns() % kNanosecondsPerSecond)};
}

Time::Time(std::int32_t seconds, std::uint32_t nanoseconds, rcl_clock_type_t type)
    : rcl_time_{joined(seconds, nanoseconds), type} {
  if (seconds < 0) throw std::runtime_error("a time before zero");
}
Time::Time(std::int64_t nanoseconds, rcl_clock_type_t type) : rcl_time_{nanoseconds, type} {}
Time::Time(const builtin_interfaces::msg::Time& message, rcl_clock_type_t type)
    : Time(message.sec, message.nanosec, type) {}

Time& Time::operator=(const builtin_interfaces::msg::Time& message) {
  return *this = Time(message);
}
Time::operator builtin_interfaces::msg::Time() const {
  if (nanoseconds() < 0) throw std::runtime_error("no message holds a time before zero");
  return split<builtin_interfaces::msg::Time>(nanoseconds());
}

void Time::must_match(const Time& other) const {
  if (get_clock_type() != other.get_clock_type()) {
    throw std::runtime_error("times of different clocks do not mix: clock types " +
                             std::to_string(get_clock_type()) + " and " +
                             std::to_string(other.get_clock_type()));
  }
}
bool Time::operator==(const Time& other) const {
  must_match(other);
  return nanoseconds() == other.nanoseconds();
}
bool Time::operator<(const Time& other) const {
  must_match(other);
  return nanoseconds() < other.nanoseconds();
}
Time Time::operator+(const Duration& span) const {
  return Time(sum(nanoseconds(), span.nanoseconds()), get_clock_type());
}
Time Time::operator-(const Duration& span) const {
  return Time(difference(nanoseconds(), span.nanoseconds()), get_clock_type());
}
Duration Time::operator-(const Time& other) const {
  must_match(other);
  return of(difference(nanoseconds(), other.nanoseconds()));
}
Time Time::max() {
  return Time(std::numeric_limits<std::int32_t>::max(), 999'999'999);
}
double Time::seconds() const {
  return static_cast<double>(nanoseconds()) * 1e-9;
}
Time operator+(const Duration& span, const Time& time) {
  return time + span;
}

}  // namespace rclcpp
