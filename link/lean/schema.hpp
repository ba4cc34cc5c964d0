// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>
#include <variant>

#include "link/lean/layout.hpp"

/// The layouts on which both ends must agree, as one number: FNV-1a, 32 bits (Fowler, Noll, Vo; offset
/// 2166136261, prime 16777619), of a text with one line per message but the heartbeat, in the order
/// of link::Message:
///
///     3 ParamRequestRead target_system:u8 index:i16 name:c8[16]\n
///
/// A type is a letter (u, i, f, b for truth values, c for characters) and its bits; enumerations
/// are numbers. The lines are those of the table in docs/link.md, which a test compares.
namespace rosflight::link::lean {

inline constexpr std::size_t kAlternatives = std::variant_size_v<Message>;

/// The struct that is transmitted for a message: the message itself, a Greeting for a heartbeat.
template <std::size_t kId>
struct OnWire {
  using Type = std::variant_alternative_t<kId, Message>;
};
template <>
struct OnWire<1> {
  static_assert(std::is_same_v<std::variant_alternative_t<1, Message>, Heartbeat>);
  using Type = Greeting;
};

/// Calls put(char) for each character of the number.
template <typename Put>
constexpr void spell(std::size_t number, Put&& put) {
  if (number >= 10) spell(number / 10, put);
  put(static_cast<char>('0' + number % 10));
}

template <typename Put>
constexpr void spell(const char* text, Put&& put) {
  for (; *text != 0; ++text) put(*text);
}

/// " name:type" for each field of M.
template <typename M, typename Put>
constexpr void spell_fields(Put&& put) {
  each_field<M>([&put](auto one) {
    constexpr Shape kShape = decltype(wire_of(one))::shape();
    put(' ');
    spell(one.name, put);
    put(':');
    put(kShape.letter);
    spell(kShape.item_bytes * 8, put);
    if (kShape.count == 1) return;
    put('[');
    spell(kShape.count, put);
    put(']');
  });
}

/// The line of one message.
template <std::size_t kId, typename Put>
constexpr void spell_message(Put&& put) {
  using M = typename OnWire<kId>::Type;
  spell(kId, put);
  put(' ');
  spell(Layout<M>::kName, put);
  spell_fields<M>(put);
  put('\n');
}

/// The hash of the lines of all messages but the heartbeat.
template <std::size_t... kOthers>
constexpr std::uint32_t hash_schema(std::index_sequence<kOthers...>) {
  constexpr std::uint32_t kOffset = 2166136261u;
  constexpr std::uint32_t kPrime = 16777619u;
  std::uint32_t hash = kOffset;
  const auto put = [&hash](char c) { hash = (hash ^ static_cast<std::uint8_t>(c)) * kPrime; };
  (spell_message<kOthers + 2>(put), ...);
  return hash;
}

inline constexpr std::uint32_t kSchema = hash_schema(std::make_index_sequence<kAlternatives - 2>{});

}  // namespace rosflight::link::lean
