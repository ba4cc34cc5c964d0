// SPDX-License-Identifier: BSD-3-Clause
// Weak points of ROSflight 2.0.1 that no other test of this folder shows; the whole list is in
// docs/compatibility.md. Names begin with the number there.
#include <algorithm>

#include "firmware/core/test/firmware_rig.hpp"

namespace rosflight::core {
namespace {

class WeakPoints : public testing::Test {
 protected:
  void fly_quadrotor() {
    rig_.store_quadrotor();
    rig_.start();
    rig_.arm();
    rig_.rc.channels[FirmwareRig::kThrottle] = 0.8f;
    rig_.run_for(100);
    ASSERT_EQ(rig_.errors(), 0);
  }
  FirmwareRig rig_;
};

TEST_F(WeakPoints, N08FailsafeFliesOnAndEndsOnlyOnTheGround) {
  fly_quadrotor();
  rig_.rc.failsafe = true;
  for (int s = 0; s < 60; ++s) {  // never still for 30 s: as in the air
    rig_.gyro_rad_s[0] = 0.3f;
    rig_.run_for(50);
    rig_.gyro_rad_s[0] = 0.0f;
    rig_.run_for(950);
  }
  EXPECT_TRUE(rig_.armed());
  EXPECT_TRUE(rig_.firmware().state().failsafe());
  float sum = 0.0f;
  for (std::size_t k = 0; k < 4; ++k) sum += rig_.outputs()[k];
  EXPECT_NEAR(sum / 4.0f, 0.28f, 1e-3f);
}

TEST_F(WeakPoints, N08FailsafeAtRestOnTheGroundStopsTheMotorsUntilDisarmed) {
  fly_quadrotor();
  rig_.rc.failsafe = true;
  rig_.run_for(29'900);
  EXPECT_NEAR(rig_.outputs()[0], 0.28f, 1e-3f);
  rig_.run_for(400);
  EXPECT_NEAR(rig_.outputs()[0], 0.1f, 1e-3f) << "the probe holds them at idle";
  rig_.run_for(500);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(rig_.outputs()[k], 0.0f);
  EXPECT_TRUE(rig_.armed());
  EXPECT_TRUE(rig_.said("Motors stopped: on ground, 30 s without RC"));
  rig_.rc.failsafe = false;  // the radio is back, the stick still up
  rig_.run_for(2000);
  EXPECT_FALSE(rig_.firmware().state().failsafe());
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(rig_.outputs()[k], 0.0f);
}

TEST_F(WeakPoints, N19NoMessageArms) {  // kept
  rig_.store_quadrotor();
  rig_.start();
  rig_.run_for(200);
  for (int c = 0; c < 256; ++c) {
    if (c == 8 || c == 9) continue;  // reboots
    rig_.send(link::CommandRequest{static_cast<std::uint8_t>(c)});
    rig_.pass();
    ASSERT_FALSE(rig_.armed()) << c;
  }
}

// RC_ARM_CHN -1 leaves arming to the sticks; then a switch that is on becomes the yaw stick.
TEST_F(WeakPoints, N19NoParameterArms) {
  rig_.store_quadrotor();
  rig_.store([](Parameters& p) { static_cast<void>(p.set_int(Param::kRcArmChn, 4)); });
  rig_.start();
  rig_.run_for(200);
  rig_.rc.channels[5] = 1.0f;
  rig_.run_for(200);
  ASSERT_EQ(rig_.errors(), 0);
  rig_.set_param("RC_ARM_CHN", -1);
  rig_.set_param("RC_Z_CHN", 5);
  rig_.run_for(5000);
  ASSERT_EQ(rig_.firmware().parameters().get_int(Param::kRcZChn), 5);
  EXPECT_FALSE(rig_.armed());
  rig_.rc.channels[5] = 0.5f;
  rig_.run_for(100);
  rig_.rc.channels[5] = 1.0f;
  EXPECT_GE(rig_.ms_until([this] { return rig_.armed(); }, 2000), 1000) << "a pilot's stick does";
}

TEST_F(WeakPoints, N28StoredBatteryFiltersAreInForceAfterARestart) {
  rig_.store_quadrotor();
  rig_.store([](Parameters& p) { static_cast<void>(p.set_float(Param::kBattVoltLpf, 0.5f)); });
  rig_.start();
  for (const float volts : {16.0f, 12.0f}) {
    rig_.board.battery.put({rig_.now(), volts, 1.0f});
    rig_.pass();
  }
  EXPECT_FLOAT_EQ(rig_.got<link::BatteryStatus>().back().voltage_V, 14.0f);
}

TEST_F(WeakPoints, N31LowBatteryIsToldWhileArmedEveryTenSeconds) {
  rig_.store_quadrotor();
  rig_.store([](Parameters& p) {
    static_cast<void>(p.set_float(Param::kBattVoltMax, 16.8f));
    static_cast<void>(p.set_float(Param::kBattVoltLpf, 0.0f));
  });
  rig_.start();
  const auto warnings_in_25_s = [this](float volts) {
    rig_.inbox.clear();
    for (int k = 0; k < 250; ++k) {
      rig_.board.battery.put({rig_.now(), volts, 1.0f});
      rig_.run_for(100);
    }
    const auto lines = rig_.texts();
    return std::count_if(lines.begin(), lines.end(), [](const std::string& line) {
      return line.rfind("Low battery: ", 0) == 0;
    });
  };
  EXPECT_EQ(warnings_in_25_s(12.0f), 0) << "disarmed";
  rig_.arm();
  EXPECT_EQ(warnings_in_25_s(13.5f), 0) << "80 % of 16.8 V is 13.44 V";
  EXPECT_EQ(warnings_in_25_s(13.4f), 3);
  EXPECT_EQ(warnings_in_25_s(0.2f), 0) << "no battery connected";
}

TEST_F(WeakPoints, N32PressureIsNotCalibratedInTheAirAfterAReset) {
  fly_quadrotor();
  rig_.firmware().record_fault({});
  FirmwareRig after;
  std::array<std::uint8_t, CrashRecord::kBytes> record{};
  ASSERT_TRUE(rig_.board.backup.read(record.data(), record.size()));
  ASSERT_TRUE(after.board.backup.write(record.data(), record.size()));
  after.board.storage.set_bytes(rig_.board.storage.bytes());
  after.start();
  ASSERT_TRUE(after.armed());
  for (int k = 0; k < 4000; ++k) {
    after.board.baro.put({after.now(), 95'000.0f, 300.0f});
    after.board.diff_pressure.put({after.now(), 150.0f, 300.0f});
    after.pass();
  }
  EXPECT_EQ(after.firmware().parameters().get_float(Param::kBaroBias), 0.0f);
  EXPECT_EQ(after.firmware().parameters().get_float(Param::kDiffPressBias), 0.0f);
}

TEST_F(WeakPoints, N32AStoredAirspeedOffsetIsNotOverwrittenByAWind) {
  rig_.store_quadrotor();
  rig_.store([](Parameters& p) { static_cast<void>(p.set_float(Param::kDiffPressBias, 5.0f)); });
  rig_.start();
  for (int k = 0; k < 4000; ++k) {
    rig_.board.diff_pressure.put({rig_.now(), 25.0f, 300.0f});
    rig_.pass();
  }
  EXPECT_EQ(rig_.firmware().parameters().get_float(Param::kDiffPressBias), 5.0f);
  EXPECT_FALSE(rig_.said("Airspeed Cal Successful!"));
}

TEST_F(WeakPoints, N33GroundPressureIsRecordedAndNotSubtracted) {  // kept
  rig_.store_quadrotor();
  rig_.start();
  for (int k = 0; k < 4000; ++k) {
    rig_.board.baro.put({rig_.now(), 90'000.0f, 300.0f});
    rig_.pass();
  }
  EXPECT_NEAR(rig_.firmware().parameters().get_float(Param::kGroundLevel), 988.545f, 0.1f);
  EXPECT_NEAR(rig_.got<link::Baro>().back().altitude_m, 988.545f, 0.1f);
}

TEST_F(WeakPoints, N42MaximumThrustFollowsPropellerAndAir) {
  rig_.store_quadrotor();
  rig_.store([](Parameters& p) {
    static_cast<void>(p.set_int(Param::kUseMotorParam, 1));
    static_cast<void>(p.set_int(Param::kPrimaryMixer, 11));
  });
  rig_.start();
  rig_.run_for(100);
  rig_.rc.channels[FirmwareRig::kThrottle] = 1.0f;
  const auto thrust_N = [this] {
    rig_.run_for(50);
    return -rig_.firmware().controller().output()[2] / 0.7f;  // RC_MAX_THR
  };
  EXPECT_NEAR(thrust_N(), 292.279f, 0.01f);         // reference run, defaults
  const auto breathe = [this](float pressure_Pa) {  // the density is low-passed with 5 s
    for (int k = 0; k < 2000; ++k) {
      rig_.board.baro.put({rig_.now(), pressure_Pa, 300.0f});
      rig_.run_for(20);
    }
  };
  breathe(70'000.0f);
  const float in_thin_air = thrust_N();
  EXPECT_LT(in_thin_air, 280.0f);
  breathe(101'325.0f);
  EXPECT_NEAR(thrust_N(), 292.279f, 0.1f);
  rig_.set_param("PROP_CQ", 0.009f);
  EXPECT_LT(thrust_N(), 280.0f);
}

TEST_F(WeakPoints, N51TextsOfTheControlPassComeOnceASecond) {
  rig_.store_quadrotor();
  rig_.store([](Parameters& p) {
    static_cast<void>(p.set_int(Param::kPrimaryMixer, 11));
    static_cast<void>(p.set_int(Param::kPriMixerOut0, 2));
    static_cast<void>(p.set_float(Param::kPriMixer2_0, -5.0f));
  });
  rig_.start();
  rig_.arm();
  rig_.rc.channels[FirmwareRig::kThrottle] = 1.0f;
  rig_.run_for(3000);
  const auto lines = rig_.texts();
  EXPECT_EQ(std::count_if(lines.begin(), lines.end(),
                          [](const std::string& line) {
                            return line.rfind("Motor command above full: x 3.50", 0) == 0;
                          }),
            3);
}

TEST_F(WeakPoints, N51AMissingBatteryIsToldOnceASecond) {
  rig_.store_quadrotor();
  rig_.store([](Parameters& p) { static_cast<void>(p.set_int(Param::kUseMotorParam, 1)); });
  rig_.start();
  rig_.run_for(100);
  rig_.inbox.clear();
  rig_.run_for(3000);
  const auto n = rig_.count_text("Battery voltage out of range");
  EXPECT_GE(n, 2u);
  EXPECT_LE(n, 4u);
}

TEST_F(WeakPoints, N66TheWatchdogIsFedOncePerPass) {
  rig_.store_quadrotor();
  rig_.start();
  const auto before = rig_.board.system.passes();
  for (int k = 0; k < 100; ++k) rig_.pass();
  EXPECT_EQ(rig_.board.system.passes(), before + 100);
}

TEST_F(WeakPoints, N69WithoutImuEverythingElseIsStillSent) {
  rig_.store_quadrotor();
  rig_.start();
  rig_.run_for(200);
  rig_.imu_on = false;
  rig_.inbox.clear();
  rig_.send(link::ParamRequestList{});
  rig_.run_for(1000);
  EXPECT_EQ(rig_.got<link::ParamValue>().size(), kParamCount);
  EXPECT_EQ(rig_.got<link::Heartbeat>().size(), 1u);
  EXPECT_GE(rig_.got<link::Status>().size(), 10u);
  EXPECT_EQ(rig_.got<link::RcChannels>().size(), 50u);
}

/// Every look at it takes as long as it is told to.
class SlowClock final : public hal::Clock {
 public:
  hal::Time now() const override { return now_ += step; }
  hal::Time step{};

 private:
  mutable hal::Time now_{};
};

TEST_F(WeakPoints, N71LoopTimeSaturatesAndTheLongestPeriodIsToldWithTheVersion) {
  rig_.store_quadrotor();
  SlowClock clock;
  const hal::Board all = rig_.board.roles(rig_.serial);
  const hal::Board roles{clock,    all.system,  all.serial,        all.storage, all.backup,
                         all.leds, all.outputs, all.receiver,      all.battery, all.imu,
                         all.mag,  all.baro,    all.diff_pressure, all.range,   all.gnss};
  link::MavlinkCodec fcu{{1, 250}}, companion{{1, 50}};
  Firmware firmware(roles, fcu);
  firmware.start();
  const auto exchange = [&](const link::Message& message) {
    link::Frame frame;
    EXPECT_TRUE(companion.encode(message, frame));
    rig_.serial.put(frame.bytes.data(), frame.size);
    rig_.board.imu.put({clock.now(), {0.0f, 0.0f, -9.80665f}, {}, 298.15f});
    firmware.run();
    std::vector<link::Message> got;
    const auto bytes = rig_.serial.take_sent();
    for (std::size_t used = 0; used < bytes.size();) {
      const auto result = companion.decode(bytes.data() + used, bytes.size() - used);
      used += result.consumed;
      if (result.complete) got.push_back(companion.message());
    }
    return got;
  };
  clock.step = hal::milliseconds(50);
  exchange(link::Heartbeat{});
  exchange(link::Heartbeat{});
  int loop_time_us = 0;
  for (const auto& m : exchange(link::Heartbeat{})) {
    if (const auto* status = std::get_if<link::Status>(&m)) loop_time_us = status->loop_time_us;
  }
  EXPECT_EQ(loop_time_us, 32767);
  clock.step = hal::microseconds(10);
  bool told = false;
  exchange(link::CommandRequest{10});
  for (int k = 0; k < 30; ++k) {
    for (const auto& m : exchange(link::Heartbeat{})) {
      const auto* text = std::get_if<link::StatusText>(&m);
      if (text == nullptr) continue;
      const std::string line = text->text.data();
      told =
          told || (line.rfind("Longest period: ", 0) == 0 && line.substr(line.size() - 3) == " us");
    }
  }
  EXPECT_TRUE(told);
}

TEST_F(WeakPoints, N71LongestPeriodIsTheTimeFromOnePassToTheNextSinceItWasAsked) {
  rig_.store_quadrotor();
  rig_.start();
  rig_.run_for(500);
  rig_.set_time(rig_.now() + hal::microseconds(1500));
  rig_.run_for(100);
  rig_.command(link::Command::kSendVersion);
  rig_.run_for(50);
  EXPECT_TRUE(rig_.said("Longest period: 4000 us"));
  rig_.command(link::Command::kSendVersion);
  rig_.run_for(50);
  EXPECT_TRUE(rig_.said("Longest period: 2500 us"));
}

}  // namespace
}  // namespace rosflight::core
