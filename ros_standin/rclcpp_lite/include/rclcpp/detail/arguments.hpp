// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tuple>
#include <type_traits>

namespace rclcpp::detail {

/// The arguments a callback declares, as a tuple. rclcpp chooses by them, to the letter: what would
/// merely convert is refused. Nothing for callables that declare none, such as those of std::bind.
template <typename CallbackT, typename = void>
struct Arguments {
  using Type = void;
};
template <typename ReturnT, typename... Args>
struct Arguments<ReturnT (*)(Args...), void> {
  using Type = std::tuple<Args...>;
};
/// The arguments of a call operator. rclcpp knows const ones only: a mutable or noexcept lambda is refused.
struct Refused;
template <typename OperatorT>
struct OperatorArguments {
  using Type = Refused;
};
template <typename ReturnT, typename ClassT, typename... Args>
struct OperatorArguments<ReturnT (ClassT::*)(Args...) const> {
  using Type = std::tuple<Args...>;
};
template <typename CallbackT>
struct Arguments<CallbackT, std::void_t<decltype(&CallbackT::operator())>>
    : OperatorArguments<decltype(&CallbackT::operator())> {};

/// Does the callback declare exactly these arguments, or none that can be known?
template <typename CallbackT, typename... Args>
inline constexpr bool kDeclares =
    std::is_void_v<typename Arguments<std::decay_t<CallbackT>>::Type> ||
    std::is_same_v<typename Arguments<std::decay_t<CallbackT>>::Type, std::tuple<Args...>>;

/// Is it no callable that rclcpp refuses whatever its arguments are?
template <typename CallbackT>
inline constexpr bool kHasConstCall =
    !std::is_same_v<typename Arguments<std::decay_t<CallbackT>>::Type, Refused>;

}  // namespace rclcpp::detail
