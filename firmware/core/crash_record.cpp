// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/crash_record.hpp"

#include "firmware/core/checksum.hpp"

namespace rosflight::core {
namespace {

using Bytes = std::array<std::uint8_t, CrashRecord::kBytes>;
constexpr std::size_t kChecked = CrashRecord::kReferenceBytes - 4;
constexpr std::size_t kOwn = CrashRecord::kReferenceBytes;
constexpr std::size_t kOwnChecked = CrashRecord::kBytes - 4;

void put(Bytes& b, std::size_t at, std::uint32_t v, std::size_t n) {
  for (std::size_t k = 0; k < n; ++k) b[at + k] = static_cast<std::uint8_t>(v >> (8 * k));
}
std::uint32_t get(const Bytes& b, std::size_t at, std::size_t n) {
  std::uint32_t v = 0;
  for (std::size_t k = 0; k < n; ++k) v |= static_cast<std::uint32_t>(b[at + k]) << (8 * k);
  return v;
}

}  // namespace

bool take_crash_record(hal::BackupMemory& memory, CrashRecord& record) {
  Bytes bytes{};
  if (!memory.read(bytes.data(), bytes.size())) return false;
  memory.clear();
  if (get(bytes, kChecked, 4) != fletcher16(bytes.data(), kChecked)) return false;
  record.fault_count = static_cast<std::uint16_t>(get(bytes, 0, 2));
  record.error_word = static_cast<std::uint16_t>(get(bytes, 2, 2));
  record.armed = get(bytes, 4, 4) == CrashRecord::kArmed;
  for (std::size_t k = 0; k < record.registers.size(); ++k) {
    record.registers[k] = get(bytes, 8 + 4 * k, 4);
  }
  const bool own = get(bytes, kOwnChecked, 4) == fletcher16(&bytes[kOwn], kOwnChecked - kOwn);
  record.above_idle = own && get(bytes, kOwn, 4) == CrashRecord::kAboveIdle;
  for (std::size_t k = 0; k < record.rearm_age_ms.size(); ++k) {
    record.rearm_age_ms[k] = own ? get(bytes, kOwn + 4 + 4 * k, 4) : CrashRecord::kNever;
  }
  return true;
}

bool CrashRecord::may_rearm() const {
  return armed && above_idle && hal::milliseconds(rearm_age_ms.back()) >= kRearmWindow;
}

bool write_crash_record(hal::BackupMemory& memory, const CrashRecord& record) {
  Bytes bytes{};
  put(bytes, 0, record.fault_count, 2);
  put(bytes, 2, record.error_word, 2);
  put(bytes, 4, record.armed ? CrashRecord::kArmed : 0, 4);
  for (std::size_t k = 0; k < record.registers.size(); ++k) {
    put(bytes, 8 + 4 * k, record.registers[k], 4);
  }
  put(bytes, kChecked, fletcher16(bytes.data(), kChecked), 4);
  put(bytes, kOwn, record.above_idle ? CrashRecord::kAboveIdle : 0, 4);
  for (std::size_t k = 0; k < record.rearm_age_ms.size(); ++k) {
    put(bytes, kOwn + 4 + 4 * k, record.rearm_age_ms[k], 4);
  }
  put(bytes, kOwnChecked, fletcher16(&bytes[kOwn], kOwnChecked - kOwn), 4);
  return memory.write(bytes.data(), bytes.size());
}

}  // namespace rosflight::core
