// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>

#include "firmware/hal/roles.hpp"

namespace rosflight::core {

/// What a fault handler leaves in backup memory for the next start. 44 bytes, little-endian:
/// u16 faults since power-up | u16 error word | u32 arm word | 8 x u32 registers | u32 Fletcher-16.
struct CrashRecord {
  static constexpr std::size_t kBytes = 44;
  static constexpr std::uint32_t kArmed = 0xBAD2FA11u;

  std::uint16_t fault_count{};
  std::uint16_t error_word{};
  bool armed{};
  std::array<std::uint32_t, 8> registers{};  ///< r0, r1, r2, r3, r12, lr, pc, psr.
  std::uint32_t pc() const { return registers[6]; }
};

/// Reads and clears the record. @returns false if there is none or its checksum is wrong.
bool take_crash_record(hal::BackupMemory& memory, CrashRecord& record);

/// Writes the record; callable from a fault handler: no state but its arguments.
bool write_crash_record(hal::BackupMemory& memory, const CrashRecord& record);

}  // namespace rosflight::core
