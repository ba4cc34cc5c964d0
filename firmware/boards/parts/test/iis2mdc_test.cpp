// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/iis2mdc.hpp"

#include "firmware/boards/parts/models/iis2mdc_model.hpp"
#include "firmware/boards/parts/test/sensor_rig.hpp"

namespace rosflight::boards::parts {
namespace {

using hal::milliseconds;

class Iis2mdcTest : public SensorTest<hal::MagSample> {
 protected:
  Iis2mdcTest() {
    spi_.connect(0, model_);
    rig_.add(driver_);
  }
  Driver& driver() override { return driver_; }
  hal::Source<hal::MagSample>& source() override { return driver_; }

  models::MagTruth truth_{{20e-6, -30e-6, 45e-6}, 310.15};
  models::MagExposure exposure_{[this](Time) { return truth_; }};
  Rig::Spi spi_{rig_, 4e6};
  SharedPort port_{spi_.bus, 0};
  models::Iis2mdcModel model_{[this](Time t) { return exposure_(t); }};
  Iis2mdc driver_{port_, Mounting{{0, 1, 2}, {-1.0f, 1.0f, -1.0f}}};
};

TEST_F(Iis2mdcTest, MeasuresWithZNegatedThenMounted) {
  run();
  const hal::MagSample sample = last();
  EXPECT_NEAR(sample.field_T[0], -20e-6f, 0.08e-6f);
  EXPECT_NEAR(sample.field_T[1], -30e-6f, 0.08e-6f);
  EXPECT_NEAR(sample.field_T[2], 45e-6f, 0.08e-6f);
  EXPECT_NEAR(sample.temperature_K, 310.15f, 0.07f);
  EXPECT_EQ(driver_.errors(), 0);
  EXPECT_EQ(model_.complaints(), std::vector<std::string>{});
}

TEST_F(Iis2mdcTest, TheOffsetOfTheSensorDropsOutOfEachPair) {
  model_.offset_T = {3e-6, -5e-6, 1e-6};
  run();
  for (const auto& sample : samples(milliseconds(100))) {
    EXPECT_NEAR(sample.field_T[0], -20e-6f, 0.16e-6f);
    EXPECT_NEAR(sample.field_T[1], -30e-6f, 0.16e-6f);
  }
}

TEST_F(Iis2mdcTest, StampIsTheMiddleOfThePair) {
  exposure_ = [](Time t) {
    return models::MagTruth{{0, 1e-9 * static_cast<double>(t.count()) - 200e-6, 0}, 298.15};
  };
  run();
  const auto all = samples(milliseconds(300));
  EXPECT_GE(all.size(), 28u);
  for (const auto& sample : all) {
    EXPECT_NEAR(sample.field_T[1], 1e-9 * static_cast<double>(sample.stamp.count()) - 200e-6,
                0.3e-6);
  }
}

TEST_F(Iis2mdcTest, ThreeWiresStayThreeWires) {
  run();
  EXPECT_EQ(model_.registers[0x62], 0x31);
  EXPECT_EQ(model_.registers[0x61], 0x12);
}

TEST_F(Iis2mdcTest, SaysWhatIsWrong) {
  model_.registers.faults.mute = true;
  start();
  rig_.run_for(milliseconds(100));
  EXPECT_STREQ(driver_.message(), "IIS2MDC: identity 0xFF, expected 0x40");
  model_.registers.faults.mute = false;
  EXPECT_FALSE(samples(milliseconds(1500)).empty());
  EXPECT_EQ(driver_.announcements(), 2);
}

TEST_F(Iis2mdcTest, ABrownOutIsNoticedWithTheNextReadingAndRepaired) {
  run();
  last();
  model_.set_power(false);
  model_.set_power(true);
  rig_.run_for(milliseconds(100));
  EXPECT_EQ(model_.registers[0x62], 0x31);
  EXPECT_FALSE(samples(milliseconds(100)).empty());
}

TEST_F(Iis2mdcTest, AMeasurementThatNeverEndsIsSaid) {
  run();
  last();
  model_.stalls = true;
  rig_.run_for(milliseconds(200));
  EXPECT_STREQ(driver_.message(), "IIS2MDC: no measurement, register 0x67 is 0x00");
}

TEST_F(Iis2mdcTest, BusFaultsCostSamplesOnly) {
  run();
  last();
  spi_.fault = true;
  rig_.run_for(milliseconds(5));
  spi_.fault = false;
  EXPECT_GE(samples(milliseconds(200)).size(), 15u);
  spi_.stuck = true;
  rig_.run_for(milliseconds(200));
  EXPECT_STREQ(driver_.message(), "IIS2MDC: bus stuck");
}

TEST_F(Iis2mdcTest, AWarmStartDoesNotReset) {
  run();
  last();
  const auto before = spi_.transfers;
  start(Start::kWarm);
  EXPECT_LE(time_to_run(), milliseconds(2));
  EXPECT_LE(spi_.transfers - before, 7u);
}

TEST_F(Iis2mdcTest, AWarmStartLetsAMeasurementOfBeforeEnd) {
  expect_warm_starts_let_a_measurement_end(model_);
}

}  // namespace
}  // namespace rosflight::boards::parts
