// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/bmi088.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "firmware/boards/parts/models/bmi088_model.hpp"
#include "firmware/boards/parts/test/rig.hpp"

namespace rosflight::boards::parts {
namespace {

using hal::microseconds;
using hal::milliseconds;

constexpr double kGravity = 9.80665;

class Bmi088Test : public testing::Test {
 protected:
  Bmi088Test() {
    spi_.connect(0, model_.accel);
    spi_.connect(1, model_.gyro);
    rig_.add(driver_);
    model_.gyro.line = [this](bool high, Time when) {
      if (high && !lose_edges_) driver_.data_ready(when);
    };
  }
  void start(Start how = Start::kCold) { driver_.start(how, rig_.now()); }
  Time time_to_run(Time limit = milliseconds(500)) {
    return rig_.run_until([this] { return driver_.state() == PartState::kRunning; }, limit);
  }
  void run() {
    start();
    time_to_run();
    ASSERT_EQ(driver_.state(), PartState::kRunning) << driver_.message();
  }
  /// All samples of a time; the main loop polls once per tick.
  std::vector<hal::ImuSample> samples(Time duration) {
    std::vector<hal::ImuSample> all;
    const Time end = rig_.now() + duration;
    while (rig_.now() < end) {
      rig_.run_for(milliseconds(1));
      hal::ImuSample sample;
      while (driver_.poll(sample)) all.push_back(sample);
    }
    return all;
  }

  models::ImuTruth truth_{{0.0, 0.0, -kGravity}, {}, 298.15};
  std::function<models::ImuTruth(Time)> exposure_{[this](Time) { return truth_; }};
  Rig rig_;
  Rig::Spi spi_{rig_, 4e6};
  SharedPort accel_port_{spi_.bus, 0, true};
  SharedPort gyro_port_{spi_.bus, 1, true};
  models::Bmi088Model model_{[this](Time t) { return exposure_(t); }};
  Bmi088::Config config_{
      Bmi088::GyroRate::k2000Hz230, Bmi088::GyroRange::k2000, Bmi088::AccelRange::k24g, {}};
  Bmi088 driver_{accel_port_, gyro_port_, config_};
  bool lose_edges_{false};
};

TEST_F(Bmi088Test, StartsAndSaysSo) {
  run();
  samples(milliseconds(5));
  EXPECT_STREQ(driver_.message(), "BMI088: ok");
  EXPECT_EQ(driver_.announcements(), 1);
  EXPECT_EQ(driver_.errors(), 0);
  EXPECT_EQ(model_.accel.complaints(), std::vector<std::string>{});
  EXPECT_EQ(model_.gyro.complaints(), std::vector<std::string>{});
}

TEST_F(Bmi088Test, WritesTheRangesInsteadOfTrustingTheDefault) {
  run();
  EXPECT_EQ(model_.accel.registers[0x41], 3);  // 24 g; 6 g after reset
  EXPECT_EQ(model_.gyro.registers[0x0F], 0);
  EXPECT_EQ(model_.accel.registers[0x40], 0xAC);
}

TEST_F(Bmi088Test, MeasuresWhatItIsExposedTo) {
  truth_ = {{1.5, -20.0, 150.0}, {0.5, -3.0, 20.0}, 313.15};
  run();
  const auto all = samples(milliseconds(100));
  ASSERT_FALSE(all.empty());
  const hal::ImuSample& last = all.back();
  constexpr float kAccelLsb = 24.0f * 9.80665f / 32768.0f;
  constexpr float kGyroLsb = 2000.0f / 32768.0f * 0.017453293f;
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(last.accel_m_s2[k], truth_.accel_m_s2[k], 0.51f * kAccelLsb);
    EXPECT_NEAR(last.gyro_rad_s[k], truth_.gyro_rad_s[k], 0.51f * kGyroLsb);
  }
  EXPECT_NEAR(last.temperature_K, 313.15f, 0.07f);
}

TEST_F(Bmi088Test, TemperatureHasAllThreeLowBitsAndASign) {
  // 23.375 degC: the low bits are 3. -0.125 degC below 23: all ones.
  truth_.temperature_K = 273.15 + 23.375;
  run();
  EXPECT_NEAR(samples(milliseconds(10)).back().temperature_K, 296.525f, 1e-3f);
  truth_.temperature_K = 273.15 - 10.125;
  EXPECT_NEAR(samples(milliseconds(3000)).back().temperature_K, 263.025f, 1e-3f);
}

TEST_F(Bmi088Test, DeliversEveryGyroSampleOnce) {
  run();
  samples(milliseconds(10));
  const std::uint64_t before = model_.gyro.samples();
  const auto all = samples(milliseconds(1000));
  EXPECT_NEAR(static_cast<double>(all.size()), static_cast<double>(model_.gyro.samples() - before),
              1.0);
  EXPECT_EQ(all.size(), 2000u);
  for (std::size_t k = 1; k < all.size(); ++k) {
    EXPECT_EQ(all[k].stamp - all[k - 1].stamp, microseconds(500));
  }
  EXPECT_EQ(driver_.overruns(), 0u);
  EXPECT_EQ(driver_.dropped(), 0u);
}

TEST_F(Bmi088Test, StampIsTheEdgeLessTheGroupDelay) {
  // 230 Hz: 0.22508 / 230 = 979 us.
  EXPECT_EQ(Bmi088::group_delay(Bmi088::GyroRate::k2000Hz230), microseconds(979));
  EXPECT_EQ(Bmi088::group_delay(Bmi088::GyroRate::k2000Hz532), microseconds(423));
  // A ramp of the rate shows the delay of filter and driver together: none must be left.
  exposure_ = [](Time t) {
    models::ImuTruth truth{{0, 0, -kGravity}, {}, 298.15};
    truth.gyro_rad_s[2] = 1e-6 * 10.0 * static_cast<double>(t.count());
    return truth;
  };
  run();
  EXPECT_NEAR(model_.gyro.delay_us(), 979.0, 5.0) << "its filter is a digital one";
  samples(milliseconds(20));
  for (const hal::ImuSample& sample : samples(milliseconds(50))) {
    const double rate_at_stamp = 1e-5 * static_cast<double>(sample.stamp.count());
    // One LSB is 1 mrad/s, which the ramp passes in 107 us.
    EXPECT_NEAR(sample.gyro_rad_s[2], rate_at_stamp, 0.7e-3 * 1.07) << sample.stamp.count();
  }
}

TEST_F(Bmi088Test, AVibrationAboveTheBandwidthIsWeakened) {
  exposure_ = [](Time t) {
    models::ImuTruth truth{{0, 0, -kGravity}, {}, 298.15};
    truth.gyro_rad_s[0] =
        std::sin(2 * 3.14159265358979 * 700.0 * 1e-6 * static_cast<double>(t.count()));
    return truth;
  };
  run();
  samples(milliseconds(50));
  double most = 0;
  for (const auto& sample : samples(milliseconds(200))) {
    most = std::max(most, static_cast<double>(std::fabs(sample.gyro_rad_s[0])));
  }
  // (230/700)^2 = 0.108, less by the bilinear transformation.
  EXPECT_LT(most, 0.12);
  EXPECT_GT(most, 0.05);
}

TEST_F(Bmi088Test, MountingTurnsTheAxes) {
  Rig rig;
  Rig::Spi spi{rig, 4e6};
  models::Bmi088Model model{[this](Time) { return truth_; }};
  spi.connect(0, model.accel);
  spi.connect(1, model.gyro);
  SharedPort accel{spi.bus, 0};
  SharedPort gyro{spi.bus, 1};
  config_.mounting = {{1, 0, 2}, {1.0f, 1.0f, -1.0f}};
  truth_ = {{1.0, 2.0, 3.0}, {0.1, 0.2, 0.3}, 298.15};
  Bmi088 driver{accel, gyro, config_};
  rig.add(driver);
  model.gyro.line = [&](bool high, Time when) {
    if (high) driver.data_ready(when);
  };
  driver.start(Start::kCold, rig.now());
  rig.run_for(milliseconds(200));
  hal::ImuSample sample;
  while (driver.poll(sample)) {  // of the first filtering
  }
  rig.run_for(milliseconds(2));
  ASSERT_TRUE(driver.poll(sample)) << driver.message();
  EXPECT_NEAR(sample.accel_m_s2[0], 2.0f, 0.01f);
  EXPECT_NEAR(sample.accel_m_s2[1], 1.0f, 0.01f);
  EXPECT_NEAR(sample.accel_m_s2[2], -3.0f, 0.01f);
  EXPECT_NEAR(sample.gyro_rad_s[2], -0.3f, 0.001f);
}

TEST_F(Bmi088Test, OnlyRisingEdgesOfARunningPartCount) {
  driver_.data_ready(rig_.now());
  rig_.run_for(milliseconds(5));
  EXPECT_EQ(spi_.transfers, 0u);
}

// ---- what goes wrong

TEST_F(Bmi088Test, AWrongIdentityIsSaidAndTriedAgain) {
  model_.accel.registers.faults.answers[0x00] = 0x1F;
  start();
  rig_.run_for(milliseconds(900));
  EXPECT_STREQ(driver_.message(), "BMI088: accelerometer: identity 0x1F, expected 0x1E");
  EXPECT_EQ(driver_.state(), PartState::kFailed);
  rig_.run_for(milliseconds(5000));
  EXPECT_EQ(driver_.announcements(), 1) << "one text for all attempts";
  model_.accel.registers.faults.answers.clear();
  time_to_run(milliseconds(1500));
  samples(milliseconds(5));
  EXPECT_STREQ(driver_.message(), "BMI088: ok");
  EXPECT_EQ(driver_.announcements(), 2);
}

TEST_F(Bmi088Test, AMuteGyroIsSaid) {
  model_.gyro.registers.faults.mute = true;
  start();
  rig_.run_for(milliseconds(500));
  EXPECT_STREQ(driver_.message(), "BMI088: gyro: identity 0xFF, expected 0x0F");
}

TEST_F(Bmi088Test, LostWritesAreRepeated) {
  start();
  rig_.run_for(milliseconds(1));
  for (int k = 0; k < 20 && driver_.state() != PartState::kRunning; ++k) {
    model_.accel.registers.faults.lose_writes = 1;
    rig_.run_for(milliseconds(20));
  }
  rig_.run_for(milliseconds(500));
  EXPECT_EQ(driver_.state(), PartState::kRunning) << driver_.message();
  EXPECT_EQ(model_.accel.registers[0x7D], 0x04);
  EXPECT_EQ(driver_.errors(), 0);
}

TEST_F(Bmi088Test, ARegisterThatDoesNotHoldIsSaid) {
  model_.accel.registers.faults.flips[0x41] = 0x03;
  start();
  rig_.run_for(milliseconds(500));
  EXPECT_STREQ(driver_.message(), "BMI088: accelerometer: register 0x41 is 0x00, written 0x03");
}

TEST_F(Bmi088Test, AStuckBusIsSaidAndFreed) {
  spi_.stuck = true;
  start();
  rig_.run_for(milliseconds(20));
  EXPECT_STREQ(driver_.message(), "BMI088: accelerometer: bus stuck");
  EXPECT_GT(spi_.aborts, 0);
  spi_.stuck = false;
  time_to_run(milliseconds(1500));
  EXPECT_EQ(driver_.state(), PartState::kRunning);
}

TEST_F(Bmi088Test, FaultsWhileRunningCostSamplesAndThenAWarmStart) {
  run();
  samples(milliseconds(10));
  spi_.fault = true;
  samples(milliseconds(3));
  EXPECT_EQ(driver_.state(), PartState::kRunning) << "a few failures are forgiven";
  samples(milliseconds(3));
  EXPECT_STREQ(driver_.message(), "BMI088: accelerometer: bus fault");
  spi_.fault = false;
  EXPECT_LT(time_to_run(milliseconds(1500)), milliseconds(1200));
  EXPECT_GT(samples(milliseconds(10)).size(), 15u);
}

TEST_F(Bmi088Test, ABrownOutWhileRunningIsRepaired) {
  run();
  samples(milliseconds(10));
  model_.gyro.set_power(false);
  model_.gyro.set_power(true);  // set-up lost: no more edges
  rig_.run_for(milliseconds(200));
  time_to_run(milliseconds(1500));
  EXPECT_EQ(model_.gyro.registers[0x18], 0x01);
  EXPECT_GT(samples(milliseconds(10)).size(), 15u);
}

TEST_F(Bmi088Test, AnAccelerometerThatLostItsSetUpIsNoticedWithoutHelpOfTheGyro) {
  run();
  samples(milliseconds(10));
  model_.accel.set_power(false);
  model_.accel.set_power(true);
  rig_.run_for(milliseconds(30));
  EXPECT_GT(driver_.errors(), 0);
  rig_.run_for(milliseconds(1500));
  EXPECT_EQ(driver_.state(), PartState::kRunning) << driver_.message();
  EXPECT_NEAR(samples(milliseconds(50)).back().accel_m_s2[2], -9.80665f, 0.01f);
}

TEST_F(Bmi088Test, WithoutEdgesItFails) {
  run();
  samples(milliseconds(10));
  lose_edges_ = true;
  rig_.run_for(milliseconds(500));
  EXPECT_EQ(driver_.announcements(), 2) << "ok, and one failure";
  EXPECT_STREQ(driver_.message(), "BMI088: no data ready");
  lose_edges_ = false;
  time_to_run(milliseconds(1500));
  EXPECT_GT(samples(milliseconds(10)).size(), 15u);
}

TEST_F(Bmi088Test, AMissingEdgeCostsOneSample) {
  run();
  samples(milliseconds(10));
  lose_edges_ = true;
  rig_.run_for(microseconds(500));
  lose_edges_ = false;
  const auto all = samples(milliseconds(10));
  EXPECT_EQ(driver_.errors(), 0);
  EXPECT_GE(all.size(), 19u);
}

TEST_F(Bmi088Test, AnEdgeWhileReadingIsCountedAsOverrun) {
  run();
  rig_.ticking = false;
  driver_.data_ready(rig_.now());
  driver_.data_ready(rig_.now());
  EXPECT_EQ(driver_.overruns(), 1u);
}

TEST_F(Bmi088Test, AMainLoopThatSleepsFindsTheNewestSampleLast) {
  run();
  rig_.run_for(milliseconds(20));
  EXPECT_GT(driver_.dropped(), 30u);
  hal::ImuSample sample;
  int waiting = 0;
  while (driver_.poll(sample)) ++waiting;
  EXPECT_EQ(waiting, 4);
  // One period of 500 us, the delay of the filter and the two transfers.
  EXPECT_LT(rig_.now() - sample.stamp, milliseconds(2));
}

// ---- warm start

TEST_F(Bmi088Test, AWarmStartLeavesARunningPartAlone) {
  run();
  samples(milliseconds(10));
  Bmi088 after{accel_port_, gyro_port_, config_};  // the chip was reset, the part was not
  Rig::Spi& spi = spi_;
  const std::uint64_t before = model_.gyro.samples();
  rig_.ticks.clear();
  rig_.add(after);
  model_.gyro.line = [&](bool high, Time when) {
    if (high) after.data_ready(when);
  };
  const std::uint64_t transfers = spi.transfers;
  after.start(Start::kWarm, rig_.now());
  hal::ImuSample sample;
  const Time taken = rig_.run_until([&] { return after.poll(sample); }, milliseconds(100));
  EXPECT_LE(taken, milliseconds(3));
  EXPECT_LT(spi.transfers - transfers, 25u);
  EXPECT_GT(model_.gyro.samples(), before) << "it was reset";
  EXPECT_EQ(after.errors(), 0);
}

TEST_F(Bmi088Test, AWarmStartRewritesWhatIsWrong) {
  run();
  model_.accel.registers[0x41] = 1;
  model_.gyro.registers[0x10] = 0x83;
  driver_.start(Start::kWarm, rig_.now());
  EXPECT_LE(time_to_run(), milliseconds(3));
  EXPECT_EQ(model_.accel.registers[0x41], 3);
  EXPECT_EQ(model_.gyro.registers[0x10], 0x81);
}

TEST_F(Bmi088Test, AWarmStartOfAPartThatWasOffBecomesACompleteOne) {
  driver_.start(Start::kWarm, rig_.now());
  rig_.run_for(milliseconds(1500));
  EXPECT_EQ(driver_.state(), PartState::kRunning) << driver_.message();
  EXPECT_GT(samples(milliseconds(10)).size(), 15u);
}

}  // namespace
}  // namespace rosflight::boards::parts
