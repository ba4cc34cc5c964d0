// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <variant>

#include "link/codec.hpp"
#include "link/lean/checksum.hpp"
#include "link/lean/lean_codec.hpp"
#include "link/lean/schema.hpp"
#include "link/lean/stuffing.hpp"

/// One row per alternative of link::Message. Private to the codec.
///
/// Each message has its own encoder, so that lengths are constants in it.
namespace rosflight::link::lean {

inline constexpr std::size_t kGreetingId = 1;
/// Offsets in a frame: FF, code, id, sequence, payload, checksum.
inline constexpr std::size_t kCodeAt = 1, kIdAt = 2, kSequenceAt = 3, kPayloadAt = 4;
inline constexpr std::size_t kChecksumBytes = sizeof(std::uint16_t);
inline constexpr std::size_t kOverheadBytes = kPayloadAt + kChecksumBytes;

/// Both halves of the schema's hash in the checksum of every frame but the greeting.
constexpr unsigned seed_of(std::uint32_t schema) {
  return (schema ^ (schema >> 16)) & 0xFFFFu;
}

struct Row {
  std::uint8_t length;  ///< Payload bytes.
  void (*encode)(const Message& message, Sender sender, Frame& frame);
  void (*unpack)(const std::uint8_t* payload, Message& message);
};

/// The struct that is transmitted for a message.
inline const Greeting to_wire(const Heartbeat& message, Sender sender) {
  return {message.type, sender.schema};
}
/// The same.
template <typename M>
const M& to_wire(const M& message, Sender /*sender*/) {
  return message;  // NOLINT(bugprone-return-const-ref-from-parameter): encode_as() holds it
}

/// Encodes the alternative kId of the message as a frame.
template <std::size_t kId>
void encode_as(const Message& message, Sender sender, Frame& frame) {
  using M = typename OnWire<kId>::Type;
  constexpr std::size_t kChecksumAt = kPayloadAt + payload_bytes<M>();
  constexpr std::size_t kSize = kChecksumAt + kChecksumBytes;
  static_assert(kSize <= kMaxLeanFrameBytes && kSize - kCodeAt <= kMaxStuffedBytes);
  static_assert(kSize <= kMaxFrameBytes);
  const auto* const ours = std::get_if<kId>(&message);
  if (ours == nullptr) return;  // not reached: the row was chosen by the alternative
  std::uint8_t* const bytes = frame.bytes.data();
  bytes[0] = kStart;
  bytes[kIdAt] = static_cast<std::uint8_t>(kId);
  bytes[kSequenceAt] = sender.sequence;
  pack<M>(to_wire(*ours, sender), bytes + kPayloadAt);
  unsigned crc = checksum(bytes + kIdAt, kChecksumAt - kIdAt);
  if constexpr (kId != kGreetingId) crc ^= seed_of(sender.schema);
  bytes[kChecksumAt] = static_cast<std::uint8_t>(crc & 0xFFu);
  bytes[kChecksumAt + 1] = static_cast<std::uint8_t>((crc >> 8) & 0xFFu);
  stuff<kSize - kCodeAt>(bytes + kCodeAt);
  frame.size = kSize;
}

/// Makes `message` the alternative kId with the values of the payload.
template <std::size_t kId>
void unpack_as(const std::uint8_t* payload, Message& message) {
  unpack(payload, message.emplace<kId>());
}

/// The row of alternative kId; an empty one for std::monostate.
template <std::size_t kId>
constexpr Row row() {
  if constexpr (kId == 0) {
    return {};
  } else if constexpr (kId == kGreetingId) {  // decoded by the codec itself
    return {payload_bytes<Greeting>(), &encode_as<kId>, nullptr};
  } else {
    return {payload_bytes<std::variant_alternative_t<kId, Message>>(), &encode_as<kId>,
            &unpack_as<kId>};
  }
}

/// The rows of all alternatives, by id.
template <std::size_t... kIds>
constexpr std::array<Row, sizeof...(kIds)> make_rows(std::index_sequence<kIds...>) {
  return {row<kIds>()...};
}
inline constexpr std::array<Row, kAlternatives> kRows =
    make_rows(std::make_index_sequence<kAlternatives>{});
static_assert(kAlternatives <= kStart, "an id is never FF");

/// Size of the largest frame in bytes.
constexpr std::size_t max_frame_bytes() {
  std::size_t max = 0;
  for (const Row& row : kRows) max = row.length > max ? row.length : max;
  return max + kOverheadBytes;
}
static_assert(max_frame_bytes() == kMaxLeanFrameBytes);

/// Whether messages have this id, and so a row.
constexpr bool is_known(std::size_t id) {
  return id != 0 && id < kRows.size();
}

}  // namespace rosflight::link::lean
