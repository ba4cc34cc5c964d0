// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

#include "firmware/boards/parts/flash_medium.hpp"
#include "firmware/boards/stm32h7/cpu.hpp"

namespace rosflight::boards::stm32h7 {

/// The last two sectors of bank 2 of the flash. The image lies in bank 1, which can be read while bank 2
/// is erased or programmed, so the firmware goes on. RM0433 ch. 4.
///
/// A word whose code cannot be corrected (power was cut while it was written) is answered by the bus with
/// an error. It is read with data bus faults ignored (FAULTMASK and CCR.BFHFNMIGN, Armv7-M ARM B1.5.8), for
/// some 100 ns with interrupts off, and the flag of the controller shows that it is lost.
class FlashSectors final : public parts::FlashMedium {
 public:
  static constexpr std::uint32_t kBase = 0x081C'0000u, kSectorBytes = 0x2'0000u;

  /// The region must not be cached: what is programmed changes behind the cache. Before the caches are on.
  static void map_memory(unsigned region) { make_uncached(region, kBase, 2 * kSectorBytes); }
  /// Unlocks the bank. Once, before anything else.
  void open();

  std::size_t words_per_sector() const override { return kSectorBytes / kWordBytes; }
  bool read(std::size_t sector, std::size_t word, Word& content) override;
  bool program(std::size_t sector, std::size_t word, const Word& content) override;
  bool erase(std::size_t sector) override;
  bool busy() override;
  bool failed() override;

 private:
  static constexpr std::uint32_t kFirstSector = 6;
  static std::uint32_t address(std::size_t sector, std::size_t word) {
    return kBase + static_cast<std::uint32_t>(sector * kSectorBytes + word * kWordBytes);
  }
  void clear_flags();
};

}  // namespace rosflight::boards::stm32h7
