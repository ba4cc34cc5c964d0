// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/flash_control.hpp"

#include <cstring>

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr std::uint32_t kKeys[] = {0x4567'0123U, 0xCDEF'89ABU};
constexpr std::uint32_t kWordBytes = parts::FlashMedium::kWordBytes;
constexpr std::uint32_t kPieceBytes = 4;

}  // namespace

void FlashControl::reset() {
  sectors.interrupt();
  Peripheral::reset();
  word(flash::ACR) = 0x37U;
  word(flash::CR2) = 0x31U;  // locked
  keys_ = pieces_ = 0;
}

std::uint32_t FlashControl::read(std::uint32_t offset, unsigned /*size*/) {
  if (offset != flash::SR2) return word(offset);
  const bool busy = sectors.busy() || pieces_ != 0;
  const bool failed = !busy && sectors.failed();
  return word(offset) | flash::SR2_QW(busy) | flash::SR2_BSY(busy) | flash::SR2_OPERR(failed);
}

void FlashControl::write(std::uint32_t offset, std::uint32_t value, unsigned /*size*/) {
  if (offset == flash::KEYR2) {
    keys_ = keys_ < 2 && value == kKeys[keys_] ? keys_ + 1 : 0;
    if (keys_ == 2) word(flash::CR2) &= ~flash::CR2_LOCK.mask();
  } else if (offset == flash::CR2) {
    write_control(value);
  } else if (offset == flash::CCR2) {
    word(flash::SR2) &= ~value;
  } else if (offset == flash::SR2) {
    complain("SR2: cannot be written");
  } else {
    word(offset) = value;
  }
}

void FlashControl::write_control(std::uint32_t value) {
  std::uint32_t& control = word(flash::CR2);
  if (flash::CR2_LOCK.of(control) != 0) return complain("CR2: written while locked");
  if (sectors.busy() || pieces_ != 0) return complain("CR2: written while the bank is busy");
  const bool starts = flash::CR2_START.of(value) != 0;
  const bool selected =
      flash::CR2_SER.of(control) != 0 && flash::CR2_SNB.of(control) == flash::CR2_SNB.of(value);
  control = value & ~flash::CR2_START.mask();
  if (flash::CR2_LOCK.of(value) != 0) keys_ = 0;
  if (!starts) return;
  if (!selected) return complain("CR2: START before the sector is chosen");
  const std::uint32_t sector = flash::CR2_SNB.of(value);
  if (sector < kFirstSector) return complain("CR2: erases a sector that is not for parameters");
  static_cast<void>(sectors.erase(sector - kFirstSector));
}

std::uint32_t FlashControl::read_sectors(std::uint32_t offset) {
  if (sectors.busy() || pieces_ != 0) complain("bank 2 is read while busy: the processor waits");
  parts::FlashMedium::Word content{};
  const std::uint32_t within = offset % kSectorBytes;
  if (!sectors.read(offset / kSectorBytes, within / kWordBytes, content)) {
    word(flash::SR2) |= flash::SR2_DBECCERR.mask();
    core().bus_error();
  }
  std::uint32_t value = 0;
  std::memcpy(&value, content.data() + (within % kWordBytes & ~(kPieceBytes - 1)), sizeof value);
  return value;
}

void FlashControl::write_sectors(std::uint32_t offset, std::uint32_t value) {
  if (flash::CR2_PG.of(word(flash::CR2)) == 0) {
    word(flash::SR2) |= flash::SR2_PGSERR.mask();
    return complain("programmed without PG");
  }
  if (sectors.busy()) return complain("programmed while busy");
  if (pieces_ == 0) word_at_ = offset;
  if (offset != word_at_ + pieces_ * kPieceBytes || word_at_ % kWordBytes != 0) {
    word(flash::SR2) |= flash::SR2_INCERR.mask();
    pieces_ = 0;
    return complain("a word is not written whole and in order");
  }
  std::memcpy(content_.data() + std::size_t{pieces_} * kPieceBytes, &value, sizeof value);
  if (++pieces_ < kWordBytes / kPieceBytes) return;
  pieces_ = 0;
  const std::uint64_t twice = sectors.twice;
  static_cast<void>(
      sectors.program(word_at_ / kSectorBytes, word_at_ % kSectorBytes / kWordBytes, content_));
  if (sectors.twice != twice) complain("a word is programmed twice without an erase");
}

std::uint32_t FlashSectorsWindow::bus_read(std::uint32_t offset, unsigned size) {
  if (core().cacheable(kBase + offset))
    complain("may lie in the data cache, and changes behind it");
  const std::uint32_t value = control_.read_sectors(offset) >> (8U * (offset & 3U));
  return size == 4 ? value : value & ((1U << (8U * size)) - 1U);
}

void FlashSectorsWindow::bus_write(std::uint32_t offset, std::uint32_t value, unsigned size) {
  if (size != 4) complain("not written by words of 32 bits");
  control_.write_sectors(offset, value);
}

}  // namespace rosflight::boards::stm32h7::emulator
