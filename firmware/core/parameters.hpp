// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <bitset>

#include "firmware/core/parameter_table.hpp"  // made from parameters.csv at build time

namespace rosflight::core {

/// Answer to a request to change a parameter.
enum class [[nodiscard]] SetResult : std::uint8_t {
  kChanged,      ///< Stored; the change is marked for the modules and for the companion.
  kUnchanged,    ///< Already had that value.
  kOutOfRange,   ///< Outside min..max and not the sentinel, or not finite. Value kept.
  kWrongType,    ///< Type code is not the stored one. Value kept.
  kLockedArmed,  ///< Dangerous to change in flight. Value kept.
  kTooFar,       ///< Further than one message may go while armed. Value kept.
};

/// The live parameter table: values in RAM, names, types and limits from parameters.csv. Knows
/// which values changed since the modules were last told, and since the companion was last
/// told. 1.5 kB.
class Parameters {
 public:
  using ChangeSet = std::bitset<kParamCount>;

  Parameters() { reset_to_defaults(); }

  static constexpr const ParamRow& row(Param id) {
    return detail::kParamTable[static_cast<std::size_t>(id)];
  }
  static constexpr const ArmedRule& armed_rule(Param id) {
    return detail::kArmedRules[row(id).armed_rule];
  }
  /// Finds a name of up to 16 characters; @returns kParamCount if there is none.
  static std::size_t find(const link::ParamName& name);

  std::int32_t get_int(Param id) const { return values_[static_cast<std::size_t>(id)].i; }
  float get_float(Param id) const { return values_[static_cast<std::size_t>(id)].f; }
  bool get_bool(Param id) const { return get_int(id) != 0; }
  std::uint32_t bits(Param id) const;

  /// Sets from raw bits as they come from the link or storage, with every check.
  SetResult set_bits(Param id, std::uint8_t type, std::uint32_t bits, bool armed);
  /// Sets from inside the firmware: same range check, no lock.
  SetResult set_int(Param id, std::int32_t value);
  SetResult set_float(Param id, float value);

  /// All values to their defaults; each one that differs is marked as changed.
  void reset_to_defaults();

  /// True if `value` is in range for `id`, the sentinel, or the default.
  static bool in_range(Param id, ParamValue value);

  /// Changes that modules have not seen yet.
  bool has_changes() const { return any_changed_; }
  ChangeSet take_changes();
  /// Changes that the companion has not been told yet; one is taken per call, lowest index first.
  bool take_unreported(Param& id);
  void mark_unreported(Param id);
  void mark_reported(Param id);
  bool has_unreported() const { return unreported_count_ > 0; }
  void mark_all_reported() {
    unreported_.reset();
    unreported_count_ = 0;
  }

  /// How often values changed that storage keeps.
  struct Version {
    std::uint32_t gyro_bias{};
    std::uint32_t others{};
  };
  Version version() const { return now_; }
  /// Some value differs from what storage holds. BARO_BIAS and GROUND_LEVEL do not count: they are
  /// measured at every start and nothing uses them.
  bool unsaved() const { return others_unsaved() || now_.gyro_bias != saved_.gyro_bias; }
  /// The same, the three gyro biases aside.
  bool others_unsaved() const { return now_.others != saved_.others; }
  /// Storage holds the values of that version.
  void mark_saved(Version stored) { saved_ = stored; }
  void mark_gyro_bias_saved(Version stored) { saved_.gyro_bias = stored.gyro_bias; }

 private:
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
