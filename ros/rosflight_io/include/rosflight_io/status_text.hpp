// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rosflight_io {

/// "invalid mixer", "RC lost", ...: one text for each error bit of Status, nullptr beyond the last.
const char* error_text(int bit);
/// "pass-through", "rate", "angle".
const char* control_mode_text(int mode);

}  // namespace rosflight_io
