// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <string>

namespace rosflight::companion {

/// "invalid mixer", "RC lost", ...: one text for each error bit of Status, nullptr beyond the last.
const char* error_text(int bit);
/// The texts of all errors of a Status, separated by commas; empty without any.
std::string error_texts(std::uint8_t error_code);
/// "pass-through", "rate", "angle".
const char* control_mode_text(int mode);

}  // namespace rosflight::companion
