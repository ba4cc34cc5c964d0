// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>

#include "link/codec.hpp"
#include "link/lean/lean_codec.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace rosflight::link {

/// For a companion that does not know what its FCU speaks: listens for both protocols and goes on
/// in the one that first makes a whole message. An FCU talks without being asked, so that takes one
/// frame.
///
/// Until then it speaks MAVLink, which a lean FCU takes for noise; so the first thing said in lean
/// is a heartbeat, in one piece with the message that follows. An FCU that was exchanged for
/// one of the other protocol is noticed when kDoubt bytes in a row held no message. The result does
/// not depend on how the bytes were split over calls.
class DetectingCodec final : public Codec {
 public:
  /// 45 ms of a 921 600 baud line at its limit, 16 of the longest frames.
  static constexpr std::size_t kDoubt = 4096;

  enum class Protocol : std::uint8_t { kUnknown, kMavlink, kLean };

  DetectingCodec() = default;
  /// @param schema  of the lean end, for tests.
  explicit DetectingCodec(std::uint32_t schema) : lean_{schema} {}

  Protocol protocol() const { return protocol_; }

  bool encode(const Message& message, Frame& frame) override;
  Decoded decode(const std::uint8_t* data, std::size_t size) override;
  const Message& message() const override { return active().message(); }
  void set_system_id(std::uint8_t id) override;
  /// Those of the protocol in use; of MAVLink as long as none is.
  const Counters& counters() const override { return active().counters(); }
  /// A lean peer of another schema is known by its greeting, although nothing of it is understood.
  const SchemaMismatch* mismatch() const override { return lean_.mismatch(); }

 private:
  const Codec& active() const;
  Codec& active();
  Decoded listen(const std::uint8_t* data, std::size_t size);

  MavlinkCodec mavlink_{{1, MavlinkCodec::kCompanionComponent}};
  LeanCodec lean_;
  Protocol protocol_{Protocol::kUnknown};
  bool greet_{false};            ///< The FCU has not heard of us.
  std::size_t silent_bytes_{0};  ///< Since the last message.
};

}  // namespace rosflight::link
