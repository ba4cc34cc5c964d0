// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "link/codec.hpp"
#include "link/sequence.hpp"

namespace rosflight::link {

namespace mavlink {

struct Row;

/// The messages of an end. A companion's program, and tests that are both ends, have all of them; an FCU
/// neither encodes what only a companion sends nor decodes what only an FCU sends, for half of the code.
struct Table;
const Table& all_messages();
const Table& fcu_messages();

/// Bytes 2 to 5 of a frame.
struct Sender {
  std::uint8_t sequence{};
  std::uint8_t system_id{};
  std::uint8_t component_id{};
  std::uint8_t message_id{};
};

}  // namespace mavlink

/// The default codec: MAVLink 1.0 frames of the dialect in rosflight.xml, as ROSflight 2.x uses
/// it (release 2.0.1; ids and layouts: docs/link.md).
///
///     FE | length n | sequence | system | component | id | payload n | checksum, low byte first
///
/// Receiver. A frame is accepted if its id is known and its checksum is right; its length need not
/// be that of the message: missing bytes are read as zero, surplus ones are ignored. Bytes that are
/// no frame are searched again from the byte after their start byte, so noise never hides a good
/// frame. The result does not depend on how the bytes were divided into calls. Senders are not
/// checked; gaps of sequence numbers are counted. Values are not checked either (NaN passes,
/// enumerators may be out of range), except texts: they are cleared behind the first NUL, and a text
/// of 50 characters loses its last, so that it always ends with NUL.
///
/// Owns about 0.4 kB; no heap. Cost: docs/link.md.
class MavlinkCodec final : public Codec {
 public:
  static constexpr std::uint8_t kFcuComponent = 250;
  static constexpr std::uint8_t kCompanionComponent = 50;

  struct Identity {
    std::uint8_t system_id{1};
    /// 250 is an FCU: its PARAM_VALUE carries component 0, as ROSflight's does.
    std::uint8_t component_id{kFcuComponent};
  };

  /// @param identity  of this end; the sequence starts at 0.
  explicit MavlinkCodec(Identity identity) : MavlinkCodec(identity, mavlink::all_messages()) {}
  /// With fcu_messages() encode() returns false for what a companion sends, and a good frame of what only an
  /// FCU sends is counted and received as std::monostate.
  MavlinkCodec(Identity identity, const mavlink::Table& messages)
      : messages_{&messages}, next_{0, identity.system_id, identity.component_id, 0} {}

  bool encode(const Message& message, Frame& frame) override;
  Decoded decode(const std::uint8_t* data, std::size_t size) override;
  const Message& message() const override { return message_; }
  void set_system_id(std::uint8_t id) override { next_.system_id = id; }
  const Counters& counters() const override { return counters_; }

 private:
  bool decode_held(const std::uint8_t* data, std::size_t size, Decoded& result);
  void hold(const std::uint8_t* data, std::size_t size);
  void accept(const std::uint8_t* frame, const mavlink::Row& row);

  const mavlink::Table* messages_;
  mavlink::Sender next_;
  SequenceWatch sequence_;
  std::uint16_t held_size_{0};
  Message message_;
  Counters counters_{};
  std::array<std::uint8_t, kMaxFrameBytes> held_{};  ///< Starts with a start byte, unless empty.
};

}  // namespace rosflight::link
