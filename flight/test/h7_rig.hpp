// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "flight/autopilot/chip_autopilot.hpp"
#include "flight/test/flight_rig.hpp"

namespace rosflight::flight::testing {

inline FlightChoice on_board(std::vector<std::string> faults = {},
                             const std::string& board = "pixracer_pro") {
  FlightChoice choice;
  choice.board = board;
  choice.faults = std::move(faults);
  return choice;
}

inline ChipAutopilot& chip_of(Rig& rig) {
  return dynamic_cast<ChipAutopilot&>(rig.flight->autopilot());
}
inline FirmwareView view_of(const Rig& rig) {
  return rig.flight->autopilot().view();
}

}  // namespace rosflight::flight::testing
