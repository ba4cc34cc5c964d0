// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "link/lean/lean_codec.hpp"

namespace rosflight::boards {

/// What the image speaks: this one, or that of mavlink_main.hpp, as the build says.
struct ImageLink {
  link::LeanCodec codec;
};

}  // namespace rosflight::boards
