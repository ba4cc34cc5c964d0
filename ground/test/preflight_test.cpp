// SPDX-License-Identifier: BSD-3-Clause
#include "ground/preflight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "companion/test/fake_fcu.hpp"

namespace rosflight::ground {
namespace {

using companion::ParameterValue;
using enum PreflightVerdict;

link::CheckResult check(std::uint8_t index, link::CheckOutcome outcome, const char* name,
                        const char* reason = "") {
  link::CheckResult line{.index = index, .count = 3, .result = static_cast<std::uint8_t>(outcome)};
  companion::test::copy_text(name, line.name);
  companion::test::copy_text(reason, line.reason);
  return line;
}

/// A vehicle that is ready.
PreflightFacts good() {
  PreflightFacts facts;
  facts.checks = {check(0, link::CheckOutcome::kPass, "mixer"),
                  check(1, link::CheckOutcome::kPass, "IMU"),
                  check(2, link::CheckOutcome::kPass, "storage")};
  facts.streams.for_each([](auto& latest) { latest.count = 10; });
  facts.streams.gnss.value.fix = 3;
  facts.link.frames.frames_received = 1000;
  facts.synchronised = true;
  facts.firmware = "2.0.0";
  facts.version = companion::VersionMatch::kSame;
  for (const char* name : preflight_parameters()) {
    facts.parameters.push_back(
        {name, ParameterValue::of(name == std::string("FIXED_WING") ? 0.0f : 0.5f)});
  }
  return facts;
}

PreflightVerdict verdict(const PreflightFacts& facts, const std::string& name) {
  const auto rows = judge_preflight(facts);
  const auto row =
      std::find_if(rows.begin(), rows.end(), [&](const auto& r) { return r.name == name; });
  EXPECT_NE(row, rows.end()) << name;
  return row == rows.end() ? kNotTold : row->verdict;
}

int exit_code(const PreflightFacts& facts) {
  std::ostringstream out;
  return print_preflight(judge_preflight(facts), false, out);
}

TEST(Preflight, AGoodVehiclePassesAndOnlyTheStoredParametersAreNotTold) {
  const auto rows = judge_preflight(good());
  for (const auto& row : rows) {
    EXPECT_EQ(row.verdict, row.name == "parameters stored" ? kNotTold : kPass)
        << row.name << ": " << row.text;
  }
  EXPECT_EQ(exit_code(good()), 0);
}

TEST(Preflight, TheVerdictsOfTheFirmwareAreTaken) {
  PreflightFacts facts = good();
  facts.checks[0] = check(0, link::CheckOutcome::kWarning, "mixer", "ESC calibration mixer chosen");
  EXPECT_EQ(verdict(facts, "mixer"), kWarning);
  EXPECT_EQ(exit_code(facts), 0);  // does not keep it on the ground
  facts.checks[1] = check(1, link::CheckOutcome::kRefuses, "IMU", "IMU not responding");
  EXPECT_EQ(verdict(facts, "IMU"), kFail);
  EXPECT_EQ(exit_code(facts), 1);
  facts.checks[1].result = 9;  // a word of a later firmware is no pass
  EXPECT_EQ(verdict(facts, "IMU"), kFail);
}

TEST(Preflight, EachFaultFailsItsRow) {
  struct Fault {
    const char* row;
    PreflightVerdict verdict;
    void (*make)(PreflightFacts&);
  };
  constexpr Fault kFaults[] = {
      {"error flags", kFail, [](PreflightFacts& f) { f.status.error_code = 0x04; }},
      {"disarmed", kFail, [](PreflightFacts& f) { f.status.armed = true; }},
      {"RC failsafe", kFail, [](PreflightFacts& f) { f.status.failsafe = true; }},
      {"link loss", kFail, [](PreflightFacts& f) { f.link.frames.sequence_gaps = 60; }},
      {"clock", kWarning, [](PreflightFacts& f) { f.drift_ppm = -300.0; }},
      {"clock", kNotTold, [](PreflightFacts& f) { f.synchronised = false; }},
      {"version", kWarning,
       [](PreflightFacts& f) { f.version = companion::VersionMatch::kDiffers; }},
      {"version", kNotTold, [](PreflightFacts& f) { f.firmware.clear(); }},
      {"IMU samples", kFail, [](PreflightFacts& f) { f.streams.imu.count = 0; }},
      {"RC channels", kFail, [](PreflightFacts& f) { f.streams.rc.count = 0; }},
      {"GNSS", kWarning, [](PreflightFacts& f) { f.streams.gnss.value.fix = 2; }},
      {"GNSS", kNotTold, [](PreflightFacts& f) { f.streams.gnss.count = 0; }},
      {"gyro calibrated", kNotTold, [](PreflightFacts& f) { f.parameters.clear(); }},
      {"gyro calibrated", kWarning,
       [](PreflightFacts& f) {
         for (auto& entry : f.parameters) entry.value = ParameterValue::of(0.0f);
       }},
      {"failsafe throttle", kFail,
       [](PreflightFacts& f) {
         for (auto& entry : f.parameters)
           entry.value = ParameterValue::of(entry.name == "FIXED_WING" ? 0.0f : -1.0f);
       }},
  };
  for (const Fault& fault : kFaults) {
    PreflightFacts facts = good();
    fault.make(facts);
    EXPECT_EQ(verdict(facts, fault.row), fault.verdict) << fault.row;
    EXPECT_EQ(exit_code(facts), fault.verdict == kFail ? 1 : 0) << fault.row;
  }
}

TEST(Preflight, WithoutTheListTheErrorWordCountsAndTheRestIsNotTold) {
  PreflightFacts facts = good();
  facts.checks.clear();
  facts.status.error_code = 0x01;
  EXPECT_EQ(verdict(facts, "invalid mixer"), kFail);
  EXPECT_EQ(verdict(facts, "RC lost"), kPass);
  EXPECT_EQ(verdict(facts, "throttle low"), kNotTold);
}

TEST(Preflight, JsonHasTheSameRows) {
  std::ostringstream out;
  PreflightFacts facts = good();
  facts.firmware = "garbled \xff";
  EXPECT_EQ(print_preflight(judge_preflight(facts), true, out), 0);
  const auto json = nlohmann::json::parse(out.str());
  EXPECT_EQ(json["ready"], true);
  EXPECT_EQ(json["checks"].size(), judge_preflight(facts).size());
}

}  // namespace
}  // namespace rosflight::ground
