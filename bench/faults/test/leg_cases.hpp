// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "bench/faults/cases.hpp"

/// Flights of the phase "leg" for the tests beside.
namespace rosflight::bench::faults {

inline Case multirotor(const char* first, const char* pilot = "hover", const char* second = "") {
  return {0, pilot, first, second, "leg", false};
}
inline Case fixedwing(const char* first, const char* second = "") {
  return {1, "hover", first, second, "leg", false};
}

}  // namespace rosflight::bench::faults
