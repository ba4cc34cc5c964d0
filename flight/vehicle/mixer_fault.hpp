// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <string>

namespace rosflight::flight {

/// Why the predefined mixer of this id (firmware parameter PRIMARY_MIXER) cannot be that of a multirotor with so many rotors; empty
/// where it can. The custom mixer is whatever the user has made it, and without a mixer the firmware does not arm.
std::string mixer_fault(int id, std::size_t rotors);

}  // namespace rosflight::flight
