// SPDX-License-Identifier: BSD-3-Clause
#include "ground/parameter_commands.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "config/strict_yaml.hpp"
#include "ground/parameter_info.hpp"

namespace rosflight::ground {
namespace {

std::string problem_of(const std::vector<std::string>& words) {
  try {
    parse_assignments(words);
  } catch (const config::Error& error) {
    return error.what();
  }
  return "none";
}

TEST(ParameterInfo, EveryDefaultIsAllowedAndSentinelsStandApart) {
  ASSERT_EQ(parameter_infos().size(), 344U);
  for (const ParameterInfo& info : parameter_infos()) {
    EXPECT_TRUE(info.allows(info.initial)) << info.name;
    EXPECT_TRUE(companion::make_name(info.name)) << info.name;
  }
  const ParameterInfo* channel = find_parameter_info("RC_ARM_CHN");
  ASSERT_NE(channel, nullptr);
  EXPECT_EQ(channel->allowed(), "-1, 4 .. 7");
  EXPECT_FALSE(channel->allows(3));
  EXPECT_EQ(find_parameter_info("RC_ARM_CH"), nullptr);
}

TEST(ParameterAssignments, AreReadInTurn) {
  const auto set = parse_assignments({"RC_TYPE", "1", "X_EQ_TORQUE", "-.5", "OF_ANOTHER", "1e3"});
  ASSERT_EQ(set.size(), 3U);
  EXPECT_EQ(set[0].name, "RC_TYPE");
  EXPECT_EQ(set[1].value, -0.5);
  EXPECT_EQ(set[2].value, 1000.0);  // another firmware may know it
}

TEST(ParameterAssignments, SayWhatWasFoundAndWhatIsAllowed) {
  EXPECT_EQ(problem_of({"RC_TYPE", "1", "RC_ARM_CHN", "3"}),
            "RC_ARM_CHN: found 3, allowed -1, 4 .. 7 channel (0-based)");
  EXPECT_EQ(problem_of({"RC_TYPE", "0.5"}), "RC_TYPE: found 0.5, allowed a whole number");
  EXPECT_EQ(problem_of({"RC_TYPE", "nan"}), "RC_TYPE: found nan, allowed a number");
  EXPECT_EQ(problem_of({"X_EQ_TORQUE", "1e99"}),
            "X_EQ_TORQUE: found 1e99, allowed a number that fits a float");
  EXPECT_EQ(problem_of({"A B", "1"}), "name: found 'A B', allowed 1 to 16 letters, digits and _");
  EXPECT_EQ(problem_of({"RC_TYPE"}), "set: found 1 words, allowed NAME VALUE, once or more");
  EXPECT_EQ(problem_of({}), "set: found 0 words, allowed NAME VALUE, once or more");
}

TEST(ParameterFileCheck, NamesFileAndLineOfAValueOutOfRange) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "ground_bad.yaml";
  std::ofstream(file)
      << "- {name: BATT_VOLT_LPF, type: 9, value: 0.9999}\n"  // the upper limit itself
      << "- {name: BATT_CURR_LPF, type: 9, value: 1.0}\n";
  try {
    read_checked_file(file);
    FAIL();
  } catch (const config::Error& error) {
    EXPECT_EQ(std::string(error.what()),
              file.string() + ":2: 1.value: found 1.0, allowed 0 .. 0.9999 fraction");
  }
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace rosflight::ground
