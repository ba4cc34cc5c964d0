// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "link/mavlink/mavlink_codec.hpp"

namespace rosflight::boards {

/// What the image speaks: this one, or that of lean_main.hpp, as the build says.
struct ImageLink {
  link::MavlinkCodec codec{{1, link::MavlinkCodec::kFcuComponent}, link::mavlink::fcu_messages()};
};

}  // namespace rosflight::boards
