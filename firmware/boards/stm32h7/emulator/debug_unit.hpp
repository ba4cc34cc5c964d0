// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/stm32h7/emulator/peripheral.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// What silicon it is, and what stands still while a debugger has halted the processor. RM0433 ch. 60. No debugger is
/// modelled: Chip complains where the halt of one would end in a reset or leave outputs on.
class DebugUnit final : public Peripheral {
 public:
  enum class Revision : std::uint16_t { kY = 0x1003, kV = 0x2003 };

  explicit DebugUnit(Core& core) : Peripheral{core, "DBGMCU", "DBGMCU", DBGMCU} {}

  /// From the next reset on.
  void set_revision(Revision revision) { revision_ = revision; }
  Revision revision() const { return revision_; }
  /// A timer or the watchdog stands still with the processor.
  bool stops(const Instance& instance) const;

  void reset() override;

 private:
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;

  Revision revision_{Revision::kV};
};

/// The matrix of the AXI bus: the one register that an erratum of revision Y asks for.
class AxiMatrix final : public Peripheral {
 public:
  explicit AxiMatrix(Core& core) : Peripheral{core, "AXI", "AXI", AXI} {}
  /// Reads of the SRAM are issued one at a time.
  bool reads_one_at_a_time() const {
    return axi::TARG7_FN_MOD_READ_ISS_OVERRIDE.of(word(axi::TARG7_FN_MOD)) != 0;
  }
};

}  // namespace rosflight::boards::stm32h7::emulator
