// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "link/messages.hpp"

namespace rosflight::core {

using ParamType = link::ParamType;

/// A parameter's 32 bits: an int32 or a float, its row says which.
union ParamValue {
  constexpr ParamValue() : i{0} {}
  constexpr explicit ParamValue(std::int32_t value) : i{value} {}
  constexpr explicit ParamValue(float value) : f{value} {}
  std::int32_t i;
  float f;
};

/// One row of the parameter table (parameters.csv). Limits of integers are exact in a float.
struct ParamRow {
  link::ParamName name;
  ParamType type;
  bool locked_while_armed;  ///< A change in flight could turn the aircraft over: refused while
                            ///< armed.
  ParamValue initial;
  float min;
  float max;
  float sentinel;  ///< One value outside the range that is allowed too ("none"); else the default.
};

constexpr link::ParamName padded_name(const char* text) {
  link::ParamName name{};
  for (std::size_t k = 0; k < name.size() && text[k] != '\0'; ++k) name[k] = text[k];
  return name;
}

constexpr ParamRow int_row(const char* name, std::int32_t initial, float min, float max,
                           float sentinel, bool locked) {
  return {padded_name(name), ParamType::kInt32, locked, ParamValue{initial}, min, max, sentinel};
}

constexpr ParamRow float_row(const char* name, float initial, float min, float max, float sentinel,
                             bool locked) {
  return {padded_name(name), ParamType::kFloat, locked, ParamValue{initial}, min, max, sentinel};
}

}  // namespace rosflight::core
