// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_io/status_text.hpp"

#include <array>
#include <cstddef>

namespace rosflight_io {

const char* error_text(int bit) {
  constexpr std::array<const char*, 8> kTexts{
      "invalid mixer",        "IMU not responding", "RC lost",        "unhealthy estimator",
      "time going backwards", "IMU uncalibrated",   "buffer overrun", "invalid failsafe throttle"};
  return bit >= 0 && bit < static_cast<int>(kTexts.size()) ? kTexts[static_cast<std::size_t>(bit)]
                                                           : nullptr;
}

const char* control_mode_text(int mode) {
  switch (mode) {
    case 0:
      return "pass-through";
    case 1:
      return "rate";
    case 2:
      return "angle";
    default:
      return "unknown";
  }
}

}  // namespace rosflight_io
