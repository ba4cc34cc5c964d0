// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstring>

#include "firmware/hal/roles.hpp"

namespace rosflight::boards {

/// Non-volatile memory that is there like RAM (an MRAM on the external bus): survives a reset and,
/// with the host's memory behind it, the emulator.
class MappedStorage final : public hal::Storage {
 public:
  MappedStorage(std::uint8_t* memory, std::size_t size) : memory_{memory}, size_{size} {}
  std::size_t size() const override { return size_; }
  bool read(std::size_t offset, std::uint8_t* data, std::size_t count) override {
    if (!inside(offset, count)) return false;
    std::memcpy(data, memory_ + offset, count);
    return true;
  }
  bool write(std::size_t offset, const std::uint8_t* data, std::size_t count) override {
    if (!inside(offset, count)) return false;
    auto* to = static_cast<volatile std::uint8_t*>(memory_ + offset);  // in ascending order
    for (std::size_t k = 0; k < count; ++k) to[k] = data[k];
    return true;
  }
  bool flush() override { return true; }

 private:
  bool inside(std::size_t offset, std::size_t count) const {
    return offset <= size_ && count <= size_ - offset;
  }
  std::uint8_t* memory_;
  std::size_t size_;
};

/// Internal RAM that start-up leaves alone: survives a reset, not the power.
class BackupRam final : public hal::BackupMemory {
 public:
  explicit BackupRam(std::uint8_t* memory) : memory_{memory} {}
  bool read(std::uint8_t* data, std::size_t count) override {
    if (count > kSize) return false;
    std::memcpy(data, memory_, count);
    return true;
  }
  bool write(const std::uint8_t* data, std::size_t count) override {
    if (count > kSize) return false;
    std::memcpy(memory_, data, count);
    return true;
  }
  void clear() override { std::memset(memory_, 0, kSize); }

 private:
  std::uint8_t* memory_;
};

}  // namespace rosflight::boards
