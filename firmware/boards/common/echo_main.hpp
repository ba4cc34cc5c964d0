// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/hal/roles.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace rosflight::boards {

/// For measuring round trips, in no image that flies: around the firmware's codec. Each offboard
/// command whose u[9] is a sequence number (not 0) is answered at once, before the firmware has
/// acted on it, by OUTPUT_RAW with that number in values[13]; all else passes as it is.
class EchoCodec final : public link::Codec {
 public:
  static constexpr std::size_t kAsked = 9;
  static constexpr std::size_t kAnswered = 13;

  /// Both must outlive this.
  EchoCodec(link::Codec& inner, hal::Serial& port) : inner_{inner}, port_{port} {}

  bool encode(const link::Message& message, link::Frame& frame) override {
    return inner_.encode(message, frame);
  }
  Decoded decode(const std::uint8_t* data, std::size_t size) override {
    const Decoded result = inner_.decode(data, size);
    if (result.complete) answer();
    return result;
  }
  const link::Message& message() const override { return inner_.message(); }
  void set_system_id(std::uint8_t id) override { inner_.set_system_id(id); }
  const Counters& counters() const override { return inner_.counters(); }

 private:
  void answer() {
    const auto* command = std::get_if<link::OffboardControl>(&inner_.message());
    if (command == nullptr || command->u[kAsked] == 0.0f) return;
    link::OutputRaw reply;
    reply.values[kAnswered] = command->u[kAsked];
    link::Frame frame;
    if (inner_.encode(reply, frame)) {
      static_cast<void>(port_.write(frame.bytes.data(), frame.size, hal::Serial::kUrgent));
    }
  }

  link::Codec& inner_;
  hal::Serial& port_;
};

/// What an image for measuring speaks: MAVLink, with answers.
struct ImageLink {
  explicit ImageLink(hal::Serial& port) : codec{inner, port} {}
  link::MavlinkCodec inner{{1, link::MavlinkCodec::kFcuComponent}, link::mavlink::fcu_messages()};
  EchoCodec codec;
};

}  // namespace rosflight::boards
