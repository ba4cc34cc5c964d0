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
template <typename ReturnT, typename ClassT, typename... Args>
struct Arguments<ReturnT (ClassT::*)(Args...), void> {
  using Type = std::tuple<Args...>;
};
template <typename ReturnT, typename ClassT, typename... Args>
struct Arguments<ReturnT (ClassT::*)(Args...) const, void> {
  using Type = std::tuple<Args...>;
};
template <typename CallbackT>
struct Arguments<CallbackT, std::void_t<decltype(&CallbackT::operator())>>
    : Arguments<decltype(&CallbackT::operator())> {};

/// Does the callback declare exactly these arguments, or none that can be known?
template <typename CallbackT, typename... Args>
inline constexpr bool kDeclares =
    std::is_void_v<typename Arguments<std::decay_t<CallbackT>>::Type> ||
    std::is_same_v<typename Arguments<std::decay_t<CallbackT>>::Type, std::tuple<Args...>>;

}  // namespace rclcpp::detail
