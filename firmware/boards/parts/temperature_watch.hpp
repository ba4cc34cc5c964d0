// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/bytes.hpp"
#include "firmware/hal/time.hpp"

namespace rosflight::boards::parts {

/// Decides when the temperature of a processor becomes a text, at most one every kPeriod: a warning once after the
/// start, when it is above kHot_K, otherwise an entry of the flight record while armed.
class TemperatureWatch {
 public:
  /// Our choice: 20 K below the 125 degC that the junction of an STM32H743 or H753 with suffix 6 may have.
  static constexpr float kHot_K = kZeroCelsius_K + 105.0f;
  static constexpr hal::Time kPeriod = hal::milliseconds(10'000);

  enum class Report : std::uint8_t { kNone, kRecord, kWarning };

  /// Main loop, once per pass. @param temperature_K  0: not known.
  Report step(float temperature_K, bool armed, hal::Time now) {
    if (now < next_ || temperature_K == 0.0f) return Report::kNone;
    next_ = now + kPeriod;
    if (temperature_K > kHot_K && !warned_) {
      warned_ = true;
      return Report::kWarning;
    }
    return armed ? Report::kRecord : Report::kNone;
  }

 private:
  hal::Time next_{};
  bool warned_{false};
};

}  // namespace rosflight::boards::parts
