// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/system_control.hpp"

#include <utility>

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr std::uint32_t kScs = 0xE000U;  // system control space, from kBase
constexpr std::uint32_t kCycleControl = 0x1000U, kCycleCount = 0x1004U;
constexpr std::uint32_t kSetEnable = 0x100U, kPriorities = 0x400U, kPrioritiesEnd = 0x4F0U;
constexpr std::uint32_t kIcsr = 0xD04U, kVtor = 0xD08U, kAircr = 0xD0CU, kCcr = 0xD14U;
constexpr std::uint32_t kSystemPriorities = 0xD18U, kShcsr = 0xD24U, kCfsr = 0xD28U, kHfsr = 0xD2CU,
                        kMmfar = 0xD34U, kBfar = 0xD38U;
constexpr std::uint32_t kMpuType = 0xD90U, kMpuControl = 0xD94U, kMpuNumber = 0xD98U,
                        kMpuBase = 0xD9CU, kMpuAttributes = 0xDA0U;
constexpr std::uint32_t kSoftwareTrigger = 0xF00U;
constexpr std::uint32_t kResetKey = 0x05FAU;

/// Cacheable by the default memory map: code and SRAM, not peripherals and devices. The tightly
/// coupled memories are never cached.
bool cacheable_by_default(std::uint32_t address) {
  const bool tightly_coupled =
      address < 0x0001'0000U || (address >= 0x2000'0000U && address < 0x2002'0000U);
  return !tightly_coupled && address < 0x4000'0000U;
}

}  // namespace

SystemControl::SystemControl(Nvic& nvic, std::function<void(const std::string&)> complain)
    : nvic_{nvic}, complain_{std::move(complain)} {}

void SystemControl::reset(std::uint32_t vector_table) {
  words_.fill(0);
  regions_.fill({});
  vector_table_ = vector_table;
  reset_requested_ = false;
  mpu_changed_ = true;
}

bool SystemControl::cacheable(std::uint32_t address) const {
  constexpr std::uint32_t kDataCacheOn = 1U << 16U;
  if ((word(kCcr) & kDataCacheOn) == 0) return false;
  const bool by_default = cacheable_by_default(address);
  if ((word(kMpuControl) & 1U) == 0 || !by_default) return by_default;
  const Region* const region = region_at(address);
  if (region == nullptr) return by_default;
  // TEX, S, C, B: normal and not shareable with C, or TEX bit 2 with an inner policy. Shareable
  // memory is not cached by this core (Cortex-M7 TRM).
  const std::uint32_t tex = region->attributes >> 19U & 7U;
  const bool shareable = (region->attributes >> 18U & 1U) != 0;
  const bool c = (region->attributes >> 17U & 1U) != 0;
  const bool b = (region->attributes >> 16U & 1U) != 0;
  return !shareable && ((tex == 0 && c) || (tex == 1 && c && b) || (tex & 4U) != 0);
}

/// The highest region that covers an address counts.
const SystemControl::Region* SystemControl::region_at(std::uint32_t address) const {
  for (std::size_t k = regions_.size(); k-- > 0;) {
    const Region& region = regions_[k];
    if ((region.attributes & 1U) == 0) continue;
    const std::uint64_t size = std::uint64_t{2} << (region.attributes >> 1U & 31U);
    if (address >= region.base && address - region.base < size) return &region;
  }
  return nullptr;
}

SystemControl::Rights SystemControl::rights(std::uint32_t address) const {
  constexpr std::uint32_t kDefaultMap = 1U << 2U;
  if ((word(kMpuControl) & 1U) == 0) return {};
  const Region* const region = region_at(address);
  if (region == nullptr) {
    const bool any = (word(kMpuControl) & kDefaultMap) != 0;
    return {any, any};
  }
  const std::uint32_t access = region->attributes >> 24U & 7U;
  return {access != 0, access >= 1 && access <= 3};
}

bool SystemControl::fault_enabled(int exception) const {
  return (word(kShcsr) >> (12 + exception) & 1U) != 0;
}

void SystemControl::note_fault(std::uint32_t cfsr, std::uint32_t hfsr, std::uint32_t address) {
  word(kCfsr) |= cfsr;
  word(kHfsr) |= hfsr;
  constexpr std::uint32_t kOfMemory = 0xFFU;
  if (address != 0) word((cfsr & kOfMemory) != 0 ? kMmfar : kBfar) = address;
}

bool SystemControl::take_reset_request() {
  return std::exchange(reset_requested_, false);
}

std::uint32_t SystemControl::read_nvic(std::uint32_t o) const {
  std::uint32_t value = 0;
  if (o >= kPriorities) {
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t irq = (o & ~3U) - kPriorities + k;
      if (irq < Nvic::kIrqs) {
        value |= std::uint32_t{nvic_.priority_byte(kFirstIrq + static_cast<int>(irq))} << (8 * k);
      }
    }
    return value;
  }
  for (std::uint32_t bit = 0; bit < 32; ++bit) {
    const std::uint32_t irq = (o & 0x7FU) * 8 + bit;
    if (irq >= Nvic::kIrqs) break;
    const int exception = kFirstIrq + static_cast<int>(irq);
    const bool on = o < 0x200U   ? nvic_.enabled(irq)
                    : o < 0x300U ? nvic_.pending(exception)
                                 : nvic_.active(exception);
    value |= static_cast<std::uint32_t>(on) << bit;
  }
  return value;
}

std::uint32_t SystemControl::read(std::uint32_t offset, Ticks now) const {
  if (offset == kCycleControl) return 1;
  if (offset == kCycleCount) return static_cast<std::uint32_t>((now - cycles_zero_) / 2);
  if (offset < kScs || offset >= kScs + 0x1000U) return 0;
  const std::uint32_t o = offset - kScs;
  if (o >= kSetEnable && o < kPrioritiesEnd) return read_nvic(o) >> (8 * (o & 3U));
  switch (o) {
    case 0xD00U:
      return 0x411F'C271U;  // CPUID: Cortex-M7 r1p1
    case kIcsr:
      return static_cast<std::uint32_t>(nvic_.running());
    case kVtor:
      return vector_table_;
    case kAircr:
      return 0xFA05'0000U | nvic_.group() << 8U;
    case 0xD78U:
      return 0x0900'0003U;  // CLIDR: separate caches of level 1
    case 0xD80U:
      return 0xF00F'E019U;  // CCSIDR: 16 KiB, 4 ways, lines of 32 bytes
    case kMpuType:
      return 16U << 8U;
    default:
      return word(o);
  }
}

void SystemControl::write_nvic(std::uint32_t o, std::uint32_t value) {
  for (std::uint32_t bit = 0; bit < 32; ++bit) {
    const std::uint32_t irq = (o & 0x7FU) * 8 + bit;
    if (irq >= Nvic::kIrqs) return;
    if ((value >> bit & 1U) == 0) continue;
    const int exception = kFirstIrq + static_cast<int>(irq);
    if (o < 0x180U)
      nvic_.enable(irq, true);
    else if (o < 0x200U)
      nvic_.enable(irq, false);
    else if (o < 0x280U)
      nvic_.pend(exception);
    else
      nvic_.unpend(exception);
  }
}

void SystemControl::write_mpu(std::uint32_t o, std::uint32_t value) {
  Region& region = regions_[word(kMpuNumber) % regions_.size()];
  if (o == kMpuBase) {
    if ((value & 0x10U) != 0) word(kMpuNumber) = value & 0xFU;
    regions_[word(kMpuNumber) % regions_.size()].base = value & ~0x1FU;
    return;
  }
  region.attributes = value;
  const std::uint64_t size = std::uint64_t{2} << (value >> 1U & 31U);
  if ((value & 1U) != 0 && (region.base & (size - 1)) != 0) {
    complain_("MPU: the base of a region is no multiple of its size");
  }
}

void SystemControl::write(std::uint32_t offset, std::uint32_t value, unsigned size, Ticks now) {
  if (offset == kCycleCount) cycles_zero_ = now - 2 * Ticks{value};
  if (offset < kScs || offset >= kScs + 0x1000U) return;
  const std::uint32_t o = offset - kScs;
  const bool irq_priority = o >= kPriorities && o < kPrioritiesEnd;
  if (irq_priority || (o >= kSystemPriorities && o < kShcsr)) {
    const std::uint32_t first =
        irq_priority ? o - kPriorities + kFirstIrq : o - kSystemPriorities + 4;
    for (unsigned k = 0; k < size && first + k < Nvic::kExceptions; ++k) {
      nvic_.set_priority(static_cast<int>(first + k), static_cast<std::uint8_t>(value >> (8 * k)));
    }
    return;
  }
  if (o >= kSetEnable && o < 0x300U) return write_nvic(o, value);
  switch (o) {
    case kVtor:
      vector_table_ = value & ~0x7FU;
      break;
    case kAircr:
      if (value >> 16U != kResetKey) break;
      nvic_.set_group(value >> 8U & 7U);
      reset_requested_ = (value & 4U) != 0;
      break;
    case kCfsr:
    case kHfsr:
      word(o) &= ~value;  // written 1 clears
      break;
    case kMpuBase:
    case kMpuAttributes:
      write_mpu(o, value);
      mpu_changed_ = true;
      break;
    case kMpuControl:
      word(o) = value;
      mpu_changed_ = true;
      break;
    case kSoftwareTrigger:
      if (value < Nvic::kIrqs) nvic_.pend(kFirstIrq + static_cast<int>(value));
      break;
    default:
      word(o) = value;
  }
}

}  // namespace rosflight::boards::stm32h7::emulator
