// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "link/messages.hpp"

namespace rosflight::core {

using link::ParamType;

/// The 32 bits of a parameter: an int32 or a float, as the type in its row.
union ParamValue {
  constexpr ParamValue() : i{0} {}
  constexpr explicit ParamValue(std::int32_t value) : i{value} {}
  constexpr explicit ParamValue(float value) : f{value} {}
  std::int32_t i;
  float f;
};

/// The first rows of the table are those of ROSflight 2.x, in its order; rows of our own follow.
inline constexpr std::size_t kReferenceParamCount = 333;

/// How far one message may change a parameter while armed, from v to w:
///
///     either  v w > 0  and  |v| / factor <= |w| <= factor |v|
///     or      |w - v| <= step,   and  w >= v  if `only_up`
///
/// A factor of 0 locks the parameter, an infinite one leaves it open. So a step lets a value of 0,
/// or a tiny one, move and change its sign; without a step no value becomes 0 or leaves 0.
struct ArmedRule {
  float factor;
  float step;
  bool only_up;
};

/// What parameters have in common that differ in their name only. Limits of integers are exact in a float.
struct ParamKind {
  ParamType type;
  std::uint8_t armed_rule;  ///< Which of detail::kArmedRules limits a change while armed.
  ParamValue initial;
  float min;
  float max;
  float sentinel;  ///< One value outside the range that is allowed too ("none"); else the default.
};

/// One row of the parameter table (parameters.csv).
struct ParamRow : ParamKind {
  link::ParamName name;
};

/// A name of up to 16 characters, padded with NUL.
constexpr link::ParamName padded_name(const char* text) {
  link::ParamName name{};
  for (std::size_t k = 0; k < name.size() && text[k] != '\0'; ++k) name[k] = text[k];
  return name;
}

/// Unpacks a name over the one before it. A packed name is a byte, whose upper half is the number of
/// characters that both begin with and whose lower half is the number of its own less 1, and its own.
/// @returns where the next one begins.
inline const std::uint8_t* next_name(const std::uint8_t* packed, link::ParamName& name) {
  const std::size_t shared = *packed >> 4u;
  const std::size_t own = (*packed & 15u) + 1u;
  ++packed;
  std::fill(std::copy_n(packed, own, name.begin() + shared), name.end(), '\0');
  return packed + own;
}

/// A kind of the generated table; arguments as the members of ParamKind.
constexpr ParamKind int_kind(std::int32_t initial, float min, float max, float sentinel,
                             std::uint8_t armed_rule) {
  return {ParamType::kInt32, armed_rule, ParamValue{initial}, min, max, sentinel};
}

/// As int_kind(), for a float.
constexpr ParamKind float_kind(float initial, float min, float max, float sentinel,
                               std::uint8_t armed_rule) {
  return {ParamType::kFloat, armed_rule, ParamValue{initial}, min, max, sentinel};
}

}  // namespace rosflight::core
