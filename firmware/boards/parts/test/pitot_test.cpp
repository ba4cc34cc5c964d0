// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "firmware/boards/parts/dlhr.hpp"
#include "firmware/boards/parts/models/pitot_models.hpp"
#include "firmware/boards/parts/ms4525do.hpp"
#include "firmware/boards/parts/test/sensor_rig.hpp"

namespace rosflight::boards::parts {
namespace {

using hal::milliseconds;

models::DiffPressureTruth ramp(Time t) {
  return {1e-3 * static_cast<double>(t.count()) - 500.0, 298.15};  // 1000 Pa/s
}

// ---- MS4525DO

class Ms4525doTest : public SensorTest<hal::DiffPressureSample> {
 protected:
  Ms4525doTest() {
    i2c_.connect(model_);
    rig_.add(driver_);
  }
  Driver& driver() override { return driver_; }
  hal::Source<hal::DiffPressureSample>& source() override { return driver_; }

  models::DiffPressureTruth truth_{400.0, 303.15};
  models::DiffPressureExposure exposure_{[this](Time) { return truth_; }};
  Rig::I2c i2c_{rig_, 100e3};
  SharedPort port_{i2c_.bus, Ms4525do::kAddress};
  models::Ms4525doModel model_{[this](Time t) { return exposure_(t); }};
  Ms4525do driver_{port_};
};

TEST_F(Ms4525doTest, ScalesAreThoseOfTheDataSheet) {
  // 50 % of the counts is 0, 10 % is -1 psi, 90 % is +1 psi.
  EXPECT_NEAR(Ms4525do::pressure_Pa(1638.3f + 6553.2f), 0.0f, 1e-3f);
  EXPECT_NEAR(Ms4525do::pressure_Pa(1638.3f), -6894.76f, 0.01f);
  EXPECT_NEAR(Ms4525do::pressure_Pa(14744.7f), 6894.76f, 0.01f);
  EXPECT_NEAR(Ms4525do::temperature_K(0.0f), 223.15f, 1e-3f);
  EXPECT_NEAR(Ms4525do::temperature_K(2047.0f), 423.15f, 1e-3f);
}

TEST_F(Ms4525doTest, MeasuresAHundredTimesASecond) {
  run();
  const auto all = samples(milliseconds(500));
  EXPECT_GE(all.size(), 48u);
  EXPECT_NEAR(all.back().pressure_Pa, 400.0f, 0.6f);
  EXPECT_NEAR(all.back().temperature_K, 303.15f, 0.06f);
  EXPECT_STREQ(driver_.message(), "MS4525DO: ok");
  EXPECT_EQ(driver_.errors(), 0);
}

TEST_F(Ms4525doTest, FourOfFiveReadingsLeaveTheTemperatureOut) {
  run();
  const std::size_t before = model_.bytes_read;
  const auto all = samples(milliseconds(1000));
  const std::size_t read = model_.bytes_read - before;
  EXPECT_NEAR(static_cast<double>(read), 12.0 * static_cast<double>(all.size()), 12.0);
  EXPECT_NEAR(all.back().temperature_K, 303.15f, 0.06f);
}

TEST_F(Ms4525doTest, StampIsTheMiddleOfTheReadings) {
  exposure_ = ramp;
  run();
  last();
  for (const auto& sample : samples(milliseconds(100))) {
    const double at_stamp = 1e-3 * static_cast<double>(sample.stamp.count()) - 500.0;
    EXPECT_NEAR(sample.pressure_Pa, at_stamp, 2.5);  // a reading is that of the one before: 2 ms
  }
}

TEST_F(Ms4525doTest, StaleReadingsDoNotCount) {
  run();
  last();
  model_.stuck_stale = true;
  EXPECT_LE(samples(milliseconds(100)).size(), 1u);
  EXPECT_EQ(driver_.errors(), 0);
}

TEST_F(Ms4525doTest, AFaultOfThePartIsSaid) {
  run();
  last();
  model_.fault = true;
  EXPECT_LE(samples(milliseconds(200)).size(), 1u);
  EXPECT_STREQ(driver_.message(), "MS4525DO: fault reported by the part");
  EXPECT_EQ(driver_.announcements(), 2);
  model_.fault = false;
  EXPECT_FALSE(samples(milliseconds(1200)).empty());
}

TEST_F(Ms4525doTest, AMissingPartIsSaidOnceAndFoundLater) {
  model_.mute = true;
  start();
  rig_.run_for(milliseconds(3000));
  EXPECT_STREQ(driver_.message(), "MS4525DO: no answer");
  EXPECT_EQ(driver_.announcements(), 1);
  model_.mute = false;
  EXPECT_FALSE(samples(milliseconds(1200)).empty());
}

TEST_F(Ms4525doTest, AStartDuringATransferWaitsForIt) {
  run();
  i2c_.stuck = true;
  rig_.run_for(milliseconds(3));
  start();
  EXPECT_EQ(driver_.state(), PartState::kFailed);
  i2c_.stuck = false;
  rig_.run_for(milliseconds(20));
  EXPECT_EQ(driver_.state(), PartState::kRunning);
}

// ---- DLHR-L20G

class DlhrTest : public SensorTest<hal::DiffPressureSample> {
 protected:
  DlhrTest() {
    i2c_.connect(model_);
    rig_.add(driver_);
    model_.line = [this](bool high, Time when) {
      if (high && pin_) driver_.conversion_done(when);
    };
  }
  Driver& driver() override { return driver_; }
  hal::Source<hal::DiffPressureSample>& source() override { return driver_; }

  models::DiffPressureTruth truth_{400.0, 303.15};
  models::DiffPressureExposure exposure_{[this](Time) { return truth_; }};
  Rig::I2c i2c_{rig_, 100e3};
  SharedPort port_{i2c_.bus, Dlhr::kAddress};
  models::DlhrModel model_{[this](Time t) { return exposure_(t); }};
  Dlhr driver_{port_};
  bool pin_{true};
};

TEST_F(DlhrTest, ScalesAreThoseOfTheDataSheet) {
  EXPECT_NEAR(Dlhr::pressure_Pa(1677722), 0.0f, 0.01f);               // 10 % of 2^24
  EXPECT_NEAR(Dlhr::pressure_Pa(15099494), 4981.8f, 0.1f);            // 90 %
  EXPECT_NEAR(Dlhr::temperature_K(8388608), 273.15f + 22.5f, 1e-3f);  // middle
}

TEST_F(DlhrTest, MeasuresAHundredTimesASecondWithAndWithoutItsPin) {
  for (const bool pin : {true, false}) {
    pin_ = pin;
    run();
    const auto all = samples(milliseconds(500));
    EXPECT_GE(all.size(), 48u) << pin;
    EXPECT_NEAR(all.back().pressure_Pa, 400.0f, 0.01f);
    EXPECT_NEAR(all.back().temperature_K, 303.15f, 0.01f);
  }
  EXPECT_EQ(driver_.errors(), 0);
}

TEST_F(DlhrTest, TheCommandHasThreeBytes) {
  run();
  last();
  EXPECT_EQ(model_.complaints(), std::vector<std::string>{});
}

TEST_F(DlhrTest, StampIsTheMiddleOfTheMeasurement) {
  exposure_ = ramp;
  run();
  last();
  for (const auto& sample : samples(milliseconds(100))) {
    EXPECT_NEAR(sample.pressure_Pa, 1e-3 * static_cast<double>(sample.stamp.count()) - 500.0, 0.1);
  }
}

TEST_F(DlhrTest, SaysWhatIsWrong) {
  model_.error_bits = 0x04;
  start();
  rig_.run_for(milliseconds(100));
  EXPECT_STREQ(driver_.message(), "DLHR: status 0x44, expected 0x40");
  model_.error_bits = 0;
  model_.mute = true;
  rig_.run_for(milliseconds(1500));
  EXPECT_STREQ(driver_.message(), "DLHR: no answer");
  EXPECT_EQ(driver_.announcements(), 1);
  model_.mute = false;
  i2c_.fault = true;
  rig_.run_for(milliseconds(1500));
  EXPECT_STREQ(driver_.message(), "DLHR: bus fault");
  i2c_.fault = false;
  EXPECT_FALSE(samples(milliseconds(1500)).empty());
}

TEST_F(DlhrTest, AnErrorOfThePartInFlightIsSaidAndDropsItsSamples) {
  run();
  last();
  model_.error_bits = 0x01;
  EXPECT_TRUE(samples(milliseconds(150)).empty());
  rig_.run_for(milliseconds(200));
  EXPECT_STREQ(driver_.message(), "DLHR: status 0x41, expected 0x40");
  model_.error_bits = 0;
  EXPECT_FALSE(samples(milliseconds(1500)).empty());
}

TEST_F(DlhrTest, AnEdgeOutOfTurnIsIgnored) {
  driver_.conversion_done(rig_.now());
  run();
  driver_.conversion_done(rig_.now());
  EXPECT_FALSE(samples(milliseconds(50)).empty());
  EXPECT_EQ(driver_.errors(), 0);
}

TEST_F(DlhrTest, PulledOutInFlightItComesBack) {
  run();
  last();
  model_.mute = true;
  rig_.run_for(milliseconds(500));
  EXPECT_STREQ(driver_.message(), "DLHR: no answer");
  model_.mute = false;
  EXPECT_FALSE(samples(milliseconds(1500)).empty());
}

TEST_F(DlhrTest, AWarmStartLetsAMeasurementOfBeforeEnd) {
  expect_warm_starts_let_a_measurement_end(model_);
}

}  // namespace
}  // namespace rosflight::boards::parts
