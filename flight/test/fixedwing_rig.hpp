// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include "flight/test/flight_rig.hpp"

namespace rosflight::flight::testing {

inline FlightChoice fixedwing(const std::string& mission, std::vector<std::string> faults = {}) {
  FlightChoice choice = Rig::with_faults(std::move(faults));
  choice.vehicle = "anaconda";
  choice.mission = mission;
  return choice;
}

inline const FixedWingRecord& record(const Rig& rig) {
  return *rig.flight->fixedwing_record();
}

inline void expect_in_control(const Rig& rig) {
  EXPECT_LE(record(rig).roll.max, 60.0 * autonomy::kRadPerDeg);
  EXPECT_GE(record(rig).lowest_airspeed_m_s, 11.0);
}

inline void expect_touchdown(const Rig& rig, double within_m, double sink_m_s) {
  ASSERT_TRUE(record(rig).touchdown());
  EXPECT_LE(record(rig).touchdown()->distance_m, within_m);
  EXPECT_LE(record(rig).touchdown()->sink_m_s, sink_m_s);
}

inline void expect_tracked(const Rig& rig) {
  EXPECT_LE(record(rig).straight.rms(), 3.0);
  EXPECT_LE(record(rig).arc.rms(), 5.0);
  EXPECT_LE(record(rig).height.rms(), 2.0);
  EXPECT_LE(record(rig).airspeed.rms(), 1.0);
}

}  // namespace rosflight::flight::testing
