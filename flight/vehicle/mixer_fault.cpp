// SPDX-License-Identifier: BSD-3-Clause
#include "flight/vehicle/mixer_fault.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "firmware/core/mixer_frames.hpp"

namespace rosflight::flight {

std::string mixer_fault(int id, std::size_t rotors) {
  if (!core::is_predefined(id)) return "";
  const auto types = core::frame_header(static_cast<core::MixerId>(id)).type;
  const auto motors = std::ranges::count(types, core::OutputType::kMotor);
  const bool surfaces = std::ranges::count(types, core::OutputType::kServo) > 0;
  if (!surfaces && motors == static_cast<std::ptrdiff_t>(rotors)) return "";
  const std::string found = surfaces ? "a fixed wing's" : fmt::format("that of {} motors", motors);
  return fmt::format(
      "PRIMARY_MIXER: found {}, {}, allowed a mixer of {} motors, as many rotors as the vehicle "
      "file has",
      id, found, rotors);
}

}  // namespace rosflight::flight
