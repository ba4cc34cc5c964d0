// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/flight_record.hpp"
#include "firmware/boards/parts/temperature_watch.hpp"
#include "firmware/core/firmware.hpp"

namespace rosflight::boards {

/// For the main loop of an image: the text that the watch of its processor's temperature demands. A warning is sent,
/// which also enters the flight record; what is for the record alone is not.
inline void report_temperature(parts::TemperatureWatch::Report report, float temperature_K,
                               core::Firmware& firmware, parts::FlightRecord& record,
                               hal::Time now) {
  using Report = parts::TemperatureWatch::Report;
  if (report == Report::kNone) return;
  const bool hot = report == Report::kWarning;
  core::Text text(hot ? "Chip above 105 degC: " : "Chip degC: ");
  text.add(static_cast<std::int32_t>(temperature_K - parts::kZeroCelsius_K));
  if (hot) {
    firmware.report(link::Severity::kWarning, text);
  } else {
    record.add(now, text.chars().data(), static_cast<std::uint8_t>(link::Severity::kInfo));
  }
}

}  // namespace rosflight::boards
