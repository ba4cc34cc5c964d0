// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <string>

#include "companion/session.hpp"

namespace rosflight_io {

/// Health of link, clocks, parameters and vehicle, without a stamp. `node` and `link_name` (device
/// or address) go into names and hardware ids.
diagnostic_msgs::msg::DiagnosticArray diagnostics_of(rosflight::companion::Session& session,
                                                     const std::string& node,
                                                     const std::string& link_name);

}  // namespace rosflight_io
