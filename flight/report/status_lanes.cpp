// SPDX-License-Identifier: BSD-3-Clause
#include "flight/report/status_lanes.hpp"

#include <array>
#include <span>
#include <string_view>

namespace rosflight::report {
namespace {

constexpr std::array<std::string_view, 8> kErrors{
    "invalid mixer",        "IMU silent",       "RC lost",        "unhealthy estimator",
    "time going backwards", "uncalibrated IMU", "buffer overrun", "invalid failsafe"};

/// The bits above say where no valid command of the companion is in force, which "Control" shows.
constexpr std::array<std::string_view, 6> kOverrides{"attitude switch", "throttle switch",
                                                     "roll stick",      "pitch stick",
                                                     "yaw stick",       "lower throttle"};

std::string names_of(unsigned bits, std::span<const std::string_view> names) {
  std::string out;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if ((bits >> k & 1U) == 0) continue;
    if (!out.empty()) out += ", ";
    out += names[k];
  }
  return out;
}

std::string_view mode_name(std::uint8_t mode) {
  switch (static_cast<link::OffboardMode>(mode)) {
    case link::OffboardMode::kPassThrough:
      return "offboard, straight to the mixer";
    case link::OffboardMode::kRatesThrottle:
      return "offboard, rates";
    case link::OffboardMode::kRollPitchYawrateThrottle:
      return "offboard, angles";
  }
  return "offboard, unknown mode";
}

}  // namespace

std::string error_names(std::uint8_t error_code) {
  return names_of(error_code, kErrors);
}

std::string override_names(std::uint16_t rc_override) {
  return names_of(rc_override, kOverrides);
}

void record_status(FlightRecord& record, double t_s, const link::Status& status) {
  if (status.failsafe) {
    record.set_state("Firmware", t_s, status.armed ? "failsafe" : "failsafe, disarmed", Tone::kBad);
  } else {
    record.set_state("Firmware", t_s, status.armed ? "armed" : "disarmed",
                     status.armed ? Tone::kGood : Tone::kNeutral);
  }
  record.set_state("Control", t_s, status.offboard ? mode_name(status.control_mode) : "pilot",
                   status.offboard ? Tone::kNote : Tone::kNeutral);
  record.set_state("Override", t_s, override_names(status.rc_override), Tone::kWarning);
  record.set_state("Errors", t_s, error_names(status.error_code), Tone::kBad);
}

}  // namespace rosflight::report
