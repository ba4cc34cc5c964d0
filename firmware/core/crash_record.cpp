// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/crash_record.hpp"

#include <algorithm>
#include <cstring>

#include "firmware/core/checksum.hpp"

namespace rosflight::core {
namespace {

using Bytes = std::array<std::uint8_t, CrashRecord::kBytes>;
constexpr std::size_t kChecked = CrashRecord::kReferenceBytes - 4;
constexpr std::size_t kOwn = CrashRecord::kReferenceBytes;
constexpr std::size_t kOwnChecked = CrashRecord::kMotionAt - 4;
constexpr std::size_t kMotion = CrashRecord::kMotionAt;
constexpr std::size_t kMotionChecked = CrashRecord::kBytes - 4;

void put(Bytes& b, std::size_t at, std::uint32_t v, std::size_t n) {
  for (std::size_t k = 0; k < n; ++k) b[at + k] = static_cast<std::uint8_t>(v >> (8 * k));
}
std::uint32_t get(const Bytes& b, std::size_t at, std::size_t n) {
  std::uint32_t v = 0;
  for (std::size_t k = 0; k < n; ++k) v |= static_cast<std::uint32_t>(b[at + k]) << (8 * k);
  return v;
}

/// The ten numbers of a motion, in the order of the record.
using Numbers = std::array<float, 10>;
static_assert(kMotion + 4 + sizeof(Numbers) == kMotionChecked);

Numbers numbers(const Motion& m) {
  const Quaternion& q = m.q_WB;
  const Vector3& w = m.rates_rad_s;
  const Vector3& b = m.bias_rad_s;
  return {q.w, q.x, q.y, q.z, w.x(), w.y(), w.z(), b.x(), b.y(), b.z()};
}
Motion motion_of(const Numbers& n) {
  return {Motion::kUnknown, {n[0], n[1], n[2], n[3]}, {n[4], n[5], n[6]}, {n[7], n[8], n[9]}};
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
  if (get(bytes, kMotionChecked, 4) == fletcher16(&bytes[kMotion], kMotionChecked - kMotion)) {
    Numbers n{};
    std::memcpy(n.data(), &bytes[kMotion + 4], sizeof n);
    record.motion = motion_of(n);
    record.motion_age = Time{get(bytes, kMotion, 4)};
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
  constexpr Time kOldest{0xFFFF'FFFF};
  const Time age = std::clamp(record.motion_age, Time{0}, kOldest);
  put(bytes, kMotion, static_cast<std::uint32_t>(age.count()), 4);
  const Numbers n = numbers(record.motion);
  std::memcpy(&bytes[kMotion + 4], n.data(), sizeof n);
  put(bytes, kMotionChecked, fletcher16(&bytes[kMotion], kMotionChecked - kMotion), 4);
  return memory.write(bytes.data(), bytes.size());
}

}  // namespace rosflight::core
