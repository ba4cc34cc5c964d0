// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <bitset>

#include "firmware/core/parameter_table.hpp"  // made from parameters.csv at build time

namespace rosflight::core {

/// Result of a request to change a parameter.
enum class [[nodiscard]] SetResult : std::uint8_t {
  kChanged,      ///< Changed; marked for the modules and for the companion.
  kUnchanged,    ///< Already had that value.
  kOutOfRange,   ///< Outside min..max and not the sentinel, or not finite. Value kept.
  kWrongType,    ///< Type code is not the stored one. Value kept.
  kLockedArmed,  ///< Dangerous to change in flight. Value kept.
  kTooFar,       ///< A larger change than one message may make while armed. Value kept.
};

/// The live parameter table: values in RAM, names, types and limits from parameters.csv. Records
/// which values changed since the modules last applied them, and since they were last reported to
/// the companion. 1.5 kB.
class Parameters {
 public:
  using ChangeSet = std::bitset<kParamCount>;

  Parameters() { reset_to_defaults(); }

  /// The table row of a parameter. Its name is packed: kind() alone is faster.
  static ParamRow row(Param id) { return {kind(id), name(id)}; }
  /// That row without its name.
  static constexpr const ParamKind& kind(Param id) {
    return detail::kParamKinds[detail::kParamKindOf[static_cast<std::size_t>(id)]];
  }
  /// The limit of a change while armed.
  static constexpr const ArmedRule& armed_rule(Param id) {
    return detail::kArmedRules[kind(id).armed_rule];
  }
  /// Finds a name of up to 16 characters; @returns kParamCount if there is none.
  static std::size_t find(const link::ParamName& name);

  /// The value of an integer parameter.
  std::int32_t get_int(Param id) const { return values_[static_cast<std::size_t>(id)].i; }
  /// The value of a float parameter.
  float get_float(Param id) const { return values_[static_cast<std::size_t>(id)].f; }
  /// An integer parameter that is not 0.
  bool get_bool(Param id) const { return get_int(id) != 0; }
  /// The 32 bits of the value, as the link and storage carry them.
  std::uint32_t bits(Param id) const;

  /// Sets from raw bits as they come from the link or storage, with every check.
  SetResult set_bits(Param id, std::uint8_t type, std::uint32_t bits, bool armed);
  /// Sets from inside the firmware: same range check, no lock.
  SetResult set_int(Param id, std::int32_t value);
  /// As set_int().
  SetResult set_float(Param id, float value);

  /// All values to their defaults; each one that differs is marked as changed.
  void reset_to_defaults();

  /// True if `value` is in range for `id`, the sentinel, or the default.
  static bool in_range(Param id, ParamValue value);

  /// There are changes that the modules have not applied yet.
  bool has_changes() const { return any_changed_; }
  /// Returns those changes and clears them.
  ChangeSet take_changes();
  /// Removes one change that is not yet reported to the companion, lowest index first.
  /// @returns false if there is none.
  bool take_unreported(Param& id);
  /// The value is to be reported to the companion.
  void mark_unreported(Param id);
  /// The value was reported to the companion.
  void mark_reported(Param id);
  bool has_unreported() const { return unreported_count_ > 0; }
  /// Every value was reported to the companion.
  void mark_all_reported() {
    unreported_.reset();
    unreported_count_ = 0;
  }

  /// Number of changes of the values that storage keeps.
  struct Version {
    std::uint32_t gyro_bias{};
    std::uint32_t others{};
  };
  Version version() const { return now_; }
  /// A value differs from the stored one. BARO_BIAS and GROUND_LEVEL do not count: they are measured
  /// at every start and not used.
  bool unsaved() const { return others_unsaved() || now_.gyro_bias != saved_.gyro_bias; }
  /// The same, the three gyro biases aside.
  bool others_unsaved() const { return now_.others != saved_.others; }
  /// Storage holds the values of that version.
  void mark_saved(Version stored) { saved_ = stored; }
  /// Storage holds the gyro biases of that version.
  void mark_gyro_bias_saved(Version stored) { saved_.gyro_bias = stored.gyro_bias; }

 private:
  static link::ParamName name(Param id);
  SetResult store(Param id, ParamValue value);

  std::array<ParamValue, kParamCount> values_;
  ChangeSet changed_;
  ChangeSet unreported_;
  std::uint16_t first_unreported_{0};  ///< None below it.
  bool any_changed_{false};
  std::uint16_t unreported_count_{0};
  Version now_{};
  Version saved_{};
};

}  // namespace rosflight::core
