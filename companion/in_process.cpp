// SPDX-License-Identifier: BSD-3-Clause
#include "companion/in_process.hpp"

#include <algorithm>
#include <cstring>

namespace rosflight::companion {

InProcessLink::InProcessLink(std::size_t capacity_bytes) {
  to_fcu_.bytes.resize(capacity_bytes);
  to_companion_.bytes.resize(capacity_bytes);
}

void InProcessLink::plug(bool connected) {
  plugged_ = connected;
  to_fcu_.used = 0;
  to_companion_.used = 0;
}

bool InProcessLink::Queue::push(const std::uint8_t* data, std::size_t size) {
  if (size > bytes.size() - used) {
    ++dropped;
    return false;
  }
  const std::size_t tail = (head + used) % bytes.size();
  const std::size_t first = std::min(size, bytes.size() - tail);
  std::memcpy(bytes.data() + tail, data, first);
  std::memcpy(bytes.data(), data + first, size - first);
  used += size;
  return true;
}

std::size_t InProcessLink::Queue::pop(std::uint8_t* data, std::size_t capacity) {
  const std::size_t size = std::min(capacity, used);
  if (size == 0) {
    return 0;
  }
  const std::size_t first = std::min(size, bytes.size() - head);
  std::memcpy(data, bytes.data() + head, first);
  std::memcpy(data + first, bytes.data(), size - first);
  head = (head + size) % bytes.size();
  used -= size;
  return size;
}

std::size_t InProcessLink::End::read(std::uint8_t* data, std::size_t capacity) {
  return in_.pop(data, capacity);
}

bool InProcessLink::End::write(const std::uint8_t* data, std::size_t size, std::uint8_t /*qos*/) {
  return link_.plugged_ && out_.push(data, size);
}

}  // namespace rosflight::companion
