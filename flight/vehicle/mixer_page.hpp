// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

namespace rosflight::flight {

/// A picture (SVG) of the predefined mixers 0 to 10, seen from above, drawn from the gains and kinds
/// of output that the firmware loads (core::frame_gains(), core::frame_header()).
std::string mixer_picture();

/// Gains of the predefined mixers, a row per channel: a section of docs/predefined-mixers.md.
std::string mixer_tables();

}  // namespace rosflight::flight
