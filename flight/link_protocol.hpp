// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "config/strict_yaml.hpp"
#include "link/lean/lean_codec.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace rosflight::flight {

/// What a board may be built to speak (option --link-protocol); companions find out by themselves.
inline const std::vector<std::string>& link_protocols() {
  static const std::vector<std::string> kNames{"mavlink", "lean"};
  return kNames;
}

/// The board's end. @throws config::Error for a name that is none of link_protocols().
inline std::shared_ptr<link::Codec> make_board_codec(const std::string& protocol) {
  if (protocol == "lean") return std::make_shared<link::LeanCodec>();
  if (protocol != "mavlink") {
    throw config::Error("--link-protocol: found '" + protocol + "', allowed mavlink or lean");
  }
  return std::make_shared<link::MavlinkCodec>(
      link::MavlinkCodec::Identity{1, link::MavlinkCodec::kFcuComponent});
}

}  // namespace rosflight::flight
