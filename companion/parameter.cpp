// SPDX-License-Identifier: BSD-3-Clause
#include "companion/parameter.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace rosflight::companion {

double ParameterValue::number() const {
  return type == link::ParamType::kInt32 ? static_cast<double>(as_int32())
                                         : static_cast<double>(as_float());
}

std::string ParameterValue::text() const {
  if (type == link::ParamType::kInt32) {
    return std::to_string(as_int32());
  }
  const float v = as_float();
  if (std::isnan(v)) {
    return ".nan";
  }
  if (std::isinf(v)) {
    return v > 0.0f ? ".inf" : "-.inf";
  }
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, v).ptr;
  std::string text(buffer, end);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

bool same_value(const ParameterValue& a, const ParameterValue& b) {
  if (a.type != b.type) {
    return false;
  }
  if (a.bits.bits == b.bits.bits) {
    return true;
  }
  return a.type == link::ParamType::kFloat &&
         (a.as_float() == b.as_float() || (std::isnan(a.as_float()) && std::isnan(b.as_float())));
}

std::optional<ParameterValue> to_value(double number, link::ParamType type, std::string& error) {
  if (!std::isfinite(number)) {
    error = "not a finite number";
    return std::nullopt;
  }
  if (type == link::ParamType::kFloat) {
    // The shortest text of the largest float lies above it: what rounds to it counts.
    constexpr double kRoundsToInfinity = 0x1.ffffffp127;
    if (std::abs(number) >= kRoundsToInfinity) {
      error = "too large for a float";
      return std::nullopt;
    }
    return ParameterValue::of(static_cast<float>(number));
  }
  if (number != std::trunc(number)) {
    error = "must be a whole number";
    return std::nullopt;
  }
  if (number < static_cast<double>(std::numeric_limits<std::int32_t>::min()) ||
      number > static_cast<double>(std::numeric_limits<std::int32_t>::max())) {
    error = "too large for an int32";
    return std::nullopt;
  }
  return ParameterValue::of(static_cast<std::int32_t>(number));
}

const char* type_name(link::ParamType type) {
  return type == link::ParamType::kInt32 ? "int32" : "float";
}

std::optional<link::ParamName> make_name(std::string_view text) {
  const auto allowed = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  if (text.empty() || text.size() > link::kParamNameLength ||
      !std::all_of(text.begin(), text.end(), allowed)) {
    return std::nullopt;
  }
  link::ParamName name{};
  std::copy(text.begin(), text.end(), name.begin());
  return name;
}

std::string ParameterDifference::text() const {
  switch (kind) {
    case Kind::kValue:
      return name + ": " + left.text() + " -> " + right.text();
    case Kind::kType:
      return name + ": " + type_name(left.type) + " -> " + type_name(right.type);
    case Kind::kOnlyLeft:
      return name + ": " + left.text() + " -> (none)";
    case Kind::kOnlyRight:
      return name + ": (none) -> " + right.text();
  }
  return name;
}

std::vector<ParameterDifference> diff(const ParameterSet& left, const ParameterSet& right) {
  using Kind = ParameterDifference::Kind;
  const auto by_name = [](const NamedValue* a, const NamedValue* b) { return a->name < b->name; };
  const auto sorted = [&](const ParameterSet& set) {
    std::vector<const NamedValue*> view;
    view.reserve(set.size());
    for (const NamedValue& entry : set) {
      view.push_back(&entry);
    }
    std::sort(view.begin(), view.end(), by_name);
    return view;
  };
  const auto l = sorted(left);
  const auto r = sorted(right);
  std::vector<ParameterDifference> result;
  auto i = l.begin();
  auto j = r.begin();
  while (i != l.end() || j != r.end()) {
    if (j == r.end() || (i != l.end() && (*i)->name < (*j)->name)) {
      result.push_back({Kind::kOnlyLeft, (*i)->name, (*i)->value, {}});
      ++i;
    } else if (i == l.end() || (*j)->name < (*i)->name) {
      result.push_back({Kind::kOnlyRight, (*j)->name, {}, (*j)->value});
      ++j;
    } else {
      if ((*i)->value.type != (*j)->value.type) {
        result.push_back({Kind::kType, (*i)->name, (*i)->value, (*j)->value});
      } else if (!same_value((*i)->value, (*j)->value)) {
        result.push_back({Kind::kValue, (*i)->name, (*i)->value, (*j)->value});
      }
      ++i;
      ++j;
    }
  }
  return result;
}

}  // namespace rosflight::companion
