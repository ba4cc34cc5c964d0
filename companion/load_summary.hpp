// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "companion/parameter_results.hpp"

namespace rosflight::companion {

/// How many values of a set ended how: "3 parameters: 1 set, 2 refused".
std::string count_text(const LoadReport& report);

/// The same and, for who has no line for each, the first value that is not in force.
std::string load_summary(const LoadReport& report);

}  // namespace rosflight::companion
