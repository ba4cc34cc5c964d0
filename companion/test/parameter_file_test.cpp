// SPDX-License-Identifier: BSD-3-Clause
#include "companion/parameter_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "companion/test/fake_fcu.hpp"
#include "config/strict_yaml.hpp"

namespace rosflight::companion {
namespace {

TEST(ParameterFile, ReadsTheFormatOfTheReference) {
  const ParameterSet set = parse_parameters(
      "# from a ground station\n"
      "- {name: FIXED_WING, type: 6, value: 0}\n"
      "- {name: PID_ROLL_RATE_P, type: 9, value: 0.1}\n"
      "- name: PRI_MIXER_2_0\n"
      "  type: 9\n"
      "  value: -5814.79345703125\n"
      "- {name: MOTOR_RESISTANCE, type: 9, value: 1}\n",
      "a.yaml");
  ASSERT_EQ(set.size(), 4U);
  EXPECT_EQ(set[0].value.type, link::ParamType::kInt32);
  EXPECT_EQ(set[1].value.as_float(), 0.1f);
  EXPECT_EQ(set[2].value.as_float(), -5814.79345703125f);
  EXPECT_EQ(set[3].name.size(), 16U);
}

TEST(ParameterFile, WritesOneSortedLinePerParameter) {
  const ParameterSet set = {{"PID_TAU", ParameterValue::of(0.05f)},
                            {"ACC_X_BIAS", ParameterValue::of(-1e-8f)},
                            {"SYS_ID", ParameterValue::of(-1)},
                            {"BAUD", ParameterValue::of(2.0f)},
                            {"BROKEN", ParameterValue::of(std::nanf(""))}};
  EXPECT_EQ(format_parameters(set, "v2.0.1\n- evil"),
            "# 5 parameters of firmware v2.0.1?- evil\n"
            "- {name: ACC_X_BIAS, type: 9, value: -1e-08}\n"
            "- {name: BAUD, type: 9, value: 2.0}\n"
            "# not a finite number: {name: BROKEN, type: 9, value: .nan}\n"
            "- {name: PID_TAU, type: 9, value: 0.05}\n"
            "- {name: SYS_ID, type: 6, value: -1}\n");
  EXPECT_TRUE(parse_parameters(format_parameters({}, ""), "empty").empty());
}

TEST(ParameterFile, EveryFiniteValueSurvivesWritingAndReading) {
  test::Random random(5);
  ParameterSet set = {{"P_LARGEST", ParameterValue::of(std::numeric_limits<float>::max())},
                      {"P_SMALLEST", ParameterValue::of(std::numeric_limits<float>::denorm_min())}};
  while (set.size() < 2000) {
    const std::uint64_t bits = random.next();
    const auto type = (bits >> 40) % 2 == 0 ? link::ParamType::kInt32 : link::ParamType::kFloat;
    const ParameterValue value{type, {static_cast<std::uint32_t>(bits)}};
    if (std::isfinite(value.number())) {
      set.push_back({"N" + std::to_string(10000 + set.size()), value});
    }
  }
  const ParameterSet back = parse_parameters(format_parameters(set, "v2"), "written");
  ASSERT_EQ(back.size(), set.size());
  EXPECT_TRUE(diff(back, set).empty());
}

struct BadFile {
  const char* text;
  const char* expected;  ///< Part of the one line.
};

class BadParameterFile : public testing::TestWithParam<BadFile> {};

TEST_P(BadParameterFile, GivesOneLineWithPlaceFoundAndAllowed) {
  try {
    parse_parameters(GetParam().text, "f.yaml");
    FAIL() << "accepted";
  } catch (const config::Error& error) {
    const std::string line = error.what();
    EXPECT_NE(line.find(GetParam().expected), std::string::npos) << line;
    EXPECT_NE(line.find("f.yaml"), std::string::npos) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, BadParameterFile,
    testing::Values(BadFile{"", "empty"}, BadFile{"name: A\ntype: 6\nvalue: 1\n", "list"},
                    BadFile{"- A\n", "f.yaml:1"}, BadFile{"- {name: A, type: 6}\n", "value"},
                    BadFile{"- {name: A, type: 6, value: 1}\n- {name: A, type: 6, value: 2}\n",
                            "f.yaml:2"},
                    BadFile{"- {name: A, type: 6, value: 1.5}\n", "whole number"},
                    BadFile{"- {name: A, type: 6, value: 2147483648}\n", "whole number"},
                    BadFile{"- {name: A, type: 9, value: 1e39}\n", "float"},
                    BadFile{"- {name: A, type: 9, value: .nan}\n", "value"},
                    BadFile{"- {name: A, type: 9, value: fast}\n", "value"},
                    BadFile{"- {name: A, type: 8, value: 1}\n", "6 (int32) or 9 (float)"},
                    BadFile{"- {name: A, type: real, value: 1}\n", "type"},
                    BadFile{"- {name: ABCDEFGHIJKLMNOPQ, type: 6, value: 1}\n", "1 to 16"},
                    BadFile{"- {name: A B, type: 6, value: 1}\n", "1 to 16"},
                    BadFile{"- {name: A, type: 6, value: 1, unit: m}\n", "unit"},
                    BadFile{"- {name: A, type: 6, value: 1\n", "f.yaml"},
                    BadFile{"- {name: A, type: 6, value: 1}\n,", "documents"},
                    BadFile{"- {name: A, type: 6, value: [1]}\n", "value"}));

TEST(ParameterDiff, NamesWhatChangedWhatIsMissingAndWhatHasAnotherType) {
  const ParameterSet left = {{"B", ParameterValue::of(1)},
                             {"A", ParameterValue::of(0.1f)},
                             {"C", ParameterValue::of(3)},
                             {"D", ParameterValue::of(-0.0f)}};
  const ParameterSet right = {{"A", ParameterValue::of(0.2f)},
                              {"C", ParameterValue::of(3.0f)},
                              {"D", ParameterValue::of(0.0f)},
                              {"E", ParameterValue::of(5)}};
  std::vector<std::string> lines;
  for (const ParameterDifference& d : diff(left, right)) {
    lines.push_back(d.text());
  }
  EXPECT_EQ(lines, (std::vector<std::string>{"A: 0.1 -> 0.2", "B: 1 -> (none)", "C: int32 -> float",
                                             "E: (none) -> 5"}));
  EXPECT_TRUE(diff(left, left).empty());
}

}  // namespace
}  // namespace rosflight::companion
