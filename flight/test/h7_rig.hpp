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

/// 95 of 100 samples of 60 flights in process are nearer to their setpoint than this (docs/autonomy/estimation.md).
inline constexpr double kTracking95_m = 0.226;

/// The error of a completed flight in following its setpoints, by the vehicle's own position, is that of the firmware in process
/// with the same sensors, and at most a tenth more. The boards have no rangefinder.
inline void expect_tracked_as_in_process(const Rig& on_board, FlightChoice choice) {
  choice.board = "in_process";
  choice.link = "cable";
  choice.overrides.emplace_back("sensors.range.enabled=false");
  Rig in_process{choice};
  in_process.flight->run();
  ASSERT_TRUE(in_process.completed()) << in_process.flight->runner().failure();
  const double expected_m = in_process.flight->own_tracking().rms();
  EXPECT_LT(on_board.flight->own_tracking().rms(), 1.1 * expected_m);
  EXPECT_GT(on_board.flight->own_tracking().rms(), 0.7 * expected_m) << "less would be no estimate";
}

}  // namespace rosflight::flight::testing
