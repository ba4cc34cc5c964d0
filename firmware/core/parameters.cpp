// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/parameters.hpp"

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

}  // namespace

std::size_t Parameters::find(const link::ParamName& name) {
  std::size_t index = 0;
  while (index < kParamCount &&
         std::strncmp(detail::kParamTable[index].name.data(), name.data(), name.size()) != 0) {
    ++index;
  }
  return index;
}

std::uint32_t Parameters::bits(Param id) const {
  return raw(values_[static_cast<std::size_t>(id)]);
}

bool Parameters::in_range(Param id, ParamValue value) {
  const ParamRow& r = row(id);
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
  const ParamRow& r = row(id);
  if (type != static_cast<std::uint8_t>(r.type)) return SetResult::kWrongType;
  const ParamValue value = from_bits(r.type, bits);
  if (!in_range(id, value)) return SetResult::kOutOfRange;
  if (bits == this->bits(id)) return SetResult::kUnchanged;
  if (armed && r.locked_while_armed) return SetResult::kLockedArmed;
  return store(id, value);
}

SetResult Parameters::set_int(Param id, std::int32_t value) {
  const ParamValue v{value};
  if (row(id).type != ParamType::kInt32) return SetResult::kWrongType;
  return in_range(id, v) ? store(id, v) : SetResult::kOutOfRange;
}

SetResult Parameters::set_float(Param id, float value) {
  const ParamValue v{value};
  if (row(id).type != ParamType::kFloat) return SetResult::kWrongType;
  return in_range(id, v) ? store(id, v) : SetResult::kOutOfRange;
}

SetResult Parameters::store(Param id, ParamValue value) {
  const auto index = static_cast<std::size_t>(id);
  if (raw(values_[index]) == raw(value)) return SetResult::kUnchanged;
  values_[index] = value;
  changed_.set(index);
  unreported_.set(index);
  any_changed_ = true;
  any_unreported_ = true;
  unsaved_ = true;
  return SetResult::kChanged;
}

void Parameters::reset_to_defaults() {
  for (std::size_t k = 0; k < kParamCount; ++k) {
    static_cast<void>(store(static_cast<Param>(k), detail::kParamTable[k].initial));
  }
}

Parameters::ChangeSet Parameters::take_changes() {
  const ChangeSet taken = changed_;
  changed_.reset();
  any_changed_ = false;
  return taken;
}

bool Parameters::take_unreported(Param& id) {
  if (!any_unreported_) return false;
  for (std::size_t k = 0; k < kParamCount; ++k) {
    if (!unreported_.test(k)) continue;
    unreported_.reset(k);
    id = static_cast<Param>(k);
    return true;
  }
  any_unreported_ = false;
  return false;
}

}  // namespace rosflight::core
