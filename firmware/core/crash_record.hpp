// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>

#include "firmware/core/estimator.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::core {

using hal::Time;

/// The record that a fault handler leaves in backup memory for the next start, little-endian. The
/// first 44 bytes are those of ROSflight 2.x:
///
///     u16 faults since power-up | u16 error word | u32 arm word | 8 x u32 registers
///     u32 Fletcher-16
///
/// and 20 of this firmware follow:
///
///     u32 flight word | 3 x u32 age of a rearming [ms] | u32 Fletcher-16
///
/// and 48 more:
///
///     u32 age of the estimate [us] | 4 x f32 attitude | 3 x f32 rates | 3 x f32 bias | u32 Fletcher-16
///
/// A record without a valid second part counts as written on the ground, one without the third knows
/// no attitude.
struct CrashRecord {
  static constexpr std::size_t kReferenceBytes = 44;
  static constexpr std::size_t kMotionAt = 64;  ///< Where the third part begins.
  static constexpr std::size_t kBytes = 112;
  static constexpr std::uint32_t kArmed = 0xBAD2FA11u;
  static constexpr std::uint32_t kAboveIdle = 0x0F117E5Du;
  static constexpr std::uint32_t kNever = 0xFFFFFFFFu;
  static constexpr Time kRearmWindow = hal::milliseconds(60'000);
  static constexpr std::size_t kMaxRearms = 3;  ///< In that window.

  std::uint16_t fault_count{};
  std::uint16_t error_word{};
  bool armed{};
  std::array<std::uint32_t, 8> registers{};  ///< r0, r1, r2, r3, r12, lr, pc, psr.
  /// A motor turned faster than idle at the fault; of a fixed wing, which may glide, within the last
  /// 30 s.
  bool above_idle{};
  using Ages = std::array<std::uint32_t, kMaxRearms>;
  /// Ages of the last three rearmings at the fault, newest first; kNever where there was none.
  Ages rearm_age_ms{kNever, kNever, kNever};

  Motion motion{};                     ///< Its stamp is not stored,
  Time motion_age{-Motion::kUnknown};  ///< but how old it was at the fault.

  std::uint32_t pc() const { return registers[6]; }
  /// The vehicle was flying, and was not rearmed three times within the last 60 s.
  bool may_rearm() const;
};

/// Reads and clears the record. @returns false if there is none or its checksum is wrong.
bool take_crash_record(hal::BackupMemory& memory, CrashRecord& record);

/// Writes the record; callable from a fault handler: no state but its arguments.
bool write_crash_record(hal::BackupMemory& memory, const CrashRecord& record);

}  // namespace rosflight::core
