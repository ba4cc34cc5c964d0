// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <utility>

#include "firmware/boards/stm32h7/emulator/core.hpp"
#include "firmware/boards/stm32h7/emulator/nvic.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// Registers of the processor itself, from 0xE0000000: NVIC, SCB, MPU, caches, FPU, cycle counter.
/// Armv7-M ARM (DDI 0403E) B3. SysTick is a class of its own. Not modelled: unprivileged code, and that the MPU is off
/// in the handlers of hard fault and NMI.
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
  struct Rights {
    bool read{true}, write{true};
  };
  /// What privileged code may do at an address, by the MPU.
  Rights rights(std::uint32_t address) const;
  /// Written since the last call: rights may have changed.
  bool take_mpu_change() { return std::exchange(mpu_changed_, false); }
  /// Whether a fault has a handler of its own; others become hard faults.
  bool fault_enabled(int exception) const;
  /// CCR.BFHFNMIGN.
  bool ignores_bus_faults() const { return (word(0xD14U) >> 8U & 1U) != 0; }
  /// Sets bits of the configurable fault status register, and of the hard fault status register.
  /// @param address  of the access, for the register that goes with these bits; 0: none.
  void note_fault(std::uint32_t cfsr, std::uint32_t hfsr, std::uint32_t address);
  /// SYSRESETREQ was written since the last call.
  bool take_reset_request();

 private:
  struct Region {
    std::uint32_t base{};
    std::uint32_t attributes{};
  };
  const Region* region_at(std::uint32_t address) const;
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
  bool reset_requested_{false}, mpu_changed_{false};
};

}  // namespace rosflight::boards::stm32h7::emulator
