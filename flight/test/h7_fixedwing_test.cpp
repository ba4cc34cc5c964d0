// SPDX-License-Identifier: BSD-3-Clause
// The fixed wing on the images of the boards with an STM32H7, emulated.
#include <gtest/gtest.h>

#include "flight/test/fixedwing_rig.hpp"
#include "flight/test/h7_rig.hpp"

namespace rosflight::flight::testing {
namespace {

class EachImage : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Boards, EachImage, ::testing::Values("pixracer_pro", "varmint"),
                         [](const auto& board) { return std::string(board.param); });

TEST_P(EachImage, FliesTheFixedWingWithItsPitotSensor) {
  FlightChoice choice = on_board({}, GetParam());
  choice.vehicle = "anaconda";
  Rig rig{choice};
  rig.flight->run();
  ASSERT_TRUE(rig.completed()) << rig.flight->runner().failure();
  expect_in_control(rig);
  expect_tracked(rig);
  expect_tracked_as_in_process(rig, choice);
  const auto& streams = rig.flight->session().streams();
  const double flown_s = sim::to_seconds(rig.flight->now());
  EXPECT_GT(static_cast<double>(streams.diff_pressure.count), 95.0 * flown_s);
  EXPECT_GT(static_cast<double>(streams.gnss.count), 9.0 * flown_s);
  EXPECT_EQ(streams.status.value.sensor_errors, 0);
  EXPECT_EQ(chip_of(rig).figures()->resets, 0U);
}

}  // namespace
}  // namespace rosflight::flight::testing
