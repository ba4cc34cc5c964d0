// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "companion/parameter_client.hpp"

namespace rosflight_io {

/// Output kinds and both mixers as the firmware's parameters have them, a table for people. Values
/// that are not known are shown as "?".
std::string mixing_matrix_text(const rosflight::companion::ParameterClient& parameters);

}  // namespace rosflight_io
