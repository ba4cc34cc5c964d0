// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <bit>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "link/messages.hpp"

namespace rosflight::companion {

/// A typed parameter value: 32 bits and their type.
struct ParameterValue {
  link::ParamType type{link::ParamType::kInt32};
  link::ParamBits bits{};

  /// The value of a number, with its type.
  static ParameterValue of(std::int32_t v) {
    return {link::ParamType::kInt32, {std::bit_cast<std::uint32_t>(v)}};
  }
  static ParameterValue of(float v) {
    return {link::ParamType::kFloat, {std::bit_cast<std::uint32_t>(v)}};
  }

  std::int32_t as_int32() const { return std::bit_cast<std::int32_t>(bits.bits); }
  float as_float() const { return std::bit_cast<float>(bits.bits); }
  /// The value as a double, exact for both types.
  double number() const;
  /// Shortest text that reads back as the same value: "3", "0.1", "1.0", ".nan".
  std::string text() const;
};

/// Equal as numbers of the same type (so -0 is 0), or both not a number.
bool same_value(const ParameterValue& a, const ParameterValue& b);

/// A number as a value of `type`; nothing, and the reason in `error`, if it has no such value.
std::optional<ParameterValue> to_value(double number, link::ParamType type, std::string& error);

/// "int32" or "float".
const char* type_name(link::ParamType type);

/// NUL-padded name; nothing if `text` is empty, longer than 16 or has other characters than A-Z a-z
/// 0-9 _.
std::optional<link::ParamName> make_name(std::string_view text);

/// One line of a parameter set.
struct NamedValue {
  std::string name;
  ParameterValue value;
};

/// A list of values without doubles: a file, the FCU's table, the defaults.
using ParameterSet = std::vector<NamedValue>;

/// One difference between two sets.
struct ParameterDifference {
  enum class Kind : std::uint8_t { kValue, kType, kOnlyLeft, kOnlyRight };
  Kind kind{};
  std::string name;
  ParameterValue left{};
  ParameterValue right{};

  std::string text() const;
};

/// All differences, sorted by name.
std::vector<ParameterDifference> diff(const ParameterSet& left, const ParameterSet& right);

}  // namespace rosflight::companion
