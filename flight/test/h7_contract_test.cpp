// SPDX-License-Identifier: BSD-3-Clause
// The contract suites of the HAL run on the boards with an STM32H7 themselves: an image with GoogleTest inside, on the
// emulated chip. What it prints comes over its link.
#include <gtest/gtest.h>

#include <string>

#include "flight/autopilot/chip_autopilot.hpp"

namespace rosflight::flight::testing {
namespace {

using boards::stm32h7::ChipOrder;
using boards::stm32h7::ChipProcess;

constexpr std::int64_t kStep_us = 10'000, kTimeout_us = 300'000'000;
constexpr const char* kEnd = "end of tests: ";

ChipProcess::Options contract_image(const std::string& board) {
  ChipProcess::Options options = emulated_chip(board);
  options.image.replace_filename("firmware_" + board + "_contract.elf");
  return options;
}

/// All that the image prints until it has ended. A complaint of a model is an exception.
std::string printed_by(const std::string& board) {
  ChipProcess chip{contract_image(board)};
  chip.start();
  std::string printed;
  chip.to_chip().order = ChipOrder::kPowerOn;
  for (std::int64_t now_us = 0; now_us < kTimeout_us; now_us += kStep_us) {
    chip.to_chip().time_us = now_us;
    chip.to_chip().until_us = now_us + kStep_us;
    chip.exchange();
    chip.to_chip().order = ChipOrder::kStep;
    const auto& from = chip.from_chip();
    printed.append(from.link.begin(), from.link.begin() + from.link_count);
    const std::size_t end = printed.find(kEnd);
    if (end != std::string::npos && printed.find('\n', end) != std::string::npos) break;
  }
  return printed;
}

class ContractsOn : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Boards, ContractsOn, ::testing::Values("pixracer_pro", "varmint"),
                         [](const auto& board) { return std::string(board.param); });

TEST_P(ContractsOn, EachSuitePassesOnTheBoard) {
  const std::string printed = printed_by(GetParam());
  EXPECT_NE(printed.find(std::string(kEnd) + "0"), std::string::npos) << printed;
  for (const char* const suite :
       {"Board/ClockContract", "Board/OutputsContract", "Board/BackupMemoryContract",
        "Board/LedsContract", "Board/StorageContract", "Board/SystemContract", "Arithmetic"}) {
    EXPECT_NE(printed.find(std::string("from ") + suite), std::string::npos) << suite;
  }
}

}  // namespace
}  // namespace rosflight::flight::testing
