// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cstring>

#include "firmware/boards/qemu_m7/exchange_block.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::m7 {

/// The serial port of lock-step: bytes come and go with the exchange block, and the cable's queues
/// outside decide what is taken. The board keeps account of their room, so that write() and
/// writable() answer as the cable would.
class BlockSerial final : public hal::Serial {
 public:
  explicit BlockSerial(ExchangeBlock& block) : block_{block} {}

  /// A new block is there.
  void begin() {
    const ToProcessor& in = block_.to_processor;
    taken_ = 0;
    available_ = std::min<std::size_t>(in.link_count, in.link.size());
    room_ = in.room;
    block_.from_processor.link_count = 0;
    block_.from_processor.link_overflow = 0;
  }

  bool open(std::uint32_t /*baud*/, std::uint8_t /*device*/) override { return true; }

  bool write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) override {
    FromProcessor& out = block_.from_processor;
    if (size > 0xFFFFu || out.link_count + FromProcessor::kFrameHeader + size > out.link.size()) {
      ++out.link_overflow;
      return false;
    }
    std::uint32_t& room = room_[class_of(qos)];
    const bool fits = size != 0 && size <= room;
    if (fits) room -= static_cast<std::uint32_t>(size);
    // A frame that does not fit goes too: the cable outside counts what it drops.
    std::uint8_t* to = out.link.data() + out.link_count;
    to[0] = static_cast<std::uint8_t>(size & 0xFFu);
    to[1] = static_cast<std::uint8_t>(size >> 8u);
    to[2] = qos;
    to[3] = fits ? 1 : 0;
    std::memcpy(to + FromProcessor::kFrameHeader, data, size);
    out.link_count += static_cast<std::uint32_t>(FromProcessor::kFrameHeader + size);
    return fits;
  }
  std::size_t writable() const override { return room_[kTransmitClasses - 1]; }
  std::size_t read(std::uint8_t* data, std::size_t capacity) override {
    const std::size_t count = std::min(capacity, available_ - taken_);
    std::memcpy(data, block_.to_processor.link.data() + taken_, count);
    taken_ += count;
    return count;
  }
  bool waiting() const { return taken_ < available_; }

 private:
  ExchangeBlock& block_;
  std::size_t taken_{0};
  std::size_t available_{0};
  std::array<std::uint32_t, kTransmitClasses> room_{};
};

}  // namespace rosflight::boards::m7
