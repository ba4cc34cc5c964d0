// SPDX-License-Identifier: BSD-3-Clause
#include "companion/status_text.hpp"

#include <array>
#include <cstddef>

namespace rosflight::companion {

const char* error_text(int bit) {
  constexpr std::array<const char*, 8> kTexts{
      "invalid mixer",        "IMU not responding", "RC lost",        "unhealthy estimator",
      "time going backwards", "IMU uncalibrated",   "buffer overrun", "invalid failsafe throttle"};
  return bit >= 0 && bit < static_cast<int>(kTexts.size()) ? kTexts[static_cast<std::size_t>(bit)]
                                                           : nullptr;
}

std::string error_texts(std::uint8_t error_code) {
  std::string all;
  for (int bit = 0; error_text(bit) != nullptr; ++bit) {
    if ((error_code >> bit & 1) != 0)
      all += (all.empty() ? "" : ", ") + std::string(error_text(bit));
  }
  return all;
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

}  // namespace rosflight::companion
