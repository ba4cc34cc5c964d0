// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/cpu.hpp"

#include "firmware/boards/stm32h7/registers.hpp"

namespace rosflight::boards::stm32h7 {
namespace {

volatile std::uint32_t& scb(std::uint32_t offset) {
  return memory_at<volatile std::uint32_t>(0xE000'E000u + offset);
}

constexpr std::uint32_t kMpuControl = 0xD94, kMpuNumber = 0xD98, kMpuBase = 0xD9C,
                        kMpuAttributes = 0xDA0;
constexpr std::uint32_t kConfiguration = 0xD14;     // CCR
constexpr std::uint32_t kCacheSelection = 0xD84;    // CSSELR
constexpr std::uint32_t kCacheSize = 0xD80;         // CCSIDR
constexpr std::uint32_t kInvalidateCode = 0xF50;    // ICIALLU
constexpr std::uint32_t kInvalidateSetWay = 0xF60;  // DCISW

void barrier() {
  asm volatile("dsb\n isb" ::: "memory");
}

/// Every line of the data cache by set and way: its content after a reset is undefined.
void invalidate_data_cache() {
  scb(kCacheSelection) = 0;
  barrier();
  const std::uint32_t size = scb(kCacheSize);
  const std::uint32_t sets = (size >> 13u & 0x7FFFu) + 1;
  const std::uint32_t ways = (size >> 3u & 0x3FFu) + 1;
  constexpr std::uint32_t kSetShift = 5, kWayShift = 30;  // lines of 32 bytes, 4 ways
  for (std::uint32_t set = 0; set < sets; ++set) {
    for (std::uint32_t way = 0; way < ways; ++way) {
      scb(kInvalidateSetWay) = set << kSetShift | way << kWayShift;
    }
  }
  barrier();
}

}  // namespace

void make_uncached(unsigned region, std::uint32_t base, std::uint32_t size) {
  constexpr std::uint32_t kNoExecution = 1u << 28u, kFullAccess = 3u << 24u;
  constexpr std::uint32_t kShareable = 1u << 18u, kCacheable = 1u << 17u, kEnable = 1u;
  std::uint32_t log2 = 0;
  while ((1u << log2) < size) ++log2;
  scb(kMpuNumber) = region;
  scb(kMpuBase) = base;
  scb(kMpuAttributes) =
      kNoExecution | kFullAccess | kShareable | kCacheable | (log2 - 1u) << 1u | kEnable;
}

void repair_old_silicon() {
  constexpr std::uint32_t kRevisionY = 0x1003;
  if (dbgmcu::IDC_REV_ID.of(reg(DBGMCU, dbgmcu::IDC)) != kRevisionY) return;
  reg(AXI, axi::TARG7_FN_MOD) = axi::TARG7_FN_MOD_READ_ISS_OVERRIDE(1);
}

void start_memory_system() {
  constexpr std::uint32_t kEnable = 1u, kDefaultMap = 1u << 2u;
  constexpr std::uint32_t kCodeCache = 1u << 17u, kDataCache = 1u << 16u;
  scb(kMpuControl) = kEnable | kDefaultMap;
  barrier();
  scb(kInvalidateCode) = 0;
  barrier();
  invalidate_data_cache();
  scb(kConfiguration) = scb(kConfiguration) | kCodeCache | kDataCache;
  barrier();
}

}  // namespace rosflight::boards::stm32h7
