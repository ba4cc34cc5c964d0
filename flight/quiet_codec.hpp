// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <utility>
#include <variant>

#include "flight/link_protocol.hpp"
#include "link/codec.hpp"

namespace rosflight::flight {

/// The board's end of a link whose bytes may be left out: telemetry is then not encoded, and nothing is sent.
class QuietCodec final : public link::Codec {
 public:
  /// @param protocol  one of link_protocols(). @throws config::Error  another one.
  explicit QuietCodec(const std::string& protocol) {
    if (protocol == "lean") {
      codec_.emplace<link::LeanCodec>();
    } else if (protocol != "mavlink") {
      static_cast<void>(make_board_codec(protocol));  // throws
    }
  }

  void set_quiet(bool quiet) { quiet_ = quiet; }

  bool encode(const link::Message& message, link::Frame& frame) override {
    frame.size = 0;
    return !quiet_ && codec().encode(message, frame);
  }
  Decoded decode(const std::uint8_t* data, std::size_t size) override {
    return codec().decode(data, size);
  }
  const link::Message& message() const override { return codec().message(); }
  void set_system_id(std::uint8_t id) override { codec().set_system_id(id); }
  const Counters& counters() const override { return codec().counters(); }
  const SchemaMismatch* mismatch() const override { return codec().mismatch(); }

 private:
  link::Codec& codec() {
    return std::visit([](auto& one) -> link::Codec& { return one; }, codec_);
  }
  const link::Codec& codec() const {
    return std::visit([](const auto& one) -> const link::Codec& { return one; }, codec_);
  }

  std::variant<link::MavlinkCodec, link::LeanCodec> codec_{
      std::in_place_type<link::MavlinkCodec>,
      link::MavlinkCodec::Identity{1, link::MavlinkCodec::kFcuComponent}};
  bool quiet_{false};
};

}  // namespace rosflight::flight
