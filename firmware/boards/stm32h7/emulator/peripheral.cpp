// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/peripheral.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "firmware/boards/stm32h7/register_list.hpp"

namespace rosflight::boards::stm32h7::emulator {
namespace {

std::string hex(std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%x", value);
  return text;
}

}  // namespace

Peripheral::Peripheral(Core& core, std::string name, std::string_view block,
                       const Instance& instance)
    : core_{core}, name_{std::move(name)}, instance_{instance} {
  describe(block, 0);
}

void Peripheral::describe(std::string_view block, std::uint32_t offset) {
  for (const RegisterName& each : kRegisterNames) {
    if (block != each.block) continue;
    const std::size_t index = (offset + each.offset) / 4;
    if (words_.size() <= index) {
      words_.resize(index + 1);
      defined_.resize(index + 1);
    }
    defined_[index] |= each.defined_bits;
  }
}

std::uint32_t Peripheral::bus_read(std::uint32_t offset, unsigned size) {
  const std::uint32_t aligned = offset & ~3U;
  if (aligned / 4 >= words_.size() || defined_[aligned / 4] == 0) {
    complain("read of offset " + hex(offset) + ", where it has no register");
    return 0;
  }
  return read(aligned, size) >> (8U * (offset & 3U));
}

void Peripheral::bus_write(std::uint32_t offset, std::uint32_t value, unsigned size) {
  if (std::exchange(fails_, false)) {
    core_.bus_error();
    return;
  }
  if ((offset & 3U) != 0 || offset / 4 >= words_.size() || defined_[offset / 4] == 0) {
    complain("write to offset " + hex(offset) + ", where it has no register");
    return;
  }
  if (const std::uint32_t reserved = value & ~defined_[offset / 4]; reserved != 0) {
    complain("write of reserved bits " + hex(reserved) + " at offset " + hex(offset));
  }
  write(offset, value, size);
}

std::uint32_t Peripheral::read(std::uint32_t offset, unsigned /*size*/) {
  return word(offset);
}

void Peripheral::write(std::uint32_t offset, std::uint32_t value, unsigned /*size*/) {
  word(offset) = value;
}

void Peripheral::reset() {
  std::fill(words_.begin(), words_.end(), 0U);
  fails_ = false;
}

void Peripheral::complain(const std::string& what) const {
  core_.complain(name_ + ": " + what);
}

}  // namespace rosflight::boards::stm32h7::emulator
