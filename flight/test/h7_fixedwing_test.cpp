// SPDX-License-Identifier: BSD-3-Clause
// The fixed wing on the images of the boards with an STM32H7, emulated.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "flight/flight_recorder.hpp"
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

/// Hash of the log from the power-on into the climb.
std::string hash_of_take_off(const std::string& board, std::uint64_t seed) {
  FlightChoice choice = on_board({}, board);
  choice.vehicle = "anaconda";
  choice.seed = seed;
  const std::filesystem::path file =
      std::filesystem::path(::testing::TempDir()) / ("h7_wing_log_" + std::to_string(::getpid()));
  Rig rig{choice};
  FlightRecorder recorder(*rig.flight, file);
  rig.run_until(18.0);
  EXPECT_GT(rig.height_m(), 5.0) << "flies";
  std::string hash = recorder.close()->sha256;
  std::filesystem::remove(file);
  return hash;
}

TEST_P(EachImage, SameSeedIsTheSameLogAndAnotherSeedAnother) {
  const std::string first = hash_of_take_off(GetParam(), 1);
  EXPECT_EQ(hash_of_take_off(GetParam(), 1), first);
  EXPECT_NE(hash_of_take_off(GetParam(), 2), first);
}

}  // namespace
}  // namespace rosflight::flight::testing
