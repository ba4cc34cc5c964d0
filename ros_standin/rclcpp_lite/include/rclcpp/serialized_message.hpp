// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcl/types.h>

#include <cstddef>

namespace rclcpp {

/// The bytes of a message as the middleware sends them.
class SerializedMessage {
 public:
  explicit SerializedMessage(std::size_t capacity = 0);
  SerializedMessage(const SerializedMessage& other);
  SerializedMessage(SerializedMessage&& other) noexcept;
  SerializedMessage& operator=(const SerializedMessage& other);
  SerializedMessage& operator=(SerializedMessage&& other) noexcept;
  virtual ~SerializedMessage();
  rcl_serialized_message_t& get_rcl_serialized_message() { return bytes_; }
  const rcl_serialized_message_t& get_rcl_serialized_message() const { return bytes_; }
  std::size_t size() const { return bytes_.buffer_length; }
  std::size_t capacity() const { return bytes_.buffer_capacity; }
  void reserve(std::size_t capacity);

 private:
  rcl_serialized_message_t bytes_;
};

}  // namespace rclcpp
