// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/ist8308.hpp"

#include "firmware/boards/parts/models/ist8308_model.hpp"
#include "firmware/boards/parts/test/sensor_rig.hpp"

namespace rosflight::boards::parts {
namespace {

using hal::milliseconds;

class Ist8308Test : public SensorTest<hal::MagSample> {
 protected:
  Ist8308Test() {
    i2c_.connect(model_);
    rig_.add(driver_);
  }
  Driver& driver() override { return driver_; }
  hal::Source<hal::MagSample>& source() override { return driver_; }

  models::MagTruth truth_{{20e-6, -30e-6, 45e-6}, 298.15};
  models::MagExposure exposure_{[this](Time) { return truth_; }};
  Rig::I2c i2c_{rig_, 100e3};
  SharedPort port_{i2c_.bus, Ist8308::kAddress};
  models::Ist8308Model model_{[this](Time t) { return exposure_(t); }};
  Ist8308 driver_{port_, Mounting{}};
};

TEST_F(Ist8308Test, MeasuresAllAxesWithTheSameScaleAndZDown) {
  run();
  const hal::MagSample sample = last();
  constexpr float kLsb = 0.1516e-6f;
  EXPECT_NEAR(sample.field_T[0], 20e-6f, 0.51f * kLsb);
  EXPECT_NEAR(sample.field_T[1], -30e-6f, 0.51f * kLsb);
  EXPECT_NEAR(sample.field_T[2], -45e-6f, 0.51f * kLsb);
  EXPECT_EQ(driver_.errors(), 0);
  EXPECT_EQ(model_.complaints(), std::vector<std::string>{});
}

TEST_F(Ist8308Test, DeliversAHundredSamplesASecondStampedWithTheirMiddle) {
  exposure_ = [](Time t) {
    return models::MagTruth{{1e-9 * static_cast<double>(t.count()) - 200e-6, 0, 0}, 298.15};
  };
  run();
  const auto all = samples(milliseconds(300));
  EXPECT_GE(all.size(), 29u);
  for (const auto& sample : all) {
    // 1 uT per ms, a bit is 0.15 uT.
    EXPECT_NEAR(sample.field_T[0], 1e-9 * static_cast<double>(sample.stamp.count()) - 200e-6,
                0.2e-6);
  }
}

TEST_F(Ist8308Test, ConfiguresRangeAndAveraging) {
  model_.registers[0x34] = 1;
  run();
  EXPECT_EQ(model_.registers[0x34], 0);
  EXPECT_EQ(model_.registers[0x41], 0x24);
}

TEST_F(Ist8308Test, SaysWhatIsWrong) {
  model_.registers.faults.answers[0x00] = 0x10;
  start();
  rig_.run_for(milliseconds(100));
  EXPECT_STREQ(driver_.message(), "IST8308: identity 0x10, expected 0x08");
  model_.registers.faults.answers.clear();
  model_.registers.faults.mute = true;
  rig_.run_for(milliseconds(1500));
  EXPECT_STREQ(driver_.message(), "IST8308: no answer");
  EXPECT_EQ(driver_.announcements(), 1);
  model_.registers.faults.mute = false;
  model_.reset_time = milliseconds(200);
  rig_.run_for(milliseconds(1000));
  EXPECT_STREQ(driver_.message(), "IST8308: not ready, register 0x32 is 0x01");
  model_.reset_time = milliseconds(45);
  EXPECT_FALSE(samples(milliseconds(2500)).empty());
  EXPECT_STREQ(driver_.message(), "IST8308: ok");
}

TEST_F(Ist8308Test, ABrownOutIsNoticedWithinASecondAndRepaired) {
  run();
  last();
  model_.set_power(false);
  rig_.run_for(milliseconds(5));
  model_.set_power(true);
  EXPECT_EQ(model_.registers[0x41], 0);
  rig_.run_for(milliseconds(1500));
  EXPECT_EQ(model_.registers[0x41], 0x24);
  EXPECT_FALSE(samples(milliseconds(100)).empty());
}

TEST_F(Ist8308Test, PulledOutItIsSaidOnceAndComesBack) {
  run();
  last();
  model_.registers.faults.mute = true;
  rig_.run_for(milliseconds(5000));
  EXPECT_STREQ(driver_.message(), "IST8308: no answer");
  EXPECT_EQ(driver_.announcements(), 2);
  model_.registers.faults.mute = false;
  rig_.run_for(milliseconds(1500));
  EXPECT_FALSE(samples(milliseconds(100)).empty());
  EXPECT_EQ(driver_.announcements(), 3);
}

TEST_F(Ist8308Test, AMeasurementThatNeverEndsIsSaid) {
  run();
  last();
  model_.stalls = true;
  rig_.run_for(milliseconds(200));
  EXPECT_STREQ(driver_.message(), "IST8308: no measurement, register 0x10 is 0x00");
  EXPECT_EQ(driver_.announcements(), 2);
}

TEST_F(Ist8308Test, AStuckBusIsFreed) {
  run();
  i2c_.stuck = true;
  rig_.run_for(milliseconds(200));
  EXPECT_GT(i2c_.aborts, 5);
  i2c_.stuck = false;
  rig_.run_for(milliseconds(1500));
  EXPECT_FALSE(samples(milliseconds(100)).empty());
}

TEST_F(Ist8308Test, AWarmStartDoesNotReset) {
  run();
  last();
  model_.registers[0x41] = 0x2C;  // what a reset would clear, a warm start rewrites
  start(Start::kWarm);
  EXPECT_LE(time_to_run(), milliseconds(10));
  EXPECT_EQ(model_.registers[0x41], 0x24);
}

TEST_F(Ist8308Test, AWarmStartLetsAMeasurementOfBeforeEnd) {
  expect_warm_starts_let_a_measurement_end(model_);
}

}  // namespace
}  // namespace rosflight::boards::parts
