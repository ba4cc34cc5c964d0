// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rosflight_common {

enum class GivenKind : std::uint8_t { kNumber, kNumbers, kSwitch };

/// Defaults of parameters that come from elsewhere than the vehicle file: by name and kind; a switch is 0 or 1, one number a
/// list of one. Nothing: no such value. Empty function: there are none.
using GivenValues =
    std::function<std::optional<std::vector<double>>(const std::string& name, GivenKind kind)>;

}  // namespace rosflight_common
