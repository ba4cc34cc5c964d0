// SPDX-License-Identifier: BSD-3-Clause
// What the fault campaign asks for; no flight.
#include "bench/faults/rules.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <iterator>
#include <string>

#include "bench/faults/test/leg_cases.hpp"

namespace rosflight::bench::faults {
namespace {

TEST(FaultRules, ACrashIsAllowedForTheReasonsOnTheListOnly) {
  EXPECT_EQ(rule_of(fixedwing("servo1_stuck")), Rule::kPitchSurface);
  EXPECT_EQ(rule_of(fixedwing("servo0_stuck")), Rule::kNone);
  EXPECT_EQ(rule_of(multirotor("motor0_dead:1")), Rule::kRotorDead);
  EXPECT_EQ(rule_of(fixedwing("motor0_dead:1")), Rule::kNone) << "a fixed wing glides";
  EXPECT_EQ(rule_of(multirotor("motor0_partial=0.5")), Rule::kNone);
  EXPECT_EQ(rule_of(multirotor("imu_stuck:1")), Rule::kImuGone);
  EXPECT_EQ(rule_of(multirotor("imu:0.3")), Rule::kNone);
  EXPECT_EQ(rule_of(multirotor("gyro_step_z=0.5")), Rule::kGyroBeyond);
  EXPECT_EQ(rule_of(multirotor("gyro_step_z=0.1")), Rule::kNone);
  EXPECT_EQ(rule_of(multirotor("link_cut:3", "idle")), Rule::kPilotHasIt);
  EXPECT_EQ(rule_of(multirotor("link_cut:3", "hover")), Rule::kNone);
  EXPECT_EQ(rule_of(multirotor("companion_stall:1", "idle")), Rule::kNone);
  EXPECT_EQ(rule_of(fixedwing("link_cut:3")), Rule::kNone);
  EXPECT_EQ(rule_of(fixedwing("gnss", "servo2_stuck")), Rule::kPitchSurface)
      << "the second of a pair";
}

TEST(FaultRules, ANearlyEmptyBatteryExplainsNoHardLanding) {
  EXPECT_EQ(rule_of(multirotor("battery_low")), Rule::kNone);
  EXPECT_EQ(rule_of(multirotor("battery_low", "hover", "link_cut:3")), Rule::kNone);
  EXPECT_EQ(rule_of(multirotor("battery_low", "hover", "companion_stall:1")), Rule::kNone);
  EXPECT_EQ(rule_of(multirotor("battery_low", "idle", "link_cut:3")), Rule::kPilotHasIt);
}

TEST(FaultRules, WhatNeedsTheMissionIsNotExplainedByASoftLanding) {
  EXPECT_TRUE(explained(multirotor("gnss:20"), Class::kMissionDone));
  EXPECT_FALSE(explained(multirotor("gnss:20"), Class::kLandedElsewhere));
  EXPECT_FALSE(explained(multirotor("companion_stall:1", "idle"), Class::kLandedElsewhere));
  EXPECT_TRUE(explained(multirotor("gnss"), Class::kLandedElsewhere));
  EXPECT_FALSE(explained(multirotor("gnss"), Class::kTimeout));
  EXPECT_FALSE(explained(multirotor("gnss"), Class::kHardLanding));
  EXPECT_TRUE(explained(multirotor("imu_stuck:1"), Class::kCrash));
  EXPECT_FALSE(explained(multirotor("rc_silence:10"), Class::kLandedElsewhere));
  Case failsafe = multirotor("rc_silence:10");
  failsafe.failsafe_command = true;
  EXPECT_TRUE(explained(failsafe, Class::kLandedElsewhere));
  EXPECT_FALSE(explained(failsafe, Class::kCrash));
  EXPECT_TRUE(explained(multirotor("gnss:20", "hover", "mag"), Class::kLandedElsewhere))
      << "a pair";
  EXPECT_FALSE(explained(multirotor("link_cut:3", "hover"), Class::kLandedElsewhere));
  EXPECT_TRUE(explained(multirotor("link_cut:3", "idle"), Class::kCrash));
}

/// The list of faults after which the mission has to be done: multirotor with a hovering and an idle
/// stick, fixed wing.
struct Needed {
  const char* fault;
  bool hover;
  bool idle;
  bool fixed_wing;
};
constexpr Needed kNeeded[]{{"link_cut:3", true, false, true},
                           {"gnss:20", true, true, true},
                           {"crash", true, true, true},
                           {"hang", true, true, true},
                           {"mag", true, true, true},
                           {"baro", true, true, true},
                           {"range", true, true, true},
                           {"battery", true, true, true},
                           {"pitot_blocked", false, false, true},
                           {"motor0_partial=0.8", true, true, true},
                           {"rc_frame_loss:2", true, true, true},
                           {"companion_stall:1", true, true, true},
                           {"link_noise=0.01", true, true, true}};

TEST(FaultRules, TheMissionIsNeededAfterTheFaultsOfTheListAndNoOther) {
  std::size_t found = 0;
  for (std::size_t s = 0; s < subjects().size(); ++s) {
    const bool fixed_wing = subjects()[s].fixed_wing;
    for (const char* pilot : {"hover", "idle"}) {
      const bool hover = pilot == std::string("hover");
      for (const FaultRow& row : fault_rows(fixed_wing)) {
        const bool silence = row.text == "rc_silence:2" || row.text == "rc_silence:10";
        bool expected = silence && hover;
        for (const Needed& needed : kNeeded) {
          if (row.text != needed.fault) continue;
          ++found;
          expected = fixed_wing ? needed.fixed_wing : hover ? needed.hover : needed.idle;
        }
        for (const char* phase : subjects()[s].phases) {
          Case c{s, pilot, row.text, "", phase, false};
          EXPECT_EQ(needs_mission(c), expected) << row.text << ' ' << pilot << ' ' << phase;
          c.failsafe_command = true;
          EXPECT_FALSE(needs_mission(c)) << row.text << ": a class of its own";
          c.failsafe_command = false;
          c.second = "mag";
          EXPECT_FALSE(needs_mission(c)) << row.text << " in a pair";
        }
      }
    }
  }
  EXPECT_EQ(found, 2 * (std::size(kNeeded) - 1) + 2 * std::size(kNeeded))
      << "every fault of the list is flown; multirotors have no pitot tube";
}

TEST(FaultRules, AVehicleMayStayOnTheGroundForAFaultBeforeLiftOffOnly) {
  for (std::size_t s = 0; s < subjects().size(); ++s) {
    for (const char* phase : subjects()[s].phases) {
      const bool allowed = phase == std::string("armed") || phase == std::string("roll");
      for (const char* fault : {"link_cut:8", "imu_stuck:1", "battery_low"}) {
        const Case c{s, "hover", fault, "", phase, false};
        EXPECT_EQ(explained(c, Class::kNotFlown), allowed) << phase << ' ' << fault;
        EXPECT_EQ(allowed_by(c, Class::kNotFlown), allowed ? Rule::kTakeOffGivenUp : Rule::kNone);
        EXPECT_FALSE(explained(c, Class::kTimeout)) << "with its motors on, or in the air";
      }
      const Case needed{s, "hover", "crash", "", phase, false};
      EXPECT_FALSE(explained(needed, Class::kNotFlown)) << phase << ": the mission has to be done";
    }
  }
  const Case beyond{0, "hover", "gnss", "", kAfterLiftOff, false};
  EXPECT_FALSE(explained(beyond, Class::kNotFlown));
  const Case on_ground{0, "hover", "gnss", "", kBeforeLiftOff, false};
  EXPECT_TRUE(explained(on_ground, Class::kNotFlown));
  EXPECT_EQ(allowed_by(on_ground, Class::kCrash), Rule::kNone) << "R6 allows no crash";
  EXPECT_EQ(allowed_by(on_ground, Class::kMissionDone), Rule::kNone);
}

}  // namespace
}  // namespace rosflight::bench::faults
