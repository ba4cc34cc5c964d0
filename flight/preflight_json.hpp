// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "companion/check_list.hpp"

namespace rosflight::flight {

/// preflight.json of a flight folder: `ready`, and `checks` with `time_s`, `row`, `verdict` (pass, warning or
/// refuses) and `reason` each. Without a list that has every row `ready` is null.
/// @param start  the time of `time_s` 0.
std::string preflight_json(const companion::CheckList& list, companion::Time start = {});

}  // namespace rosflight::flight
