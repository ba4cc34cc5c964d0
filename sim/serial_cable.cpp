// SPDX-License-Identifier: BSD-3-Clause
#include "sim/serial_cable.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>

#include "sim/portable_math.hpp"

namespace rosflight::sim {
namespace {
constexpr std::int64_t kMicrosecondsPerSecond = 1'000'000;

const SerialLine::Config& checked(const SerialLine::Config& c) {
  if (c.baud == 0 || c.frame_bits == 0) {
    throw std::invalid_argument("serial line: baud and frame_bits must be above 0");
  }
  const auto& transmit = c.transmit_capacity_bytes;
  if (std::find(transmit.begin(), transmit.end(), 0U) != transmit.end() ||
      c.receive_capacity_bytes == 0) {
    throw std::invalid_argument("serial line: a queue of 0 bytes");
  }
  const bool is_probability = c.corruption_per_byte >= 0.0 && c.corruption_per_byte <= 1.0;
  if (!is_probability) {
    throw std::invalid_argument("serial line: corruption_per_byte " +
                                std::to_string(c.corruption_per_byte) + " is not in 0..1");
  }
  return c;
}

/// ln(1 - p). A probability of 1 has no logarithm; -700 makes every gap 0.
double log_intact(double corruption_per_byte) {
  return corruption_per_byte < 1.0 ? portable::log(1.0 - corruption_per_byte) : -700.0;
}
}  // namespace

void ByteRing::put(const std::uint8_t* data, std::size_t count) {
  std::size_t end = first_ + size_;
  if (end >= bytes_.size()) end -= bytes_.size();
  const std::size_t run = std::min(count, bytes_.size() - end);
  std::memcpy(bytes_.data() + end, data, run);
  if (count > run) std::memcpy(bytes_.data(), data + run, count - run);
  size_ += count;
}

void ByteRing::take(std::uint8_t* data, std::size_t count) {
  const std::size_t run = std::min(count, bytes_.size() - first_);
  if (data != nullptr) {
    std::memcpy(data, bytes_.data() + first_, run);
    if (count > run) std::memcpy(data + run, bytes_.data(), count - run);
  }
  first_ += count;
  if (first_ >= bytes_.size()) first_ -= bytes_.size();
  size_ -= count;
}

SerialLine::SerialLine(const Config& config, RandomStream stream)
    : byte_cost_{kMicrosecondsPerSecond * checked(config).frame_bits},
      baud_{config.baud},
      classes_{Class{config.transmit_capacity_bytes[0]}, Class{config.transmit_capacity_bytes[1]},
               Class{config.transmit_capacity_bytes[2]}},
      received_{config.receive_capacity_bytes},
      log_intact_{log_intact(config.corruption_per_byte)},
      stream_{stream} {
  draw_next_corruption();
}

bool SerialLine::push(Time now, const std::uint8_t* data, std::size_t size, std::uint8_t qos) {
  advance(now);
  Class& queue = classes_[class_of(qos)];
  if (size == 0 || size > queue.bytes.room()) {
    ++counters_.frames_dropped[class_of(qos)];
    return false;
  }
  queue.bytes.put(data, size);
  std::size_t end = queue.first + queue.frames;
  if (end >= queue.sizes.size()) end -= queue.sizes.size();
  queue.sizes[end] = static_cast<std::uint32_t>(size);
  ++queue.frames;
  if (remaining_ == 0) start_next_frame();
  return true;
}

bool SerialLine::start_next_frame() {
  for (std::size_t i = 0; i < kClasses; ++i) {
    Class& queue = classes_[i];
    if (queue.frames == 0) continue;
    sending_ = i;
    remaining_ = queue.sizes[queue.first];
    if (++queue.first == queue.sizes.size()) queue.first = 0;
    --queue.frames;
    return true;
  }
  return false;
}

void SerialLine::advance(Time now) {
  if (now <= last_) return;
  const std::int64_t elapsed_us = (now - last_).count();
  last_ = now;
  if (remaining_ == 0) return;
  // What all queues hold is through long before this limit; it keeps the product below 2^63.
  const std::int64_t limit_us = std::numeric_limits<std::int64_t>::max() / (2 * baud_);
  const std::int64_t budget = std::min(elapsed_us, limit_us) * baud_ + spent_;
  auto bytes = static_cast<std::size_t>(budget / byte_cost_);
  spent_ = budget % byte_cost_;
  while (bytes > 0 && remaining_ > 0) {
    const std::size_t run = std::min(bytes, remaining_);
    deliver(run);
    bytes -= run;
    remaining_ -= run;
    if (remaining_ == 0) {
      ++counters_.frames_sent;
      start_next_frame();
    }
  }
  if (remaining_ == 0) spent_ = 0;  // The wire went idle: the next byte starts when it is pushed.
}

void SerialLine::deliver(std::size_t count) {
  ByteRing& source = classes_[sending_].bytes;
  counters_.bytes_sent += count;
  if (cut_) {
    counters_.bytes_vanished += count;
    source.take(nullptr, count);
    return;
  }
  std::array<std::uint8_t, 256> chunk{};
  while (count > 0) {
    const std::size_t run = std::min(count, chunk.size());
    source.take(chunk.data(), run);
    if (log_intact_ != 0.0) corrupt(chunk.data(), run);
    const std::size_t accepted = std::min(run, received_.room());
    received_.put(chunk.data(), accepted);
    counters_.bytes_overrun += run - accepted;
    count -= run;
  }
}

void SerialLine::corrupt(std::uint8_t* data, std::size_t count) {
  std::size_t at = 0;
  while (until_corruption_ < count - at) {
    at += static_cast<std::size_t>(until_corruption_);
    data[at] = static_cast<std::uint8_t>(data[at] ^ (1U << (stream_.bits() >> 61U)));
    ++counters_.bytes_corrupted;
    ++at;
    draw_next_corruption();
  }
  until_corruption_ -= count - at;
}

/// Independent bytes of probability p have gaps of geometric law: floor(ln u / ln(1 - p)).
void SerialLine::draw_next_corruption() {
  constexpr double kNever = 9.0e18;
  if (log_intact_ == 0.0) return;
  const double gap = portable::log(1.0 - stream_.uniform()) / log_intact_;
  until_corruption_ = static_cast<std::uint64_t>(std::min(gap, kNever));
}

void SerialLine::set_corruption(double per_byte) {
  log_intact_ = log_intact(per_byte);
  draw_next_corruption();
}

std::size_t SerialLine::pop(Time now, std::uint8_t* data, std::size_t capacity) {
  advance(now);
  const std::size_t count = std::min(capacity, received_.size());
  if (count > 0) received_.take(data, count);
  return count;
}

std::size_t SerialLine::queued() const {
  std::size_t sum = 0;
  for (const Class& queue : classes_) sum += queue.bytes.size();
  return sum;
}

}  // namespace rosflight::sim
