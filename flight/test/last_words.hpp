// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "firmware/boards/common/host/child_process.hpp"
#include "flight/test/flight_rig.hpp"

namespace rosflight::flight::testing {

/// What ends a flight with a broken emulator; empty if nothing does within a second.
inline std::string last_words(Rig& rig) {
  try {
    rig.run_for(1.0);
  } catch (const boards::EmulatorError& error) {
    return error.what();
  }
  return "";
}

}  // namespace rosflight::flight::testing
