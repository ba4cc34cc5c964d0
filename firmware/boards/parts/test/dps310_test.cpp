// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/dps310.hpp"

#include <gtest/gtest.h>

#include "firmware/boards/parts/models/dps310_model.hpp"
#include "firmware/boards/parts/test/rig.hpp"

namespace rosflight::boards::parts {
namespace {

using hal::milliseconds;

class Dps310Test : public testing::TestWithParam<bool> {
 protected:
  Dps310Test() {
    spi_.connect(0, model_);
    rig_.add(driver_);
  }
  void run() {
    driver_.start(Start::kCold, rig_.now());
    rig_.run_until([this] { return driver_.state() == PartState::kRunning; }, milliseconds(500));
    ASSERT_EQ(driver_.state(), PartState::kRunning) << driver_.message();
  }
  std::vector<hal::BaroSample> samples(Time duration) {
    std::vector<hal::BaroSample> all;
    const Time end = rig_.now() + duration;
    while (rig_.now() < end) {
      rig_.run_for(milliseconds(5));
      hal::BaroSample sample;
      while (driver_.poll(sample)) all.push_back(sample);
    }
    return all;
  }

  models::BaroTruth truth_{90'000.0, 288.15};
  std::function<models::BaroTruth(Time)> exposure_{[this](Time) { return truth_; }};
  Rig rig_;
  Rig::Spi spi_{rig_, 4e6};
  SharedPort port_{spi_.bus, 0};
  models::Dps310Model model_{[this](Time t) { return exposure_(t); }, GetParam()};
  Dps310 driver_{port_, GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Wires, Dps310Test, testing::Values(false, true));

TEST_P(Dps310Test, MeasuresWhatItIsExposedTo) {
  run();
  for (const double pressure : {30'000.0, 90'000.0, 101'325.0, 110'000.0}) {
    for (const double temperature : {253.15, 288.15, 333.15}) {
      truth_ = {pressure, temperature};
      const auto all = samples(milliseconds(100));
      ASSERT_FALSE(all.empty());
      EXPECT_NEAR(all.back().pressure_Pa, pressure, 0.3);
      EXPECT_NEAR(all.back().temperature_K, temperature, 0.01);
    }
  }
  EXPECT_EQ(driver_.errors(), 0);
  EXPECT_EQ(model_.complaints(), std::vector<std::string>{});
}

TEST_P(Dps310Test, SamplesComeAlmostFiftyTimesASecondWithTheMiddleOfTheMeasurementAsStamp) {
  // 1000 Pa/s: a stamp that is 1 ms off is 1 Pa off.
  exposure_ = [](Time t) {
    return models::BaroTruth{90'000.0 + 1e-3 * static_cast<double>(t.count()), 288.15};
  };
  run();
  const auto all = samples(milliseconds(1000));
  EXPECT_GE(all.size(), 45u);
  for (const auto& sample : all) {
    EXPECT_NEAR(sample.pressure_Pa, 90'000.0 + 1e-3 * static_cast<double>(sample.stamp.count()),
                0.3);
  }
}

TEST_P(Dps310Test, TheWorkAroundIsApplied) {
  model_.needs_work_around = true;
  run();
  EXPECT_NEAR(samples(milliseconds(100)).back().temperature_K, 288.15, 0.01);
}

TEST_P(Dps310Test, TheTemperatureSensorIsTheOneOfTheCoefficients) {
  run();
  EXPECT_EQ(model_.registers[0x07] & 0x80, 0x80);
}

TEST_P(Dps310Test, SaysWhatIsWrong) {
  model_.registers.faults.answers[0x0D] = 0x11;
  driver_.start(Start::kCold, rig_.now());
  rig_.run_for(milliseconds(500));
  EXPECT_STREQ(driver_.message(), "DPS310: identity 0x11, expected 0x10");
  EXPECT_FALSE(samples(milliseconds(3000)).size());
  model_.registers.faults.answers.clear();
  EXPECT_GT(samples(milliseconds(1500)).size(), 10u);
  EXPECT_STREQ(driver_.message(), "DPS310: ok");
}

TEST_P(Dps310Test, CoefficientsThatAreNeverReadyAreSaid) {
  model_.registers.faults.answers[0x08] = 0x40;
  driver_.start(Start::kCold, rig_.now());
  rig_.run_for(milliseconds(500));
  EXPECT_STREQ(driver_.message(), "DPS310: not ready, register 0x08 is 0x40");
}

TEST_P(Dps310Test, AMeasurementThatNeverEndsIsSaidAndRepeated) {
  run();
  samples(milliseconds(50));
  model_.stalls = true;
  rig_.run_for(milliseconds(100));
  EXPECT_EQ(driver_.announcements(), 2) << "ok, and one failure";
  EXPECT_STREQ(driver_.message(), "DPS310: no measurement, register 0x08 is 0xC2");
  model_.stalls = false;
  rig_.run_for(milliseconds(1500));
  EXPECT_GT(samples(milliseconds(200)).size(), 5u);
}

TEST_P(Dps310Test, SurvivesBusFaultsAndABrownOut) {
  run();
  samples(milliseconds(50));
  spi_.fault = true;
  rig_.run_for(milliseconds(7));
  spi_.fault = false;
  EXPECT_GT(samples(milliseconds(200)).size(), 5u);
  model_.set_power(false);
  rig_.run_for(milliseconds(5));
  model_.set_power(true);
  rig_.run_for(milliseconds(1600));
  const auto all = samples(milliseconds(200));
  ASSERT_GT(all.size(), 5u) << driver_.message();
  EXPECT_NEAR(all.back().pressure_Pa, 90'000.0, 0.3);
  spi_.stuck = true;
  rig_.run_for(milliseconds(300));
  EXPECT_NE(driver_.state(), PartState::kRunning);
  spi_.stuck = false;
  rig_.run_for(milliseconds(1600));
  EXPECT_EQ(driver_.state(), PartState::kRunning);
}

TEST_P(Dps310Test, AfterABrownOutTheWorkAroundIsAppliedAgain) {
  model_.needs_work_around = true;
  run();
  model_.set_power(false);
  model_.set_power(true);
  rig_.run_for(milliseconds(1600));
  EXPECT_NEAR(samples(milliseconds(100)).back().temperature_K, 288.15, 0.01);
}

TEST_P(Dps310Test, FaultsDuringTheStartAreRepeated) {
  driver_.start(Start::kCold, rig_.now());
  // Behind the set-up come source, coefficients and the choice of the sensor.
  rig_.run_until([this] { return model_.registers[0x06] == 0x63; }, milliseconds(300));
  spi_.fault = true;
  rig_.run_for(milliseconds(4));
  spi_.fault = false;
  rig_.run_for(milliseconds(1500));
  EXPECT_EQ(driver_.state(), PartState::kRunning) << driver_.message();
}

TEST_P(Dps310Test, AWarmStartNeitherResetsNorWaits) {
  run();
  samples(milliseconds(50));
  driver_.start(Start::kWarm, rig_.now());
  const Time taken =
      rig_.run_until([this] { return driver_.state() == PartState::kRunning; }, milliseconds(100));
  EXPECT_LE(taken, milliseconds(3));
  EXPECT_NEAR(samples(milliseconds(100)).back().pressure_Pa, 90'000.0, 0.3);
}

TEST_P(Dps310Test, AWarmStartLetsAMeasurementOfBeforeEnd) {
  for (int late_us = 0; late_us < 25'000; late_us += 700) {
    run();
    samples(milliseconds(50));
    rig_.run_for(Time{late_us});
    driver_.start(Start::kWarm,
                  rig_.now());  // as after a reset of the chip: what was commanded goes on
    EXPECT_FALSE(samples(milliseconds(100)).empty());
  }
  EXPECT_EQ(model_.complaints(), std::vector<std::string>{});
}

TEST(Dps310, UnpacksCoefficientsOfTheDataSheetsLayout) {
  // c0 = -1, c1 = 0x7FF, c00 = 0x12345, c10 = -2, then c01 .. c30 = 1, -1, 0x7FFF, -0x8000, 5.
  const auto c = Dps310::unpack({0xFF, 0xF7, 0xFF, 0x12, 0x34, 0x5F, 0xFF, 0xFE, 0x00, 0x01, 0xFF,
                                 0xFF, 0x7F, 0xFF, 0x80, 0x00, 0x00, 0x05});
  EXPECT_EQ(c.c0, -1);
  EXPECT_EQ(c.c1, 0x7FF);
  EXPECT_EQ(c.c00, 0x12345);
  EXPECT_EQ(c.c10, -2);
  EXPECT_EQ(c.c01, 1);
  EXPECT_EQ(c.c11, -1);
  EXPECT_EQ(c.c20, 0x7FFF);
  EXPECT_EQ(c.c21, -0x8000);
  EXPECT_EQ(c.c30, 5);
}

TEST(Dps310, CompensatesByTheDataSheetsFormula) {
  // By hand: 100 + 0.5 (10 + 0.5 (4 + 0.5 8)) + 2 6 + 2 0.5 (3 + 0.5 2) = 123.
  const Dps310::Coefficients c{20, 3, 100, 10, 6, 3, 4, 2, 8};
  EXPECT_FLOAT_EQ(Dps310::pressure_Pa(c, 0.5f, 2.0f), 100 + 7 + 12 + 4);
  EXPECT_FLOAT_EQ(Dps310::temperature_K(c, 2.0f), 273.15f + 10.0f + 6.0f);
}

}  // namespace
}  // namespace rosflight::boards::parts
