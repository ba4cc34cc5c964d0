// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "link/codec.hpp"
#include "link/sequence.hpp"

namespace rosflight::link {

namespace lean {

/// What the frames of one end have in common.
struct Sender {
  std::uint32_t schema{};
  std::uint8_t sequence{};
};

inline constexpr std::size_t kMaxLeanFrameBytes = 98;  ///< Counters; checked in the source.

}  // namespace lean

/// The lean codec: our structs as they are, in frames that a receiver finds at sight.
///
///     FF | code | id | sequence | payload n | checksum, low byte first
///
/// FF begins a frame and occurs nowhere else: the bytes from id to checksum are encoded by Consistent
/// Overhead Byte Stuffing (Cheshire & Baker, IEEE/ACM Trans. Networking 7(2), 1999) with FF as the
/// byte that must not occur. Each FF among them is replaced by 255 less the distance to the next
/// one, or to the end of the frame; `code` is the same for the first. So a frame always has
/// 6 bytes more than its payload. (FF and not 0, because most bytes of the messages are 0.)
///
/// The id is the index in link::Message, the payload the fields of lean/layout.hpp, little-endian
/// without gaps, so the id determines n. The checksum, CRC-16/KERMIT over id, sequence and payload, is
/// xored with both halves of the schema's hash, for a heartbeat with nothing: its payload is type
/// and schema. The heartbeat of a peer with another schema is decoded, so that it can be rejected: mismatch().
///
/// Receiver. A frame counts if id, length and checksum are right; an FF at any time begins a new
/// one, so only its own bytes can invalidate a frame. Values are treated as by MavlinkCodec.
///
/// Point to point: frames carry no system id. Owns about 0.3 kB; no heap. Cost: docs/link.md.
class LeanCodec final : public Codec {
 public:
  /// @param schema  the hash that this end sends and accepts; 0 is that of lean/layout.hpp. Others are
  /// for tests.
  explicit LeanCodec(std::uint32_t schema = 0);

  bool encode(const Message& message, Frame& frame) override;
  Decoded decode(const std::uint8_t* data, std::size_t size) override;
  const Message& message() const override { return message_; }
  void set_system_id(std::uint8_t /*id*/) override {}
  const Counters& counters() const override { return counters_; }
  const SchemaMismatch* mismatch() const override { return refused_ ? &mismatch_ : nullptr; }

 private:
  void begin_frame();
  void take_prefix(std::uint8_t byte);
  bool accept();
  bool accept_greeting(const std::uint8_t* payload);

  lean::Sender next_;
  bool refused_{false};
  std::uint8_t held_size_{0};
  std::uint8_t wanted_{0};  ///< Bytes of this frame behind its FF, as far as known; 0: no frame.
  SequenceWatch sequence_;
  SchemaMismatch mismatch_;
  Message message_;
  Counters counters_{};
  std::array<std::uint8_t, lean::kMaxLeanFrameBytes> held_{};  ///< The frame, from its code on.
};

}  // namespace rosflight::link
