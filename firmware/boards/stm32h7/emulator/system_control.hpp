// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <functional>

#include "firmware/boards/stm32h7/emulator/core.hpp"
#include "firmware/boards/stm32h7/emulator/nvic.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// Registers of the processor itself, from 0xE0000000: NVIC, SCB, MPU, caches, FPU, cycle counter.
/// Armv7-M ARM (DDI 0403E) B3. Not modelled: SysTick (a write is complained of), permissions of MPU
/// regions; of the MPU only the memory attributes count here.
class SystemControl {
 public:
  static constexpr std::uint32_t kBase = 0xE000'0000U;
  static constexpr std::uint32_t kSize = 0x10'0000U;

  SystemControl(Nvic& nvic, std::function<void(const std::string&)> complain);

  void reset(std::uint32_t vector_table);
  std::uint32_t read(std::uint32_t offset, Ticks now) const;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size, Ticks now);

  std::uint32_t vector_table() const { return vector_table_; }
  bool fpu_enabled() const { return (word(0xD88U) & 0xF0'0000U) == 0xF0'0000U; }
  /// Whether the data cache is on and may hold this address, by the MPU and the default map.
  bool cacheable(std::uint32_t address) const;
  /// Whether a fault has a handler of its own; others become hard faults.
  bool fault_enabled(int exception) const;
  /// CCR.BFHFNMIGN.
  bool ignores_bus_faults() const { return (word(0xD14U) >> 8U & 1U) != 0; }
  /// Sets bits of the configurable fault status register, and of the hard fault status register.
  void note_fault(std::uint32_t cfsr, std::uint32_t hfsr, std::uint32_t address);
  /// SYSRESETREQ was written since the last call.
  bool take_reset_request();

 private:
  struct Region {
    std::uint32_t base{};
    std::uint32_t attributes{};
  };
  std::uint32_t& word(std::uint32_t offset) { return words_[offset / 4]; }
  std::uint32_t word(std::uint32_t offset) const { return words_[offset / 4]; }
  std::uint32_t read_nvic(std::uint32_t offset) const;
  void write_nvic(std::uint32_t offset, std::uint32_t value);
  void write_mpu(std::uint32_t offset, std::uint32_t value);

  Nvic& nvic_;
  std::function<void(const std::string&)> complain_;
  std::array<std::uint32_t, 1024> words_{};
  std::array<Region, 16> regions_{};
  std::uint32_t vector_table_{};
  Ticks cycles_zero_{};
  bool reset_requested_{false};
};

}  // namespace rosflight::boards::stm32h7::emulator
