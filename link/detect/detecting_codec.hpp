// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>

#include "link/codec.hpp"
#include "link/lean/lean_codec.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace rosflight::link {

/// Detects the protocol of the FCU: decodes both protocols and continues with the one that first
/// gives a complete message. An FCU sends without a request, so this takes one frame.
///
/// Until then it sends MAVLink, which a lean FCU rejects as noise. The first frame sent in lean is
/// therefore a heartbeat, together with the message that follows. After kMaxBytesWithoutMessage
/// bytes without a message it detects again, in case the FCU was exchanged. The result does not
/// depend on how the bytes were divided into calls.
class DetectingCodec final : public Codec {
 public:
  /// 45 ms of a 921 600 baud line at its limit, 16 of the longest frames.
  static constexpr std::size_t kMaxBytesWithoutMessage = 4096;

  enum class Protocol : std::uint8_t { kUnknown, kMavlink, kLean };

  DetectingCodec() = default;
  /// @param schema  of the lean end, for tests.
  explicit DetectingCodec(std::uint32_t schema) : lean_{schema} {}

  Protocol protocol() const { return protocol_; }

  bool encode(const Message& message, Frame& frame) override;
  Decoded decode(const std::uint8_t* data, std::size_t size) override;
  const Message& message() const override { return active().message(); }
  void set_system_id(std::uint8_t id) override;
  /// Counters of the protocol in use; of MAVLink before one is detected.
  const Counters& counters() const override { return active().counters(); }
  /// A lean peer of another schema is recognised by its heartbeat, although its frames are rejected.
  const SchemaMismatch* mismatch() const override { return lean_.mismatch(); }

 private:
  const Codec& active() const;
  Codec& active();
  Decoded detect(const std::uint8_t* data, std::size_t size);

  MavlinkCodec mavlink_{{1, MavlinkCodec::kCompanionComponent}};
  LeanCodec lean_;
  Protocol protocol_{Protocol::kUnknown};
  bool greet_{false};            ///< The next frame in lean carries a heartbeat.
  std::size_t silent_bytes_{0};  ///< Since the last message.
};

}  // namespace rosflight::link
