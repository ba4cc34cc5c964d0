// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <ostream>
#include <rcl_interfaces/msg/parameter_type.hpp>
#include <rcl_interfaces/msg/parameter_value.hpp>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace rclcpp {

enum ParameterType : std::uint8_t {
  PARAMETER_NOT_SET = rcl_interfaces::msg::ParameterType::PARAMETER_NOT_SET,
  PARAMETER_BOOL = rcl_interfaces::msg::ParameterType::PARAMETER_BOOL,
  PARAMETER_INTEGER = rcl_interfaces::msg::ParameterType::PARAMETER_INTEGER,
  PARAMETER_DOUBLE = rcl_interfaces::msg::ParameterType::PARAMETER_DOUBLE,
  PARAMETER_STRING = rcl_interfaces::msg::ParameterType::PARAMETER_STRING,
  PARAMETER_BYTE_ARRAY = rcl_interfaces::msg::ParameterType::PARAMETER_BYTE_ARRAY,
  PARAMETER_BOOL_ARRAY = rcl_interfaces::msg::ParameterType::PARAMETER_BOOL_ARRAY,
  PARAMETER_INTEGER_ARRAY = rcl_interfaces::msg::ParameterType::PARAMETER_INTEGER_ARRAY,
  PARAMETER_DOUBLE_ARRAY = rcl_interfaces::msg::ParameterType::PARAMETER_DOUBLE_ARRAY,
  PARAMETER_STRING_ARRAY = rcl_interfaces::msg::ParameterType::PARAMETER_STRING_ARRAY,
};

std::string to_string(ParameterType type);
std::ostream& operator<<(std::ostream& out, ParameterType type);

/// A value was asked for as a type it does not have.
class ParameterTypeException : public std::runtime_error {
 public:
  ParameterTypeException(ParameterType expected, ParameterType actual)
      : std::runtime_error("expected [" + to_string(expected) + "] got [" + to_string(actual) +
                           "]") {}
};

namespace detail {
template <typename>
inline constexpr bool kIsVector = false;
template <typename T>
inline constexpr bool kIsVector<std::vector<T>> = true;

/// What rclcpp makes a parameter value from. Other integers would have to be converted by a guess.
template <typename T, typename... Known>
inline constexpr bool kIsOneOf = (std::is_same_v<T, Known> || ...);
template <typename T>
inline constexpr bool kMakesParameter =
    kIsOneOf<T, bool, int, std::int64_t, float, double, std::string> ||
    std::is_convertible_v<T, const char*> ||
    kIsOneOf<T, std::vector<std::uint8_t>, std::vector<bool>, std::vector<int>,
             std::vector<std::int64_t>, std::vector<float>, std::vector<double>,
             std::vector<std::string>>;

/// The parameter type that holds a C++ type.
template <typename T>
constexpr ParameterType parameter_type_of() {
  if constexpr (std::is_same_v<T, bool>) {
    return PARAMETER_BOOL;
  } else if constexpr (std::is_integral_v<T>) {
    return PARAMETER_INTEGER;
  } else if constexpr (std::is_floating_point_v<T>) {
    return PARAMETER_DOUBLE;
  } else if constexpr (std::is_convertible_v<T, std::string>) {
    return PARAMETER_STRING;
  } else {
    static_assert(kIsVector<T>, "no parameter holds this type");
    using Element = typename T::value_type;
    if constexpr (std::is_same_v<Element, std::uint8_t>) {
      return PARAMETER_BYTE_ARRAY;
    } else if constexpr (std::is_same_v<Element, bool>) {
      return PARAMETER_BOOL_ARRAY;
    } else if constexpr (std::is_integral_v<Element>) {
      return PARAMETER_INTEGER_ARRAY;
    } else if constexpr (std::is_floating_point_v<Element>) {
      return PARAMETER_DOUBLE_ARRAY;
    } else {
      return PARAMETER_STRING_ARRAY;
    }
  }
}
}  // namespace detail

/// A value of one of the types above, or none.
class ParameterValue {
  // First, since what follows takes their return types.
  template <typename T>
  static auto convert(const T& value) {
    constexpr auto kType = detail::parameter_type_of<T>();
    if constexpr (kType == PARAMETER_INTEGER) {
      return static_cast<std::int64_t>(value);
    } else if constexpr (kType == PARAMETER_DOUBLE) {
      return static_cast<double>(value);
    } else {
      return value;
    }
  }
  template <ParameterType kType, typename Value>
  static auto& member(Value& value) {
    if constexpr (kType == PARAMETER_BOOL) {
      return value.bool_value;
    } else if constexpr (kType == PARAMETER_INTEGER) {
      return value.integer_value;
    } else if constexpr (kType == PARAMETER_DOUBLE) {
      return value.double_value;
    } else if constexpr (kType == PARAMETER_STRING) {
      return value.string_value;
    } else if constexpr (kType == PARAMETER_BYTE_ARRAY) {
      return value.byte_array_value;
    } else if constexpr (kType == PARAMETER_BOOL_ARRAY) {
      return value.bool_array_value;
    } else if constexpr (kType == PARAMETER_INTEGER_ARRAY) {
      return value.integer_array_value;
    } else if constexpr (kType == PARAMETER_DOUBLE_ARRAY) {
      return value.double_array_value;
    } else {
      static_assert(kType == PARAMETER_STRING_ARRAY);
      return value.string_array_value;
    }
  }

 public:
  using Message = rcl_interfaces::msg::ParameterValue;
  ParameterValue() = default;
  explicit ParameterValue(const Message& message) : value_(message) {}
  explicit ParameterValue(const char* value) : ParameterValue(std::string(value)) {}
  template <typename T, typename = std::enable_if_t<!std::is_base_of_v<ParameterValue, T> &&
                                                    !std::is_same_v<T, Message> &&
                                                    !std::is_same_v<T, const char*>>>
  explicit ParameterValue(const T& value) {
    static_assert(detail::kMakesParameter<T>, "no parameter is made from this type");
    value_.type = detail::parameter_type_of<T>();
    if constexpr (std::is_arithmetic_v<T> || std::is_convertible_v<T, std::string>) {
      member<detail::parameter_type_of<T>()>(value_) = convert<T>(value);
    } else {
      auto& held = member<detail::parameter_type_of<T>()>(value_);
      held.assign(value.begin(), value.end());
    }
  }

  ParameterType get_type() const { return static_cast<ParameterType>(value_.type); }
  const Message& to_value_msg() const { return value_; }
  bool operator==(const ParameterValue& other) const { return value_ == other.value_; }
  bool operator!=(const ParameterValue& other) const { return value_ != other.value_; }

  /// Throws ParameterTypeException for any other type than the value's.
  template <ParameterType kType>
  const auto& get() const {
    if (get_type() != kType) throw ParameterTypeException(kType, get_type());
    return member<kType>(value_);
  }
  /// As above, of the type that holds a T: std::int64_t for every integer, double for a float.
  template <typename T>
  const auto& get() const {
    return get<detail::parameter_type_of<T>()>();
  }

 private:
  Message value_;
};

std::string to_string(const ParameterValue& value);

}  // namespace rclcpp
