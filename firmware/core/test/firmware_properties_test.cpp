// SPDX-License-Identifier: BSD-3-Clause
// The promises of the whole firmware over random flights: a million passes from fixed seeds.
#include <gtest/gtest.h>

#include <cstdio>

#include "firmware/core/test/fly_random.hpp"

namespace rosflight::core {
namespace {

constexpr std::uint64_t kFirstSeed = 1;
constexpr std::uint64_t kFlights = 250;
constexpr int kPassesPerFlight = 4000;

/// All flights, flown once for all cases.
struct Flown {
  Coverage coverage;
  Violations violations;
};

const Flown& flown() {
  static const Flown kFlown = [] {
    Flown all;
    all.violations = fly_many(kFirstSeed, kFlights, kPassesPerFlight, all.coverage);
    std::printf("%s", all.coverage.report().c_str());
    return all;
  }();
  return kFlown;
}

TEST(FirmwareProperties, HoldOverAMillionPasses) {
  for (const auto& [name, entry] : flown().violations) {
    ADD_FAILURE() << entry.first << " flights, first " << reduced(entry.second);
  }
  EXPECT_GE(flown().coverage.passes, 1'000'000u);
}

// A property that no flight comes near is not tested.
TEST(FirmwareProperties, RandomFlightsReachWhatTheyAreAbout) {
  const Coverage& c = flown().coverage;
  EXPECT_GE(c.armed_passes, 200'000u);
  EXPECT_GE(c.failsafe_passes, 3'000u);
  EXPECT_GE(c.offboard_passes, 30'000u);
  EXPECT_GE(c.companion_in_failsafe_passes, 50u);
  EXPECT_GE(c.hold_passes, 500u);
  EXPECT_GE(c.armed_on_ground, 200u);
  EXPECT_GE(c.disarmed, 100u);
  EXPECT_GE(c.armed_after_fault, 10u);
  EXPECT_GE(c.calibrations_left, 50u);
  EXPECT_GE(c.receiver_lost_armed, 20u);
  EXPECT_GE(c.imu_lost_armed, 1'000u);
  EXPECT_GE(c.auxiliary_motor_passes, 5'000u);
  EXPECT_GE(c.foreign_messages, 3'000u);
  EXPECT_GE(c.parameter_changes, 3'000u);
  EXPECT_GE(c.motor_tests, 30u);
}

TEST(FirmwareProperties, RandomFlightsTakeEveryWayFromStateToState) {
  for (const Transition& row : kTransitions) {
    if (row.state == row.next) continue;
    if (row.state == State::kInit) continue;  // start() is no pass
    // A frame of the receiver ends the failsafe first; the row is for other disarm requests.
    if (row.state == State::kFailsafe && row.event == Event::kDisarm) continue;
    EXPECT_GT(flown().coverage.transitions[static_cast<std::size_t>(row.state)]
                                          [static_cast<std::size_t>(row.next)],
              0u)
        << "state " << static_cast<int>(row.state) << " to " << static_cast<int>(row.next);
  }
}

}  // namespace
}  // namespace rosflight::core
