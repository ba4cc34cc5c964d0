// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rosflight::core {

/// What SEND_VERSION answers. The first two numbers are the generation of the link: ROSflight
/// companions compare them with their own and warn if they differ.
inline constexpr const char* kVersion = "2.0.0-open";

}  // namespace rosflight::core
