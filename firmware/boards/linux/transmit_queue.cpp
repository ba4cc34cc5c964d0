// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/linux/transmit_queue.hpp"

#include <algorithm>

namespace rosflight::boards {
namespace {
constexpr std::size_t kHeader = 2;
}

TransmitQueue::TransmitQueue(std::size_t capacity) : capacity_{capacity} {
  // Frames of one byte each need the most room for sizes.
  for (Class& c : classes_) c.ring.resize((1 + kHeader) * capacity);
}

void TransmitQueue::put(Class& c, const std::uint8_t* data, std::size_t count) {
  const std::size_t start = (c.first + c.used) % c.ring.size();
  const std::size_t head = std::min(count, c.ring.size() - start);
  std::copy_n(data, head, c.ring.data() + start);
  std::copy_n(data + head, count - head, c.ring.data());
  c.used += count;
}

void TransmitQueue::peek(const Class& c, std::uint8_t* data, std::size_t count, std::size_t skip) {
  const std::size_t start = (c.first + skip) % c.ring.size();
  const std::size_t head = std::min(count, c.ring.size() - start);
  std::copy_n(c.ring.data() + start, head, data);
  std::copy_n(c.ring.data(), count - head, data + head);
}

bool TransmitQueue::push(const std::uint8_t* data, std::size_t size, std::uint8_t qos) {
  if (size == 0 || size > kMaxFrame || size > room()) return false;
  Class& c = classes_[hal::Serial::class_of(qos)];
  const std::array<std::uint8_t, kHeader> header{static_cast<std::uint8_t>(size & 0xFFU),
                                                 static_cast<std::uint8_t>(size >> 8U)};
  put(c, header.data(), header.size());
  put(c, data, size);
  size_ += size;
  return true;
}

std::size_t TransmitQueue::take(std::uint8_t* data, std::size_t capacity) {
  std::size_t taken = 0;
  for (Class& c : classes_) {
    while (c.used > 0) {
      std::array<std::uint8_t, kHeader> header{};
      peek(c, header.data(), kHeader, 0);
      const std::size_t size = header[0] + (static_cast<std::size_t>(header[1]) << 8U);
      if (size > capacity - taken) return taken;
      peek(c, data + taken, size, kHeader);
      c.first = (c.first + kHeader + size) % c.ring.size();
      c.used -= kHeader + size;
      size_ -= size;
      taken += size;
    }
  }
  return taken;
}

void TransmitQueue::clear() {
  for (Class& c : classes_) c.first = c.used = 0;
  size_ = 0;
}

}  // namespace rosflight::boards
