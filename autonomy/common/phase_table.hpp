// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace rosflight::autonomy {

/// One row of a table of phases. Conditions are a set of bits.
template <typename Phase>
struct PhaseTransition {
  Phase from;
  std::uint16_t all;   ///< Conditions that must hold.
  std::uint16_t none;  ///< Conditions that must not hold.
  Phase to;
};

/// Condition of every table: the flight controller is armed.
inline constexpr std::uint16_t kArmedCondition = 1U;

/// Name of an enumerator that counts from 0; "unknown" outside the list.
constexpr const char* name_in(std::span<const char* const> names, std::size_t value) {
  return value < names.size() ? names[value] : "unknown";
}

/// The state machine of one vehicle: every change of phase is a row of one table.
/// @tparam Phase  enumeration that counts from 0 and has the enumerator kDisarmed.
template <typename Phase>
class PhaseTable {
 public:
  using Transition = PhaseTransition<Phase>;

  /// Refers to both lists, which must live as long as the table.
  /// @param names  of the phases, in the order of the enumeration.
  constexpr PhaseTable(std::span<const char* const> names, std::span<const Transition> transitions)
      : names_(names), transitions_(transitions) {}

  /// The phase after `from` under these conditions: that of the first row that fits, `from` if no
  /// row fits. A vehicle that is not armed is always in Phase::kDisarmed.
  constexpr Phase next(Phase from, std::uint16_t conditions) const {
    if ((conditions & kArmedCondition) == 0) return Phase::kDisarmed;
    for (const Transition& row : transitions_) {
      if (row.from == from && (conditions & row.all) == row.all && (conditions & row.none) == 0) {
        return row.to;
      }
    }
    return from;
  }

  /// Name for logs and messages; "unknown" for a value outside the enumeration.
  constexpr const char* name(Phase phase) const {
    return name_in(names_, static_cast<std::size_t>(phase));
  }

  constexpr std::size_t phases() const { return names_.size(); }
  constexpr std::span<const Transition> transitions() const { return transitions_; }

 private:
  std::span<const char* const> names_;
  std::span<const Transition> transitions_;
};

/// The conditions that hold in one step.
class PhaseConditions {
 public:
  /// Adds a condition, one bit of the vehicle's enumeration, if it holds.
  void set(std::uint16_t condition, bool holds) {
    if (holds) bits_ = static_cast<std::uint16_t>(bits_ | condition);
  }
  /// Whether the condition was set in this step.
  bool has(std::uint16_t condition) const { return (bits_ & condition) != 0; }
  std::uint16_t bits() const { return bits_; }

 private:
  std::uint16_t bits_{};
};

}  // namespace rosflight::autonomy
