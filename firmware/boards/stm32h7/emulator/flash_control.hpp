// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/models/flash_model.hpp"
#include "firmware/boards/stm32h7/emulator/peripheral.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// The flash controller: wait states, and bank 2 with erase and program. RM0433 ch. 4.
///
/// Complains of: registers of bank 2 written while it is locked or busy; a word that is not written whole
/// and in order, not enabled, or programmed twice; an erase of a sector that holds no parameters.
class FlashControl final : public Peripheral {
 public:
  static constexpr std::uint32_t kSectorBytes = 0x2'0000U, kFirstSector = 6;

  explicit FlashControl(Core& core) : Peripheral{core, "FLASH", "FLASH", FLASH} {}
  void reset() override;
  std::uint32_t wait_states() const { return flash::ACR_LATENCY.of(word(flash::ACR)); }

  /// A read of the last two sectors of bank 2, from their beginning. An error of the code that cannot be
  /// corrected raises its flag and an error of the bus.
  std::uint32_t read_sectors(std::uint32_t offset);
  void write_sectors(std::uint32_t offset, std::uint32_t value);

  /// What is stored there; survives resets and the power, but for the word or sector that is being written or erased.
  parts::models::FlashModel sectors{
      kSectorBytes / parts::FlashMedium::kWordBytes,
      [this] { return hal::Time{static_cast<std::int64_t>(core().now() / kTicksPerMicrosecond)}; }};

 private:
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void write_control(std::uint32_t value);

  unsigned keys_{0};    ///< Right ones in a row.
  unsigned pieces_{0};  ///< Pieces of the word that is being written.
  std::uint32_t word_at_{0};
  parts::FlashMedium::Word content_{};
};

/// Where the bus finds these two sectors.
class FlashSectorsWindow final : public Peripheral {
 public:
  static constexpr std::uint32_t kBase = 0x081C'0000U;

  FlashSectorsWindow(Core& core, FlashControl& control)
      : Peripheral{core, "flash", "", Instance{kBase, 0, 0}}, control_{control} {}
  std::uint32_t size() const override { return 2 * FlashControl::kSectorBytes; }
  std::uint32_t bus_read(std::uint32_t offset, unsigned size) override;
  void bus_write(std::uint32_t offset, std::uint32_t value, unsigned size) override;

 private:
  FlashControl& control_;
};

}  // namespace rosflight::boards::stm32h7::emulator
