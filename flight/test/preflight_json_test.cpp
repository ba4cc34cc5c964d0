// SPDX-License-Identifier: BSD-3-Clause
#include "flight/preflight_json.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

namespace rosflight::flight {
namespace {

using namespace std::chrono_literals;

link::CheckResult row(std::uint8_t index, std::uint8_t result, std::string_view name,
                      std::string_view reason = "") {
  link::CheckResult line{.index = index, .count = 3, .result = result};
  std::copy(name.begin(), name.end(), line.name.begin());
  std::copy(reason.begin(), reason.end(), line.reason.begin());
  return line;
}

TEST(PreflightJson, HasEachRowWithItsTime) {
  companion::CheckList list;
  EXPECT_FALSE(list.add(10s, row(0, 0, "mixer")));
  EXPECT_FALSE(list.add(10s, row(1, 1, "level", "vehicle is not level")));
  EXPECT_TRUE(nlohmann::json::parse(preflight_json(list))["ready"].is_null());
  EXPECT_TRUE(list.add(10500ms, row(2, 0, "battery")));
  EXPECT_TRUE(list.ready());
  const auto json = nlohmann::json::parse(preflight_json(list, 4s));
  EXPECT_EQ(json, nlohmann::json::parse(R"({"ready": true, "checks": [
    {"time_s": 6.0, "row": "mixer", "verdict": "pass", "reason": ""},
    {"time_s": 6.0, "row": "level", "verdict": "warning", "reason": "vehicle is not level"},
    {"time_s": 6.5, "row": "battery", "verdict": "pass", "reason": ""}]})"));
}

TEST(PreflightJson, ANewerLineTakesThePlaceOfItsRow) {
  companion::CheckList list;
  for (std::uint8_t k = 0; k < 3; ++k) list.add(1s, row(k, 0, "row"));
  EXPECT_FALSE(list.add(2s, row(1, 2, "row", "RC signal lost")));  // not the last row
  EXPECT_TRUE(list.complete());
  EXPECT_FALSE(list.ready());
  const auto json = nlohmann::json::parse(preflight_json(list));
  EXPECT_EQ(json["ready"], false);
  EXPECT_EQ(json["checks"][1]["verdict"], "refuses");
  EXPECT_EQ(json["checks"][1]["time_s"], 2.0);
  EXPECT_EQ(json["checks"][2]["time_s"], 1.0);
}

TEST(PreflightJson, AnOutcomeOfALaterFirmwareRefuses) {
  companion::CheckList list;
  for (std::uint8_t k = 0; k < 3; ++k) list.add(1s, row(k, k == 1 ? 9 : 0, "row \xff"));
  EXPECT_FALSE(list.ready());
  EXPECT_EQ(nlohmann::json::parse(preflight_json(list))["checks"][1]["verdict"], "refuses");
}

TEST(PreflightJson, OtherEventsAreNoRows) {
  companion::CheckList list;
  EXPECT_FALSE(list.add(1s, link::CommandAck{}));
  EXPECT_TRUE(list.lines().empty());
  EXPECT_EQ(nlohmann::json::parse(preflight_json(list))["checks"].size(), 0U);
}

}  // namespace
}  // namespace rosflight::flight
