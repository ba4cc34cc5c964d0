// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "firmware/boards/parts/test/rig.hpp"

namespace rosflight::boards::parts {

/// What the tests of all sensors do: start a driver, let time go by, collect its samples.
template <class Sample>
class SensorTest : public testing::Test {
 protected:
  virtual Driver& driver() = 0;
  virtual hal::Source<Sample>& source() = 0;

  void start(Start how = Start::kCold) { driver().start(how, rig_.now()); }
  /// Until the part runs. @returns how long it took.
  Time time_to_run(Time limit = hal::milliseconds(1500)) {
    return rig_.run_until([this] { return driver().state() == PartState::kRunning; }, limit);
  }
  void run() {
    start();
    time_to_run();
    ASSERT_EQ(driver().state(), PartState::kRunning) << driver().message();
  }
  std::vector<Sample> samples(Time duration) {
    std::vector<Sample> all;
    const Time end = rig_.now() + duration;
    while (rig_.now() < end) {
      rig_.run_for(hal::milliseconds(1));
      Sample sample;
      while (source().poll(sample)) all.push_back(sample);
    }
    return all;
  }
  /// After a reset of the chip what was commanded before goes on: a warm start in any phase of it lets it end.
  template <class Model>
  void expect_warm_starts_let_a_measurement_end(Model& model) {
    for (int late_us = 0; late_us < 25'000; late_us += 700) {
      run();
      last();
      rig_.run_for(Time{late_us});
      start(Start::kWarm);
      time_to_run();
      EXPECT_FALSE(samples(hal::milliseconds(100)).empty());
    }
    EXPECT_EQ(model.complaints(), std::vector<std::string>{});
  }
  Sample last(Time duration = hal::milliseconds(100)) {
    const auto all = samples(duration);
    EXPECT_FALSE(all.empty()) << driver().message();
    return all.empty() ? Sample{} : all.back();
  }

  Rig rig_;
};

}  // namespace rosflight::boards::parts
