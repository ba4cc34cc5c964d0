// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/adis16500.hpp"

#include "firmware/boards/parts/models/adis16500_model.hpp"
#include "firmware/boards/parts/test/sensor_rig.hpp"

namespace rosflight::boards::parts {
namespace {

using hal::microseconds;
using hal::milliseconds;

class Adis16500Test : public SensorTest<hal::ImuSample>, private OutputPin {
 protected:
  Adis16500Test() {
    spi_.connect(0, model_);
    rig_.add(driver_);
    model_.line = [this](bool high, Time when) {
      if (high) driver_.data_ready(when);
    };
  }
  Driver& driver() override { return driver_; }
  hal::Source<hal::ImuSample>& source() override { return driver_; }
  void set(bool high) override {
    model_.advance(rig_.now());
    model_.reset_pin(high);
    if (!high) ++resets_;
  }

  models::ImuTruth truth_{{0.0, 0.0, -9.80665}, {}, 298.15};
  std::function<models::ImuTruth(Time)> exposure_{[this](Time) { return truth_; }};
  Rig::Spi spi_{rig_, 1e6};
  SharedPort port_{spi_.bus, 0, true};
  models::Adis16500Model model_{[this](Time t) { return exposure_(t); }};
  Adis16500 driver_{port_, *this, {400, {{0, 1, 2}, {-1.0f, -1.0f, 1.0f}}}};
  int resets_{0};
};

TEST_F(Adis16500Test, MeasuresWhatItIsExposedTo) {
  truth_ = {{1.5, -20.0, 30.0}, {0.5, -3.0, 20.0}, 313.15};
  run();
  const hal::ImuSample sample = last();
  EXPECT_NEAR(sample.accel_m_s2[0], -1.5f, 1e-5f);
  EXPECT_NEAR(sample.accel_m_s2[1], 20.0f, 1e-5f);
  EXPECT_NEAR(sample.accel_m_s2[2], 30.0f, 1e-5f);
  EXPECT_NEAR(sample.gyro_rad_s[0], -0.5f, 1e-5f);
  EXPECT_NEAR(sample.gyro_rad_s[1], 3.0f, 1e-5f);
  EXPECT_NEAR(sample.gyro_rad_s[2], 20.0f, 1e-5f);
  EXPECT_NEAR(sample.temperature_K, 313.15f, 0.06f);
  EXPECT_EQ(driver_.errors(), 0);
  EXPECT_EQ(model_.complaints(), std::vector<std::string>{});
}

TEST_F(Adis16500Test, DeliversFourHundredSamplesASecond) {
  run();
  last();
  const auto all = samples(milliseconds(1000));
  EXPECT_EQ(all.size(), 400u);
  for (std::size_t k = 1; k < all.size(); ++k) {
    EXPECT_EQ(all[k].stamp - all[k - 1].stamp, microseconds(2500));
  }
}

TEST_F(Adis16500Test, StampIsTheEdgeLessTheGroupDelay) {
  EXPECT_EQ(Adis16500::group_delay(400), microseconds(2510));
  EXPECT_EQ(Adis16500::group_delay(2000), microseconds(1510));
  exposure_ = [](Time t) {
    models::ImuTruth truth{{0, 0, -9.80665}, {}, 298.15};
    truth.gyro_rad_s[2] = 1e-5 * static_cast<double>(t.count());
    return truth;
  };
  run();
  EXPECT_EQ(model_.delay_us(), 2510.0);
  last();
  for (const auto& sample : samples(milliseconds(50))) {
    EXPECT_NEAR(sample.gyro_rad_s[2], 1e-5 * static_cast<double>(sample.stamp.count()), 2e-5);
  }
}

TEST_F(Adis16500Test, ConfiguresAfterAResetOfSufficientLength) {
  run();
  EXPECT_EQ(resets_, 1);
  EXPECT_EQ(model_.reg(0x64), 4);
  EXPECT_EQ(model_.reg(0x60), 0x0285);
  EXPECT_EQ(model_.reg(0x5C), 0);
}

TEST_F(Adis16500Test, ABurstWithAWrongChecksumIsDropped) {
  run();
  last();
  model_.wrong_checksum = true;
  EXPECT_LE(samples(milliseconds(30)).size(), 1u);
  EXPECT_GT(driver_.errors(), 5);
  model_.wrong_checksum = false;
  EXPECT_GE(samples(milliseconds(30)).size(), 11u);
  EXPECT_EQ(driver_.announcements(), 1);
  model_.wrong_checksum = true;
  rig_.run_for(milliseconds(300));
  EXPECT_STREQ(driver_.message(), "ADIS16500: checksums are wrong");
}

TEST_F(Adis16500Test, ABurstWithAStatusIsDropped) {
  run();
  last();
  model_.status = 0x0020;
  EXPECT_LE(samples(milliseconds(40)).size(), 1u);
  rig_.run_for(milliseconds(40));
  model_.status = 0;
  rig_.run_for(milliseconds(1500));
  EXPECT_FALSE(samples(milliseconds(50)).empty());
}

TEST_F(Adis16500Test, SaysWhatIsWrong) {
  model_.product = 0x4075;
  start();
  rig_.run_for(milliseconds(500));
  EXPECT_STREQ(driver_.message(), "ADIS16500: identity 0x4075, expected 0x4074");
  model_.product = 0x4074;
  model_.status = 0x0080;
  rig_.run_for(milliseconds(1500));
  EXPECT_STREQ(driver_.message(), "ADIS16500: register 0x02 is 0x0080, expected 0x0000");
  model_.status = 0;
  model_.lose_writes = 1000;
  rig_.run_for(milliseconds(1500));
  EXPECT_STREQ(driver_.message(), "ADIS16500: register 0x64 is 0x0000, expected 0x0004");
  model_.lose_writes = 0;
  model_.mute = true;
  rig_.run_for(milliseconds(1500));
  EXPECT_STREQ(driver_.message(), "ADIS16500: identity 0xFFFF, expected 0x4074");
  EXPECT_EQ(driver_.announcements(), 1);
  model_.mute = false;
  EXPECT_FALSE(samples(milliseconds(2000)).empty());
}

TEST_F(Adis16500Test, LostWritesAreRepeated) {
  start();
  rig_.run_for(milliseconds(352));
  model_.lose_writes = 3;
  time_to_run();
  EXPECT_EQ(driver_.state(), PartState::kRunning) << driver_.message();
  EXPECT_EQ(model_.reg(0x60), 0x0285);
}

TEST_F(Adis16500Test, WithoutItsClockOrItsEdgesItFails) {
  run();
  last();
  model_.sync_clock = false;
  rig_.run_for(milliseconds(500));
  EXPECT_STREQ(driver_.message(), "ADIS16500: no data ready");
  model_.sync_clock = true;
  EXPECT_FALSE(samples(milliseconds(2000)).empty());
}

TEST_F(Adis16500Test, StuckAndFaultyBusesAreSaid) {
  start();
  spi_.fault = true;
  rig_.run_for(milliseconds(500));
  EXPECT_STREQ(driver_.message(), "ADIS16500: bus fault");
  spi_.fault = false;
  spi_.stuck = true;
  rig_.run_for(milliseconds(1500));
  EXPECT_STREQ(driver_.message(), "ADIS16500: bus stuck");
  start();  // with a transfer on the bus or not
  spi_.stuck = false;
  EXPECT_FALSE(samples(milliseconds(2500)).empty());
}

TEST_F(Adis16500Test, ABrownOutInFlightIsRepaired) {
  run();
  last();
  model_.set_power(false);
  rig_.run_for(milliseconds(1));
  model_.set_power(true);
  rig_.run_for(milliseconds(2000));
  EXPECT_EQ(model_.reg(0x60), 0x0285);
  EXPECT_FALSE(samples(milliseconds(50)).empty());
}

TEST_F(Adis16500Test, AnEdgeWhileReadingIsCountedAsOverrun) {
  driver_.data_ready(rig_.now());
  EXPECT_EQ(driver_.overruns(), 0u);
  run();
  driver_.data_ready(rig_.now());
  driver_.data_ready(rig_.now());
  EXPECT_EQ(driver_.overruns(), 1u);
  rig_.run_for(milliseconds(100));
  EXPECT_GT(driver_.dropped(), 0u);
}

TEST_F(Adis16500Test, AWarmStartNeedsNoResetAndTakesTenMilliseconds) {
  run();
  last();
  model_.set_reg(0x64, 7);  // found wrong, written
  const std::uint64_t before = model_.samples;
  start(Start::kWarm);
  EXPECT_LE(time_to_run(), milliseconds(16));
  EXPECT_EQ(model_.reg(0x64), 4);
  EXPECT_EQ(resets_, 1);
  EXPECT_GT(model_.samples, before);
  start(Start::kWarm);
  EXPECT_LE(time_to_run(), milliseconds(11));
}

}  // namespace
}  // namespace rosflight::boards::parts
