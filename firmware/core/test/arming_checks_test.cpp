// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/arming_checks.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <set>
#include <string>

namespace rosflight::core {
namespace {

using Break = std::function<void(CheckInputs&)>;

/// What makes each row fail, and what that leads to without parameters.
struct Case {
  Check check;
  Break broken;
  Verdict verdict;
};

Break bit(std::uint16_t error) {
  return [error](CheckInputs& in) { in.errors = static_cast<std::uint16_t>(in.errors | error); };
}

std::vector<Case> cases() {
  constexpr auto kRefuses = Verdict::kRefuses;
  constexpr auto kWarning = Verdict::kWarning;
  return {
      {Check::kMixer, bit(0x01), kRefuses},
      {Check::kEscCalibration, [](CheckInputs& in) { in.esc_calibration = true; }, kWarning},
      {Check::kImu, bit(0x02), kRefuses},
      {Check::kTime, bit(0x10), kRefuses},
      {Check::kCalibration, bit(0x20), kRefuses},
      {Check::kEstimator, bit(0x08), kRefuses},
      {Check::kReceiver, bit(0x04), kRefuses},
      {Check::kFailsafe, bit(0x80), kRefuses},
      {Check::kThrottle, [](CheckInputs& in) { in.throttle_low = false; }, kRefuses},
      {Check::kOverride, [](CheckInputs& in) { in.override_ok = false; }, kRefuses},
      {Check::kStill, [](CheckInputs& in) { in.still = false; }, kRefuses},
      {Check::kLevel, [](CheckInputs& in) { in.level = false; }, kWarning},
      {Check::kSensors, [](CheckInputs& in) { in.sensor_silent = true; }, kRefuses},
      {Check::kStorage, [](CheckInputs& in) { in.storage_healthy = false; }, kRefuses},
      {Check::kLoopTime, [](CheckInputs& in) { in.loop_in_time = false; }, kRefuses},
      {Check::kBatteryKnown, [](CheckInputs& in) { in.motor_model_unusable = true; }, kRefuses},
      {Check::kBattery, [](CheckInputs& in) { in.battery_low = true; }, kWarning},
  };
}

TEST(ArmingChecks, AHealthyVehiclePassesAll) {
  const CheckResults results = run_checks(CheckInputs{});
  for (const Verdict v : results.verdict) EXPECT_EQ(v, Verdict::kPass);
  EXPECT_TRUE(results.ready());
}

TEST(ArmingChecks, EachFaultFailsItsRowAndNoOther) {
  ASSERT_EQ(cases().size(), kCheckCount);
  for (const Case& c : cases()) {
    CheckInputs in;
    c.broken(in);
    const CheckResults results = run_checks(in);
    for (const CheckRow& row : kChecks) {
      EXPECT_EQ(results.of(row.check), row.check == c.check ? c.verdict : Verdict::kPass)
          << row.name;
    }
    EXPECT_EQ(results.ready(), c.verdict != Verdict::kRefuses);
  }
}

TEST(ArmingChecks, AllFaultsTogetherFailAllRows) {
  CheckInputs in;
  for (const Case& c : cases()) c.broken(in);
  const CheckResults results = run_checks(in);
  for (const Case& c : cases()) EXPECT_EQ(results.of(c.check), c.verdict);
  EXPECT_FALSE(results.ready());
}

TEST(ArmingChecks, ParametersTurnTheirWarningsIntoRefusals) {
  CheckInputs in;
  in.level_refuses = in.battery_refuses = true;
  EXPECT_TRUE(run_checks(in).ready()) << "nothing is wrong yet";
  in.level = false;
  EXPECT_EQ(run_checks(in).of(Check::kLevel), Verdict::kRefuses);
  in.level = true;
  in.battery_low = true;
  EXPECT_EQ(run_checks(in).of(Check::kBattery), Verdict::kRefuses);
}

TEST(ArmingChecks, ALoopThatSharesItsProcessorOnlyWarns) {
  CheckInputs in;
  in.shares_processor = true;
  in.loop_in_time = false;
  EXPECT_EQ(run_checks(in).of(Check::kLoopTime), Verdict::kWarning);
  EXPECT_TRUE(run_checks(in).ready());
}

TEST(ArmingChecks, TextsFitTheirMessagesAndDiffer) {
  std::set<std::string> names, texts;
  for (const CheckRow& row : kChecks) {
    EXPECT_LE(std::strlen(row.name), link::kParamNameLength) << row.name;
    EXPECT_LE(std::strlen("Unable to arm: ") + std::strlen(row.text), link::kTextLength - 1)
        << row.text;
    names.insert(row.name);
    texts.insert(row.text);
  }
  EXPECT_EQ(names.size(), kCheckCount);
  EXPECT_EQ(texts.size(), kCheckCount);
}

TEST(SensorWatch, SilenceIsThatOfASensorThatOnceAnswered) {
  SensorWatch watch;
  Measurements m;
  const Time late = hal::milliseconds(60'000);
  for (std::size_t k = 0; k < kAidCount; ++k) {
    EXPECT_FALSE(watch.answered(static_cast<Aid>(k)));
    EXPECT_FALSE(watch.silent(static_cast<Aid>(k), late)) << "never there: nobody misses it";
  }
  m.new_baro = m.new_aid = true;
  watch.step(hal::milliseconds(100), m);
  m.new_baro = m.new_aid = false;
  watch.step(hal::milliseconds(3100), m);
  EXPECT_FALSE(watch.silent(Aid::kBaro, hal::milliseconds(3100)));
  EXPECT_TRUE(watch.silent(Aid::kBaro, hal::milliseconds(3101)));
  EXPECT_FALSE(watch.silent(Aid::kMag, hal::milliseconds(3101)));
  m.new_baro = m.new_aid = true;
  watch.step(hal::milliseconds(4000), m);
  EXPECT_FALSE(watch.silent(Aid::kBaro, hal::milliseconds(4000)));
}

TEST(SensorWatch, KnowsEachSensorByItsFlag) {
  const std::array<bool Measurements::*, kAidCount> flags{
      &Measurements::new_mag,   &Measurements::new_baro, &Measurements::new_diff_pressure,
      &Measurements::new_range, &Measurements::new_gnss, &Measurements::new_battery};
  for (std::size_t k = 0; k < kAidCount; ++k) {
    SensorWatch watch;
    Measurements m;
    m.*flags[k] = m.new_aid = true;
    watch.step(hal::milliseconds(1), m);
    for (std::size_t other = 0; other < kAidCount; ++other) {
      EXPECT_EQ(watch.answered(static_cast<Aid>(other)), other == k) << kAidNames[k];
    }
  }
}

}  // namespace
}  // namespace rosflight::core
