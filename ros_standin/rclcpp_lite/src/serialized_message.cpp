// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/serialized_message.hpp"

#include <rcl/allocator.h>

#include <cstring>
#include <utility>

#include "rcl_call.hpp"

namespace rclcpp {

SerializedMessage::SerializedMessage(std::size_t capacity)
    : bytes_(rmw_get_zero_initialized_serialized_message()) {
  const auto allocator = rcl_get_default_allocator();
  detail::check(rmw_serialized_message_init(&bytes_, capacity, &allocator), "make a message");
}
SerializedMessage::SerializedMessage(const SerializedMessage& other)
    : SerializedMessage(other.size()) {
  if (other.size() > 0) std::memcpy(bytes_.buffer, other.bytes_.buffer, other.size());
  bytes_.buffer_length = other.size();
}
SerializedMessage::SerializedMessage(SerializedMessage&& other) noexcept
    : bytes_(std::exchange(other.bytes_, rmw_get_zero_initialized_serialized_message())) {}
SerializedMessage& SerializedMessage::operator=(const SerializedMessage& other) {
  return *this = SerializedMessage(other);
}
SerializedMessage& SerializedMessage::operator=(SerializedMessage&& other) noexcept {
  std::swap(bytes_, other.bytes_);
  return *this;
}
SerializedMessage::~SerializedMessage() {
  if (bytes_.allocator.deallocate != nullptr) {
    detail::complain(rmw_serialized_message_fini(&bytes_), "free a message");
  }
}
void SerializedMessage::reserve(std::size_t capacity) {
  detail::check(rmw_serialized_message_resize(&bytes_, capacity), "enlarge a message");
}

}  // namespace rclcpp
