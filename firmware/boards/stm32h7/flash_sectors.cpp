// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/flash_sectors.hpp"

#include <cstring>

#include "firmware/boards/stm32h7/registers.hpp"

namespace rosflight::boards::stm32h7 {
namespace {

constexpr std::uint32_t kKeys[] = {0x4567'0123u, 0xCDEF'89ABu};
constexpr std::uint32_t kParallelism = flash::CR2_PSIZE(3);  // 64 bits at a time, from 2.7 V on
constexpr std::uint32_t kErrors = flash::SR2_WRPERR.mask() | flash::SR2_PGSERR.mask() |
                                  flash::SR2_STRBERR.mask() | flash::SR2_INCERR.mask() |
                                  flash::SR2_OPERR.mask();
constexpr std::uint32_t kCodeErrors = flash::SR2_SNECCERR.mask() | flash::SR2_DBECCERR.mask();
constexpr std::size_t kPieces = parts::FlashMedium::kWordBytes / sizeof(std::uint32_t);

/// Data bus faults are ignored and nothing interrupts while this lives.
class FaultsIgnored {
 public:
  FaultsIgnored() {
    asm volatile("cpsid f" ::: "memory");
    configuration() = configuration() | kIgnore;
    asm volatile("dsb\n isb" ::: "memory");
  }
  ~FaultsIgnored() {
    asm volatile("dsb" ::: "memory");
    configuration() = configuration() & ~kIgnore;
    asm volatile("dsb\n isb\n cpsie f" ::: "memory");
  }
  FaultsIgnored(const FaultsIgnored&) = delete;
  FaultsIgnored& operator=(const FaultsIgnored&) = delete;

 private:
  static constexpr std::uint32_t kIgnore = 1u << 8u;  // BFHFNMIGN
  static volatile std::uint32_t& configuration() {
    return memory_at<volatile std::uint32_t>(0xE000'ED14u);
  }
};

}  // namespace

void FlashSectors::open() {
  if (flash::CR2_LOCK.of(reg(FLASH, flash::CR2)) != 0) {
    for (const std::uint32_t key : kKeys) reg(FLASH, flash::KEYR2) = key;
  }
}

void FlashSectors::clear_flags() {
  reg(FLASH, flash::CCR2) = kErrors | kCodeErrors | flash::SR2_EOP.mask();
}

/// Programming stays enabled until the word has left the queue: the manual's order.
bool FlashSectors::busy() {
  if (flash::SR2_QW.of(reg(FLASH, flash::SR2)) != 0) return true;
  reg(FLASH, flash::CR2) = kParallelism;
  return false;
}

bool FlashSectors::failed() {
  return (reg(FLASH, flash::SR2) & kErrors) != 0;
}

bool FlashSectors::read(std::size_t sector, std::size_t word, Word& content) {
  if (busy()) return false;
  std::uint32_t pieces[kPieces];
  const std::uint32_t from = address(sector, word);
  {
    const FaultsIgnored guard;
    for (std::size_t k = 0; k < kPieces; ++k) {
      pieces[k] = memory_at<const volatile std::uint32_t>(from + k * sizeof pieces[0]);
    }
  }
  std::memcpy(content.data(), pieces, sizeof pieces);
  const std::uint32_t status = reg(FLASH, flash::SR2);
  if ((status & kCodeErrors) != 0) reg(FLASH, flash::CCR2) = kCodeErrors;
  return flash::SR2_DBECCERR.of(status) == 0;
}

/// All pieces of a word in ascending order, then the controller begins.
bool FlashSectors::program(std::size_t sector, std::size_t word, const Word& content) {
  if (busy()) return false;
  clear_flags();
  std::uint32_t pieces[kPieces];
  std::memcpy(pieces, content.data(), sizeof pieces);
  const std::uint32_t to = address(sector, word);
  reg(FLASH, flash::CR2) = kParallelism | flash::CR2_PG(1);
  memory_barrier();
  for (std::size_t k = 0; k < kPieces; ++k) {
    memory_at<volatile std::uint32_t>(to + k * sizeof pieces[0]) = pieces[k];
  }
  asm volatile("dsb" ::: "memory");
  return !failed();
}

bool FlashSectors::erase(std::size_t sector) {
  if (busy()) return false;
  clear_flags();
  const std::uint32_t which = flash::CR2_SNB(kFirstSector + static_cast<std::uint32_t>(sector));
  reg(FLASH, flash::CR2) = kParallelism | flash::CR2_SER(1) | which;
  reg(FLASH, flash::CR2) = kParallelism | flash::CR2_SER(1) | which | flash::CR2_START(1);
  return true;
}

}  // namespace rosflight::boards::stm32h7
