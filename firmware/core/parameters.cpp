// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace rosflight::core {
namespace {

std::uint32_t raw(ParamValue value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

ParamValue from_bits(ParamType type, std::uint32_t bits) {
  if (type == ParamType::kInt32) return ParamValue{static_cast<std::int32_t>(bits)};
  float value = 0.0f;
  std::memcpy(&value, &bits, sizeof value);
  return ParamValue{value};
}

/// Whether `rule` permits a float to change from `from` to `to`; comparisons with a NaN are false.
bool near_enough(const ArmedRule& rule, float from, float to) {
  if (rule.only_up && !(to >= from)) return false;
  if (std::abs(to - from) <= rule.step) return true;
  const float a = std::abs(from);
  const float b = std::abs(to);
  return std::signbit(from) == std::signbit(to) && a > 0.0f && b > 0.0f && b <= rule.factor * a &&
         a <= rule.factor * b;
}

}  // namespace

/// One by one: names come by hand, in a list of the companion, or from stored parameters of another version.
std::size_t Parameters::find(const link::ParamName& name) {
  link::ParamName each{};
  const std::uint8_t* packed = detail::kParamNames.data();
  std::size_t index = 0;
  for (; index < kParamCount; ++index) {
    packed = next_name(packed, each);
    if (std::strncmp(each.data(), name.data(), name.size()) == 0) break;
  }
  return index;
}

link::ParamName Parameters::name(Param id) {
  const auto index = static_cast<std::size_t>(id);
  link::ParamName name{};
  const std::uint8_t* packed =
      &detail::kParamNames[detail::kNameBlocks[index / detail::kNamesPerBlock]];
  for (std::size_t k = 0; k <= index % detail::kNamesPerBlock; ++k)
    packed = next_name(packed, name);
  return name;
}

std::uint32_t Parameters::bits(Param id) const {
  return raw(values_[static_cast<std::size_t>(id)]);
}

bool Parameters::in_range(Param id, ParamValue value) {
  const ParamKind& r = kind(id);
  if (r.type == ParamType::kFloat) {
    const float v = value.f;
    if (!std::isfinite(v)) return false;
    return (v >= r.min && v <= r.max) || v == r.sentinel || v == r.initial.f;
  }
  const double v = value.i;  // exact, a float would round large integers
  return (v >= static_cast<double>(r.min) && v <= static_cast<double>(r.max)) ||
         v == static_cast<double>(r.sentinel) || value.i == r.initial.i;
}

SetResult Parameters::set_bits(Param id, std::uint8_t type, std::uint32_t bits, bool armed) {
  const ParamKind& r = kind(id);
  if (type != static_cast<std::uint8_t>(r.type)) return SetResult::kWrongType;
  const ParamValue value = from_bits(r.type, bits);
  if (!in_range(id, value)) return SetResult::kOutOfRange;
  if (bits == this->bits(id)) return SetResult::kUnchanged;
  if (armed) {
    const ArmedRule& rule = armed_rule(id);
    if (rule.factor == 0.0f) return SetResult::kLockedArmed;
    if (r.type == ParamType::kFloat && !near_enough(rule, get_float(id), value.f)) {
      return SetResult::kTooFar;
    }
  }
  return store(id, value);
}

SetResult Parameters::set_int(Param id, std::int32_t value) {
  const ParamValue v{value};
  if (kind(id).type != ParamType::kInt32) return SetResult::kWrongType;
  return in_range(id, v) ? store(id, v) : SetResult::kOutOfRange;
}

SetResult Parameters::set_float(Param id, float value) {
  const ParamValue v{value};
  if (kind(id).type != ParamType::kFloat) return SetResult::kWrongType;
  return in_range(id, v) ? store(id, v) : SetResult::kOutOfRange;
}

SetResult Parameters::store(Param id, ParamValue value) {
  const auto index = static_cast<std::size_t>(id);
  if (raw(values_[index]) == raw(value)) return SetResult::kUnchanged;
  values_[index] = value;
  changed_.set(index);
  any_changed_ = true;
  mark_unreported(id);
  if (id >= Param::kGyroXBias && id <= Param::kGyroZBias) {
    ++now_.gyro_bias;
  } else if (id != Param::kBaroBias && id != Param::kGroundLevel) {
    ++now_.others;
  }
  return SetResult::kChanged;
}

void Parameters::reset_to_defaults() {
  for (std::size_t k = 0; k < kParamCount; ++k) {
    const auto id = static_cast<Param>(k);
    static_cast<void>(store(id, kind(id).initial));
  }
}

Parameters::ChangeSet Parameters::take_changes() {
  const ChangeSet taken = changed_;
  changed_.reset();
  any_changed_ = false;
  return taken;
}

bool Parameters::take_unreported(Param& id) {
  if (unreported_count_ == 0) return false;
  while (!unreported_[first_unreported_]) ++first_unreported_;
  id = static_cast<Param>(first_unreported_);
  mark_reported(id);
  return true;
}

void Parameters::mark_unreported(Param id) {
  const auto index = static_cast<std::uint16_t>(id);
  if (!unreported_[index]) ++unreported_count_;
  unreported_.set(index);
  first_unreported_ = std::min(first_unreported_, index);
}

void Parameters::mark_reported(Param id) {
  const auto index = static_cast<std::size_t>(id);
  if (!unreported_[index]) return;
  unreported_.reset(index);
  --unreported_count_;
}

}  // namespace rosflight::core
