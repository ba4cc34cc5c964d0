// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/ublox.hpp"

#include "firmware/boards/parts/models/ublox_model.hpp"
#include "firmware/boards/parts/test/sensor_rig.hpp"

namespace rosflight::boards::parts {
namespace {

using hal::milliseconds;

/// A UART whose bytes take no time to send; those received come with the next tick.
class Wire final : public UartPort {
 public:
  explicit Wire(models::UbloxModel& model) : model_{model} {}
  bool send(const std::uint8_t* data, std::size_t size) override {
    if (deaf) return false;
    for (std::size_t k = 0; k < size; ++k) model_.receive(data[k], format_.baud);
    return true;
  }
  bool set_format(const UartFormat& format) override {
    format_ = format;
    return true;
  }
  bool idle() const override { return !never_idle; }
  void pass_on(ByteReceiver& receiver) {
    std::uint8_t byte = 0;
    std::uint32_t baud = 0;
    Time end{};
    while (model_.take(byte, baud, end)) {
      if (baud == format_.baud) {
        receiver.receive(&byte, 1, end);
      } else {
        receiver.line_error(end);
      }
    }
  }
  bool deaf{false};
  bool never_idle{false};

 private:
  models::UbloxModel& model_;
  UartFormat format_{};
};

class UbloxTest : public SensorTest<hal::GnssSample> {
 protected:
  UbloxTest() {
    rig_.add(model_);
    rig_.ticks.emplace_back([this](Time) { wire_.pass_on(driver_); });
    rig_.add(driver_);
    model_.pulse = [this](bool high, Time when) {
      if (high && pulses_) driver_.pulse(when);
    };
  }
  Driver& driver() override { return driver_; }
  hal::Source<hal::GnssSample>& source() override { return driver_; }

  models::GnssTruth truth_{};
  models::UbloxModel model_{[this](Time t) {
    models::GnssTruth truth = truth_;
    truth.velocity_ned_m_s[0] = 1e-6 * static_cast<double>(t.count());
    return truth;
  }};
  Wire wire_{model_};
  Ublox driver_{wire_, {115'200, 100}};
  bool pulses_{true};
};

TEST_F(UbloxTest, FindsTheReceiverAtAnyRate) {
  for (const std::uint32_t baud : {9'600u, 38'400u, 57'600u, 115'200u, 230'400u, 460'800u}) {
    model_.power_up_baud = baud;
    model_.set_power(true);
    start();
    EXPECT_LE(time_to_run(milliseconds(3000)), milliseconds(2000)) << baud << driver_.message();
    EXPECT_EQ(model_.baud(), 115'200u);
  }
}

TEST_F(UbloxTest, ConfiguresAirborneModelAndPulse) {
  start();
  time_to_run(milliseconds(3000));
  EXPECT_EQ(model_.dynamic_model(), 8);
  EXPECT_EQ(model_.pulse_length_us(), 1000u);
  EXPECT_EQ(model_.pulse_length_unlocked_us(), 1000u);
  EXPECT_FALSE(model_.speaks_nmea());
  EXPECT_EQ(model_.complaints(), std::vector<std::string>{});
}

TEST_F(UbloxTest, TheModelsPulseRisesEachSecondAndFallsAfterItsLength) {
  start();
  time_to_run(milliseconds(3000));
  std::vector<Time> rising, falling;
  model_.pulse = [&](bool high, Time when) { (high ? rising : falling).push_back(when); };
  rig_.run_for(milliseconds(3000));
  ASSERT_EQ(rising.size(), 3u);
  ASSERT_EQ(falling.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(rising[k].count() % 1'000'000, 0);
    EXPECT_EQ(falling[k] - rising[k], milliseconds(1));
  }
}

TEST_F(UbloxTest, DeliversTenSolutionsASecond) {
  truth_.latitude_deg = -33.8567844;
  truth_.longitude_deg = 151.2152967;
  truth_.height_msl_m = 12.345;
  truth_.velocity_ned_m_s[1] = -7.25;
  start();
  time_to_run(milliseconds(3000));
  const auto all = samples(milliseconds(2000));
  ASSERT_NEAR(static_cast<double>(all.size()), 20.0, 1.0);
  const hal::GnssSample& sample = all.back();
  EXPECT_NEAR(sample.latitude_deg, -33.8567844, 1e-9);
  EXPECT_NEAR(sample.longitude_deg, 151.2152967, 1e-9);
  EXPECT_NEAR(sample.height_msl_m, 12.345f, 1e-4f);
  EXPECT_NEAR(sample.velocity_ned_m_s[1], -7.25f, 1e-4f);
  EXPECT_EQ(sample.fix, hal::GnssFix::k3d);
  EXPECT_EQ(sample.satellites, 14);
  EXPECT_NEAR(sample.horizontal_accuracy_m, 1.5f, 1e-6f);
  EXPECT_NEAR(sample.vertical_accuracy_m, 2.5f, 1e-6f);
  EXPECT_NEAR(sample.speed_accuracy_m_s, 0.12f, 1e-6f);
  EXPECT_STREQ(driver_.message(), "u-blox: ok");
}

TEST_F(UbloxTest, StampAndUnixTimeAreThoseOfValidity) {
  start();
  time_to_run(milliseconds(3000));
  samples(milliseconds(1200));
  for (const auto& sample : samples(milliseconds(2500))) {
    // Solutions are valid at multiples of 100 ms, and their velocity shows which.
    EXPECT_EQ(sample.stamp.count() % 100'000, 0);
    EXPECT_NEAR(sample.velocity_ned_m_s[0], 1e-6 * static_cast<double>(sample.stamp.count()), 1e-3);
    EXPECT_EQ(sample.unix_s * 1'000'000 + sample.unix_ns / 1000,
              1'700'000'000'000'000 + sample.stamp.count());
  }
}

TEST_F(UbloxTest, WithoutPulseOrTimeTheStampIsTheArrivalLess22ms) {
  pulses_ = false;
  start();
  time_to_run(milliseconds(3000));
  for (const auto& sample : samples(milliseconds(1000))) {
    const double late = 1e-3 * static_cast<double>(sample.stamp.count() % 100'000);
    EXPECT_NEAR(late, 60.0 + 8.7 - 22.0, 1.2);  // latency, 100 bytes on the wire
  }
  pulses_ = true;
  model_.knows_time = false;
  samples(milliseconds(1500));
  for (const auto& sample : samples(milliseconds(1000)))
    EXPECT_NE(sample.stamp.count() % 100'000, 0);
}

TEST_F(UbloxTest, AFixThatIsNotOkIsNone) {
  truth_.fix = 0;
  start();
  time_to_run(milliseconds(3000));
  EXPECT_EQ(last(milliseconds(500)).fix, hal::GnssFix::kNone);
}

TEST_F(UbloxTest, AReceiverThatSpeaksNmeaOnlyIsNamed) {
  model_.nmea_only = true;
  model_.power_up_baud = 57'600;
  model_.set_power(true);
  start();
  rig_.run_for(milliseconds(12'000));
  EXPECT_STREQ(driver_.message(), "u-blox: sends NMEA at 57600 baud, ignores UBX");
  EXPECT_EQ(driver_.announcements(), 1);
  model_.nmea_only = false;
  rig_.run_for(milliseconds(20'000));
  EXPECT_STREQ(driver_.message(), "u-blox: ok");
}

TEST_F(UbloxTest, AMuteReceiverIsSaid) {
  model_.set_power(false);
  start();
  rig_.run_for(milliseconds(15'000));
  EXPECT_STREQ(driver_.message(), "u-blox: no answer");
}

TEST_F(UbloxTest, ABusyUartDoesNotHoldTheSearch) {
  wire_.never_idle = true;
  start();
  rig_.run_for(milliseconds(4000));
  EXPECT_EQ(driver_.state(), PartState::kRunning);
}

TEST_F(UbloxTest, LostAnswersAreAskedForAgain) {
  start();
  rig_.run_until([this] { return model_.baud() == 115'200; }, milliseconds(2000));
  rig_.run_for(milliseconds(25));
  model_.lose_answers = 2;
  time_to_run(milliseconds(3000));
  EXPECT_EQ(driver_.state(), PartState::kRunning) << driver_.message();
  EXPECT_EQ(driver_.errors(), 0);
}

TEST_F(UbloxTest, ARefusalOfTheAirborneModelIsSaid) {
  model_.refuse_id = 0x24;
  start();
  rig_.run_for(milliseconds(2000));
  EXPECT_STREQ(driver_.message(), "u-blox: refuses message 0x06 0x24");
}

TEST_F(UbloxTest, SilenceInTheMiddleOfTheConfigurationIsSaid) {
  start();
  rig_.run_until([this] { return model_.dynamic_model() == 8; }, milliseconds(3000));
  wire_.deaf = true;
  rig_.run_for(milliseconds(1100));
  EXPECT_STREQ(driver_.message(), "u-blox: no answer to message 0x06 0x31");
}

TEST_F(UbloxTest, APowerLossInFlightIsRepaired) {
  start();
  time_to_run(milliseconds(3000));
  samples(milliseconds(500));
  model_.set_power(false);
  rig_.run_for(milliseconds(100));
  model_.set_power(true);  // at 38 400 baud again
  rig_.run_for(milliseconds(6000));
  EXPECT_FALSE(samples(milliseconds(1000)).empty()) << driver_.message();
  EXPECT_EQ(driver_.announcements(), 3);
}

TEST_F(UbloxTest, AReceiverThatFallsBackToNmeaIsSaid) {
  model_.power_up_baud = 115'200;
  model_.set_power(true);
  start();
  time_to_run(milliseconds(3000));
  samples(milliseconds(500));
  model_.nmea_only = true;
  model_.set_power(true);
  rig_.run_for(milliseconds(2500));
  EXPECT_STREQ(driver_.message(), "u-blox: sends NMEA at 115200 baud");
}

TEST_F(UbloxTest, AWarmStartSkipsTheSearch) {
  start();
  time_to_run(milliseconds(3000));
  samples(milliseconds(500));
  start(Start::kWarm);
  EXPECT_LE(time_to_run(), milliseconds(60));
  EXPECT_FALSE(samples(milliseconds(500)).empty());
}

TEST(Ubx, CountsCivilTime) {
  EXPECT_EQ(unix_seconds(1970, 1, 1, 0, 0, 0), 0);
  EXPECT_EQ(unix_seconds(2000, 2, 29, 12, 34, 56), 951'827'696);
  EXPECT_EQ(unix_seconds(2024, 12, 31, 23, 59, 59), 1'735'689'599);
  EXPECT_EQ(unix_seconds(2100, 3, 1, 0, 0, 0), 4'107'542'400);
}

TEST(Ubx, ANegativeFractionBelongsToTheSecondBefore) {
  std::array<std::uint8_t, NavPvt::kBytes> p{};
  p[4] = 0xB2;
  p[5] = 0x07;  // 1970
  p[6] = 1;
  p[7] = 1;
  p[10] = 30;
  p[16] = p[17] = p[18] = p[19] = 0xFF;  // -1 ns
  const NavPvt pvt = NavPvt::from(p.data());
  EXPECT_EQ(pvt.sample.unix_s, 29);
  EXPECT_EQ(pvt.sample.unix_ns, 999'999'999);
}

TEST_F(UbloxTest, ASolutionOffTheEarthIsDropped) {
  start();
  time_to_run(milliseconds(3000));
  samples(milliseconds(300));
  truth_.latitude_deg = 90.1;
  samples(milliseconds(200));
  EXPECT_TRUE(samples(milliseconds(300)).empty());
  EXPECT_GT(driver_.errors(), 0);
}

TEST(Ubx, WrapsAMessageOfTheInterfaceDescription) {
  // CFG-RATE poll: B5 62 06 08 00 00 0E 30.
  std::array<std::uint8_t, 8> frame{};
  EXPECT_EQ(UbxFormat::wrap(0x06, 0x08, nullptr, 0, frame.data()), 8u);
  EXPECT_EQ(frame, (std::array<std::uint8_t, 8>{0xB5, 0x62, 0x06, 0x08, 0, 0, 0x0E, 0x30}));
}

TEST(Ubx, ADamagedLengthDoesNotSwallowTheNextFrame) {
  std::array<std::uint8_t, 8> good{};
  UbxFormat::wrap(0x05, 0x01, nullptr, 0, good.data());
  Framer<UbxFormat> framer;
  int found = 0;
  const auto feed = [&](std::initializer_list<std::uint8_t> bytes) {
    for (const std::uint8_t byte : bytes)
      framer.take(byte, [&](const std::uint8_t*, std::size_t) { ++found; });
  };
  feed({0xB5, 0x62, 0x01, 0x07, 0xFF, 0xFF});
  for (const std::uint8_t byte : good) feed({byte});
  EXPECT_EQ(found, 1);
  // A length that is possible takes the frames behind it in, and gives them out again.
  feed({0xB5, 0x62, 0x01, 0x07, 20, 0});
  for (int k = 0; k < 3; ++k) {
    for (const std::uint8_t byte : good) feed({byte});
  }
  EXPECT_EQ(found, 4);
  EXPECT_EQ(framer.damaged(), 1u);
}

TEST(Nmea, IsRecognizedByItsChecksum) {
  Framer<NmeaFormat> framer;
  int found = 0;
  const auto feed = [&](const std::string& text) {
    for (const char c : text) {
      framer.take(static_cast<std::uint8_t>(c), [&](const std::uint8_t*, std::size_t) { ++found; });
    }
  };
  feed("$GPGLL,5057.970,N,00146.110,E,142451,A*27\r\n");
  EXPECT_EQ(found, 1);
  feed("$GPGLL,5057.970,N,00146.110,E,142451,A*28\r\n");
  feed(std::string(300, '$') + "$GP\x01");
  feed("$" + std::string(200, 'A'));
  EXPECT_EQ(found, 1);
  feed("$GPGLL,5057.970,N,00146.110,E,142451,A*27\r\n");
  EXPECT_EQ(found, 2);
}

}  // namespace
}  // namespace rosflight::boards::parts
