// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <bitset>
#include <cstdint>
#include <vector>

namespace rosflight::boards::stm32h7::emulator {

/// Numbers of exceptions as in IPSR; interrupt n is kFirstIrq + n.
inline constexpr int kNmi = 2, kHardFault = 3, kMemoryFault = 4, kBusFault = 5, kUsageFault = 6,
                     kSvCall = 11, kSysTick = 15, kFirstIrq = 16;

/// Exceptions: which are pending, active and enabled, and which comes next.
///
/// Armv7-M ARM (DDI 0403E) B1.5: lower number is more urgent; of equals the lowest exception number
/// comes first. The chip implements the upper four bits of a priority (RM0433).
class Nvic {
 public:
  static constexpr unsigned kIrqs = 150;
  static constexpr std::size_t kExceptions = kFirstIrq + kIrqs;

  /// What the special registers mask.
  struct Masks {
    bool primask{false};
    bool faultmask{false};
    std::uint8_t basepri{0};
  };

  void reset() { *this = Nvic{}; }

  /// A rising level makes the interrupt pending; so does a level that is still high when the
  /// handler returns.
  void set_line(unsigned irq, bool high);
  void enable(unsigned irq, bool on);
  void pend(int exception);
  void unpend(int exception);
  void set_priority(int exception, std::uint8_t priority);
  void set_group(std::uint32_t group) { group_ = group; }

  bool line(unsigned irq) const { return line_[irq]; }
  bool enabled(unsigned irq) const { return enabled_[irq]; }
  bool pending(int exception) const { return pending_[index(exception)]; }
  bool active(int exception) const { return active_[index(exception)]; }
  std::uint8_t priority_byte(int exception) const { return priority_[index(exception)]; }
  std::uint32_t group() const { return group_; }

  /// Whether any enabled exception is pending, masked or not: wakes a sleeping processor.
  bool any_pending() const { return ready_.any(); }
  /// The exception to take now, or 0.
  int next(const Masks& masks) const;
  /// Its handler starts.
  void activate(int exception);
  /// The innermost handler returns. @returns its exception, 0 if none is active.
  int deactivate();
  /// Innermost active exception, 0 in thread mode.
  int running() const { return stack_.empty() ? 0 : stack_.back(); }
  bool nested() const { return stack_.size() > 1; }

 private:
  static std::size_t index(int exception) { return static_cast<std::size_t>(exception); }
  int priority(int exception) const;
  int running_priority(const Masks& masks) const;
  void note_ready(int exception);

  std::array<bool, kIrqs> line_{}, enabled_{};
  std::array<bool, kExceptions> pending_{}, active_{};
  std::array<std::uint8_t, kExceptions> priority_{};
  std::vector<int> stack_;
  std::uint32_t group_{0};
  std::bitset<kExceptions> ready_;  ///< Pending and enabled.
};

}  // namespace rosflight::boards::stm32h7::emulator
