// SPDX-License-Identifier: BSD-3-Clause
// Flights by a policy inside the firmware: in process, on the emulated Cortex-M7 and on the boards with an STM32H7. This program
// is linked with the policy that the images firmware_..._learned have (firmware/core/policy/fixed_policy.hpp).
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "flight/autopilot/emulated_autopilot.hpp"
#include "flight/flight_recorder.hpp"
#include "flight/test/h7_rig.hpp"

namespace rosflight::flight::testing {
namespace {

/// With the gains of the rate loops that the law of the policy supposes.
FlightChoice chosen(const std::string& board) {
  FlightChoice choice;
  choice.board = board;
  choice.overrides = {"vehicle.firmware.PID_ROLL_RATE_P=0.14",
                      "vehicle.firmware.PID_PITCH_RATE_P=0.14"};
  return choice;
}

/// With the image of the board that has the policy.
FlightParts on_m7() {
  FlightParts parts;
  parts.autopilot = [](CableLink& cable) {
    EmulatedAutopilot::Emulator::Options options;
    options.image = emulated_image().replace_filename("firmware_qemu_m7_learned.elf");
    return std::make_unique<EmulatedAutopilot>(cable, options);
  };
  return parts;
}
FlightParts on_h7(const std::string& board) {
  FlightParts parts;
  parts.autopilot = [board](CableLink& cable) {
    boards::stm32h7::ChipProcess::Options options = emulated_chip(board);
    options.image.replace_filename("firmware_" + board + "_learned.elf");
    return std::make_unique<ChipAutopilot>(cable, options, ChipCables{});
  };
  return parts;
}

/// The texts of a flight.
class Texts {
 public:
  explicit Texts(Rig& rig) {
    rig.flight->runner().set_notify([this](const FlightNote& note) { all_ += note.text + "\n"; });
  }
  const std::string& all() const { return all_; }
  bool has(const char* part) const { return all_.find(part) != std::string::npos; }

 private:
  std::string all_;
};

void expect_flown_by_policy(const Texts& texts) {
  EXPECT_TRUE(texts.has("Learned controller: fixed")) << texts.all();
  EXPECT_FALSE(texts.has("Learned control off")) << texts.all();
}

/// Hash of the log: every byte of the link, a hundred estimates a second.
std::string log_hash(const std::string& board, FlightParts parts) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) /
                                     ("learned_" + board + "_" + std::to_string(::getpid()));
  Rig rig{chosen(board), std::move(parts)};
  const Texts texts(rig);
  FlightRecorder recorder(*rig.flight, file);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
  expect_flown_by_policy(texts);
  const auto written = recorder.close();
  std::filesystem::remove(file);
  return written.has_value() ? written->sha256 : "no log of " + board;
}

TEST(LearnedFlight, FollowsTheMissionInProcess) {
  Rig rig{chosen("in_process")};
  int flown = 0;
  int armed = 0;
  while (!rig.flight->runner().finished()) {
    rig.flight->step();
    flown += rig.firmware().learned().flying() ? 1 : 0;
    armed += rig.firmware().state().armed() ? 1 : 0;
  }
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
  EXPECT_GT(flown, armed * 9 / 10) << "it is the policy that flies";
  EXPECT_GT(armed, 8000);
  EXPECT_LT(rig.flight->tracking().rms(), kTracking95_m);
}

TEST(LearnedFlight, OnTheEmulatedM7IsTheSameToTheByteAsInProcess) {
  EXPECT_EQ(log_hash("qemu_m7", on_m7()), log_hash("in_process", {}));
}

/// Sensors come over buses there, so the bits are others; those of an inference are compared in arithmetic_contract.hpp.
class LearnedOnBoards : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Boards, LearnedOnBoards, ::testing::Values("pixracer_pro", "varmint"),
                         [](const auto& board) { return std::string(board.param); });

TEST_P(LearnedOnBoards, TracksAsInProcess) {
  const FlightChoice choice = chosen(GetParam());
  Rig rig{choice, on_h7(GetParam())};
  const Texts texts(rig);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
  expect_flown_by_policy(texts);
  expect_tracked_as_in_process(rig, choice);
  const auto figures = chip_of(rig).figures();
  ASSERT_TRUE(figures.has_value());
  EXPECT_EQ(figures->resets, 0U);
  EXPECT_LE(figures->stack_bytes, 8192U);
}

}  // namespace
}  // namespace rosflight::flight::testing
