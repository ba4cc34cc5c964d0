// SPDX-License-Identifier: BSD-3-Clause
// How the image of a board starts on the emulated chip, and what is refused in one line.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "flight/project_root.hpp"
#include "flight/test/h7_rig.hpp"
#include "flight/test/last_words.hpp"

namespace rosflight::flight::testing {
namespace {

using boards::EmulatorError;
using boards::stm32h7::ChipProcess;

class EachImage : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Boards, EachImage, ::testing::Values("pixracer_pro", "varmint"),
                         [](const auto& board) { return std::string(board.param); });

TEST(PixracerPro, ADeadEmulatorEndsTheFlight) {
  Rig rig{on_board()};
  rig.run_for(0.1);
  ASSERT_EQ(::kill(chip_of(rig).process().process(), SIGKILL), 0);
  EXPECT_NE(last_words(rig).find("ended by signal 9"), std::string::npos);
}

TEST(PixracerPro, WhatTheImageCannotDoIsRefusedBeforeTheFlight) {
  const auto said = [](const FlightChoice& choice) {
    try {
      const FlightSetup setup(choice);
    } catch (const config::Error& error) {
      return std::string(error.what());
    }
    return std::string{};
  };
  FlightChoice choice = on_board();
  choice.link_protocol = "lean";
  EXPECT_NE(said(choice).find("--link-protocol: found lean"), std::string::npos);
}

/// Starts another file as the image. @returns what was said.
std::string refusal(const ChipProcess::Options& options) {
  CableLink cable{sim::RandomSource{1}};
  try {
    ChipAutopilot autopilot(cable, options);
    autopilot.start(sim::Time{0});
  } catch (const EmulatorError& error) {
    return error.what();
  }
  return "";
}

TEST_P(EachImage, StartsBehindABootloader) {
  const std::string board = GetParam();
  ChipProcess::Options options = emulated_chip(board);
  options.image.replace_filename("firmware_" + board + "_behind_bootloader.elf");
  CableLink cable{sim::RandomSource{1}};
  ChipAutopilot autopilot(cable, options);
  autopilot.start(sim::Time{0});
  for (sim::Time t{0}; sim::to_seconds(t) < 1.0; t += Flight::kStep) autopilot.step(t, {}, nullptr);
  EXPECT_EQ(autopilot.figures()->resets, 0U);
  EXPECT_GT(autopilot.figures()->uart_sent, 500U) << "it speaks";
}

TEST(PixracerPro, WhatIsMissingIsNamedWithWhatMakesIt) {
  ChipProcess::Options options = emulated_chip("pixracer_pro");
  options.image = "/nonexistent/firmware.elf";
  EXPECT_NE(refusal(options).find("firmware build pixracer_pro"), std::string::npos);
  options = emulated_chip("pixracer_pro");
  options.program = "/nonexistent/h7_emulator";
  EXPECT_NE(refusal(options).find("h7_emulator"), std::string::npos);
}

TEST(PixracerPro, AWrongImageIsRefusedInOneLine) {
  ChipProcess::Options options = emulated_chip("pixracer_pro");
  // Another board's image: its vector table does not lie where this chip looks for it.
  options.image = project_root() / "build/cortex-m7/firmware/boards/qemu_m7/firmware_qemu_m7.elf";
  EXPECT_NE(refusal(options).find("no vector table at 0x08000000"), std::string::npos)
      << refusal(options);
  // The same chip, other wiring.
  options.image = emulated_chip("varmint").image;
  EXPECT_NE(refusal(options).find("image: found one for varmint, allowed one for pixracer_pro"),
            std::string::npos)
      << refusal(options);
  options.image =
      std::filesystem::path(::testing::TempDir()) / ("h7_no_" + std::to_string(::getpid()));
  std::ofstream(options.image)
      << "this is no program, but it is longer than the header of one would be";
  EXPECT_NE(refusal(options).find("is no ELF file for Arm"), std::string::npos) << refusal(options);
  std::filesystem::remove(options.image);
  options = emulated_chip("pixracer_pro");
  options.board = "varmint_99";
  EXPECT_NE(
      refusal(options).find("board: found varmint_99, allowed pixracer_pro, varmint, varmint_10x"),
      std::string::npos);
}

}  // namespace
}  // namespace rosflight::flight::testing
