// SPDX-License-Identifier: BSD-3-Clause
// The contract suites of the HAL run on the boards with an STM32H7 themselves: an image with GoogleTest inside, on the
// emulated chip. For each test the power comes on; what the image prints comes over its link.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "flight/test/contract_world.hpp"

namespace rosflight::flight::testing {
namespace {

using Cable = ContractWorld::Cable;

boards::stm32h7::ChipProcess::Options contract_image(const std::string& board) {
  boards::stm32h7::ChipProcess::Options options = emulated_chip(board);
  options.image.replace_filename("firmware_" + board + "_contract.elf");
  return options;
}

struct BoardTest {
  std::string suite, name;
  std::string full() const { return suite + '.' + name; }
};

/// What the image has, as GoogleTest lists it: a line for each suite, indented lines for its tests.
std::vector<BoardTest> tests_in(ContractWorld& world) {
  const ContractWorld::Result listed = world.run("list_tests", Cable::kUart);
  EXPECT_EQ(listed.problem, "") << listed.printed;
  std::vector<BoardTest> tests;
  std::istringstream lines{listed.printed};
  std::string line, suite;
  while (std::getline(lines, line)) {
    const std::string word = line.substr(0, line.find("  #"));
    if (word.rfind("  ", 0) == 0) {
      tests.push_back({suite, word.substr(2)});
    } else if (!word.empty() && word.back() == '.') {
      suite = word.substr(0, word.size() - 1);
    }
  }
  return tests;
}

void expect_passes(ContractWorld& world, const BoardTest& test, Cable cable) {
  const ContractWorld::Result result = world.run("filter=" + test.full(), cable);
  EXPECT_EQ(result.problem, "") << test.full() << '\n' << result.printed;
  EXPECT_NE(result.printed.find("[  PASSED  ] 1 test"), std::string::npos) << test.full();
}

class ContractsOn : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Boards, ContractsOn, ::testing::Values("pixracer_pro", "varmint"),
                         [](const auto& board) { return std::string(board.param); });

TEST_P(ContractsOn, EachTestPassesOnTheBoard) {
  ContractWorld world{contract_image(GetParam())};
  for (const BoardTest& test : tests_in(world)) expect_passes(world, test, Cable::kUart);
}

TEST_P(ContractsOn, TheLinkKeepsItsContractOverUsbToo) {
  ContractWorld world{contract_image(GetParam())};
  int count = 0;
  for (const BoardTest& test : tests_in(world)) {
    if (test.suite.rfind("Board/SerialContract", 0) != 0) continue;
    expect_passes(world, test, Cable::kUsb);
    ++count;
  }
  EXPECT_GT(count, 0);
}

/// Every role of hal::Board but the rangefinder, which neither board has.
TEST_P(ContractsOn, EachRoleHasItsSuite) {
  ContractWorld world{contract_image(GetParam())};
  std::set<std::string> suites;
  for (const BoardTest& test : tests_in(world)) suites.insert(test.suite);
  const std::set<std::string> expected{"Arithmetic",
                                       "Board/BackupMemoryContract/0",
                                       "Board/BatteryContract/0",
                                       "Board/ClockContract/0",
                                       "Board/LedsContract/0",
                                       "Board/OutputsContract/0",
                                       "Board/ReceiverContract/0",
                                       "Board/SerialContract/0",
                                       "Board/SourceContract/0",  // IMU
                                       "Board/SourceContract/1",  // magnetometer
                                       "Board/SourceContract/2",  // barometer
                                       "Board/SourceContract/3",  // differential pressure
                                       "Board/SourceContract/4",  // GNSS
                                       "Board/SourceContract/5",  // battery
                                       "Board/SourceContract/6",  // receiver
                                       "Board/StorageContract/0",
                                       "Board/SystemContract/0"};
  EXPECT_EQ(suites, expected);
}

}  // namespace
}  // namespace rosflight::flight::testing
