// SPDX-License-Identifier: BSD-3-Clause
// What the whole firmware sends, and what it does with what it gets.
#include <algorithm>

#include "firmware/core/test/firmware_rig.hpp"

namespace rosflight::core {
namespace {

class FirmwareLink : public testing::Test {
 protected:
  void start() {
    rig_.store_quadrotor();
    rig_.start();
  }
  /// Each of these came, and in this order.
  void expect_order(const std::vector<link::Message>& expected) const {
    const auto place = [this](const link::Message& kind) {
      const auto at = std::find_if(rig_.inbox.begin(), rig_.inbox.end(), [&kind](const auto& r) {
        return r.message.index() == kind.index();
      });
      EXPECT_NE(at, rig_.inbox.end()) << "message " << kind.index();
      return at - rig_.inbox.begin();
    };
    for (std::size_t k = 1; k < expected.size(); ++k) {
      EXPECT_LT(place(expected[k - 1]), place(expected[k])) << k;
    }
  }

  FirmwareRig rig_;
};

// ---- streams

TEST_F(FirmwareLink, OnePassSendsInTheOrderOfTheReference) {
  start();
  rig_.run_for(100);
  rig_.send(link::ParamRequestList{});
  // A pass that begins a second, with a sample of everything and outputs (every 8th).
  do {
    rig_.inbox.clear();
    rig_.board.diff_pressure.put({rig_.now(), 10.0f, 300.0f});
    rig_.board.baro.put({rig_.now(), 101325.0f, 300.0f});
    rig_.board.mag.put({rig_.now(), {1e-5f, 0.0f, 4e-5f}, 300.0f});
    rig_.board.range.put({rig_.now(), 1.5f, 0.25f, 8.0f, hal::RangeKind::kLidar});
    rig_.board.battery.put({rig_.now(), 16.0f, 3.0f});
    rig_.board.gnss.put({});
    rig_.set_param("NO_SUCH_NAME", 1);  // gives a text
    rig_.set_time(hal::milliseconds(1000 * (rig_.now().count() / 1'000'000 + 1)) -
                  hal::microseconds(FirmwareRig::kPass_us));
    rig_.pass();
  } while (rig_.got<link::OutputRaw>().empty());
  // ROSflight 2.0.1 sends all 13 in one pass. Here a pass with an IMU sample takes one of the other
  // sensors, the pass after it the rest and what else was due.
  expect_order({link::Imu{}, link::Attitude{}, link::Gnss{}, link::Heartbeat{}, link::Status{},
                link::DiffPressure{}, link::Baro{}, link::Mag{}, link::Range{},
                link::BatteryStatus{}});
  EXPECT_FALSE(rig_.got<link::ParamValue>().empty());
  EXPECT_FALSE(rig_.got<link::StatusText>().empty());
}

TEST_F(FirmwareLink, EverySensorIsSentOncePerSampleWithItsValues) {
  start();
  rig_.run_for(100);
  rig_.inbox.clear();
  rig_.board.diff_pressure.put({rig_.now(), 61.25f, 301.0f});
  rig_.board.baro.put({rig_.now(), 90000.0f, 302.0f});
  rig_.board.mag.put({rig_.now(), {1e-5f, 2e-5f, 4e-5f}, 303.0f});
  rig_.board.range.put({rig_.now(), 1.5f, 0.3f, 40.0f, hal::RangeKind::kLidar});
  rig_.board.battery.put({rig_.now(), 16.0f, 3.0f});
  hal::GnssSample fix;
  fix.stamp = hal::microseconds(123'456);
  fix.unix_s = 1'700'000'000;
  fix.unix_ns = 5;
  fix.fix = hal::GnssFix::k3d;
  fix.satellites = 17;
  fix.latitude_deg = 40.267;
  fix.longitude_deg = -111.635;
  fix.height_msl_m = 1387.0f;
  fix.velocity_ned_m_s = {1.0f, 2.0f, 3.0f};
  rig_.board.gnss.put(fix);
  rig_.run_for(50);

  ASSERT_EQ(rig_.got<link::DiffPressure>().size(), 1u);
  EXPECT_FLOAT_EQ(rig_.got<link::DiffPressure>()[0].airspeed_m_s, 10.0f);  // sqrt(61.25/0.6125)
  ASSERT_EQ(rig_.got<link::Baro>().size(), 1u);
  EXPECT_NEAR(rig_.got<link::Baro>()[0].altitude_m, 988.545f, 0.01f);  // reference check value
  EXPECT_FLOAT_EQ(rig_.got<link::Baro>()[0].pressure_Pa, 90000.0f);
  ASSERT_EQ(rig_.got<link::Mag>().size(), 1u);
  EXPECT_FLOAT_EQ(rig_.got<link::Mag>()[0].field_T[2], 4e-5f);
  // Weak point 70: limits and kind were constants.
  ASSERT_EQ(rig_.got<link::Range>().size(), 1u);
  EXPECT_EQ(rig_.got<link::Range>()[0].kind, 1);
  EXPECT_FLOAT_EQ(rig_.got<link::Range>()[0].max_m, 40.0f);
  EXPECT_FLOAT_EQ(rig_.got<link::Range>()[0].min_m, 0.3f);
  ASSERT_EQ(rig_.got<link::BatteryStatus>().size(), 1u);
  // Weak point 29: the first sample counts, not BATT_VOLT_MAX.
  EXPECT_FLOAT_EQ(rig_.got<link::BatteryStatus>()[0].voltage_V, 16.0f);
  ASSERT_EQ(rig_.got<link::Gnss>().size(), 1u);
  const auto gnss = rig_.got<link::Gnss>()[0];
  EXPECT_EQ(gnss.unix_s, 1'700'000'000);
  EXPECT_EQ(gnss.fix, 3);
  EXPECT_EQ(gnss.satellites, 17);
  EXPECT_EQ(gnss.latitude_deg, 40.267);
  EXPECT_EQ(gnss.time_boot_us, 123'456u);
}

TEST_F(FirmwareLink, ImuAndAttitudeGoOutWithEverySampleOutputsWithEveryEighth) {
  start();
  rig_.pass();
  EXPECT_EQ(rig_.got<link::OutputRaw>().size(), 1u) << "the very first one";
  for (int k = 0; k < 80; ++k) rig_.pass();
  EXPECT_EQ(rig_.got<link::Imu>().size(), 81u);
  EXPECT_EQ(rig_.got<link::Attitude>().size(), 81u);
  EXPECT_EQ(rig_.got<link::OutputRaw>().size(), 11u);
  EXPECT_EQ(rig_.got<link::Imu>()[0].time_boot_us, 2500u);
  EXPECT_EQ(rig_.got<link::Attitude>()[1].time_boot_ms, 5u);
  EXPECT_EQ(rig_.got<link::OutputRaw>()[1].time_boot_ms, 22u) << "milliseconds";
}

TEST_F(FirmwareLink, HeartbeatIsSentOnceASecondAndStatusTenTimes) {
  start();
  rig_.run_for(200);
  rig_.inbox.clear();
  rig_.run_for(10'000);
  EXPECT_EQ(rig_.got<link::Heartbeat>().size(), 10u);
  EXPECT_EQ(rig_.got<link::Status>().size(), 100u);
  EXPECT_EQ(rig_.got<link::Heartbeat>()[0].type, link::VehicleType::kMultirotor);
  rig_.set_param("FIXED_WING", 1);
  rig_.run_for(50);
  rig_.inbox.clear();
  rig_.run_for(1000);
  EXPECT_EQ(rig_.got<link::Heartbeat>().at(0).type, link::VehicleType::kFixedWing);
}

TEST_F(FirmwareLink, StatusIsSentAtOnceWhenSomethingChanges) {
  start();
  rig_.run_for(210);
  rig_.inbox.clear();
  rig_.rc.channels[4] = 1.0f;  // both override switches
  rig_.run_for(30);
  ASSERT_EQ(rig_.got<link::Status>().size(), 1u);
  EXPECT_EQ(rig_.got<link::Status>()[0].rc_override, 0x3C3);
}

TEST_F(FirmwareLink, StatusTellsTheMode) {
  start();
  rig_.run_for(100);
  const auto mode = [this] {
    rig_.inbox.clear();
    rig_.run_for(150);
    return int{rig_.got<link::Status>().back().control_mode};
  };
  EXPECT_EQ(mode(), 2) << "angle sticks";
  rig_.set_param("RC_ATT_MODE", 0);
  EXPECT_EQ(mode(), 1) << "rate sticks";
  rig_.offboard = link::OffboardControl{};  // pass-through
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.5f;
  EXPECT_EQ(mode(), 0);
  rig_.offboard.reset();
  rig_.set_param("FIXED_WING", 1);
  EXPECT_EQ(mode(), 0);
}

TEST_F(FirmwareLink, SensorErrorsOfTheBoardAreInTheStatus) {
  start();
  rig_.board.system.set_sensor_errors(3);
  rig_.run_for(200);
  EXPECT_EQ(rig_.got<link::Status>().back().sensor_errors, 3);
}

// Weak point 70: eight channels of zeros and no count.
TEST_F(FirmwareLink, RcChannelsCarriesAllChannelsAndTheirCount) {
  start();
  rig_.rc.channel_count = 16;
  rig_.rc.channels[0] = 0.1239f;
  rig_.rc.channels[7] = 1.2f;
  rig_.rc.channels[15] = 1.0f;
  rig_.run_for(100);
  rig_.inbox.clear();
  rig_.run_for(200);
  const auto rc = rig_.got<link::RcChannels>();
  ASSERT_EQ(rc.size(), 10u) << "one per frame";
  EXPECT_EQ(rc[0].pulse_us[0], 1123) << "truncated";
  EXPECT_EQ(rc[0].pulse_us[7], 2200);
  EXPECT_EQ(rc[0].pulse_us[15], 2000);
  EXPECT_EQ(rc[0].pulse_us[16], 0);
  EXPECT_EQ(rc[0].count, 16);
  EXPECT_EQ(rc[0].rssi, 255) << "this receiver does not tell it";
  rig_.rc.rssi = 203;
  rig_.rc.failsafe = true;
  rig_.inbox.clear();
  rig_.run_for(100);
  ASSERT_EQ(rig_.got<link::RcChannels>().size(), 5u) << "lost frames too";
  EXPECT_EQ(rig_.got<link::RcChannels>().back().rssi, 203);
}

// ---- texts (weak points 56, 57, 58)

TEST_F(FirmwareLink, TextsWaitForAHeartbeatAndCarryTheSystemId) {
  rig_.companion_on = false;
  rig_.start();
  rig_.run_for(1000);
  EXPECT_TRUE(rig_.texts().empty());
  rig_.companion_on = true;
  rig_.run_for(1000);
  EXPECT_TRUE(rig_.said("Unable to load parameters, using defaults"));
  EXPECT_TRUE(rig_.said("No mixer: set PRIMARY_MIXER"));
  for (const auto& r : rig_.inbox) {
    EXPECT_EQ(r.system_id, 1);
    const bool value = std::holds_alternative<link::ParamValue>(r.message);
    EXPECT_EQ(r.component_id, value ? 0 : 250);
  }
}

TEST_F(FirmwareLink, SystemIdFollowsTheParameterAtOnce) {
  start();
  rig_.run_for(100);
  rig_.inbox.clear();
  rig_.set_param("SYS_ID", 42);
  rig_.run_for(100);
  std::size_t count = 0;
  for (const auto& r : rig_.inbox) {
    if (r.at > rig_.inbox.front().at) {
      EXPECT_EQ(r.system_id, 42);
      ++count;
    }
  }
  EXPECT_GT(count, 50u);
  rig_.inbox.clear();
  rig_.send(link::ParamRequestRead{1, 0, {}});
  rig_.run_for(10);
  EXPECT_TRUE(rig_.got<link::ParamValue>().empty()) << "no longer its address";
}

TEST_F(FirmwareLink, SeveritiesAreThoseOfTheReference) {
  rig_.start();
  rig_.run_for(1000);
  const auto severity = [this](const std::string& text) {
    for (const auto& t : rig_.got<link::StatusText>()) {
      if (t.text.data() == text) return static_cast<int>(t.severity);
    }
    return -1;
  };
  EXPECT_EQ(severity("arm switch not mapped"), 6);
  EXPECT_EQ(severity("Unable to load parameters, using defaults"), 4);
  EXPECT_EQ(severity("No mixer: set PRIMARY_MIXER"), 3);
}

TEST_F(FirmwareLink, WhenTheCompanionFallsSilentTextsWaitForItsReturn) {
  start();
  rig_.run_for(2000);
  rig_.companion_on = false;
  rig_.run_for(4100);
  EXPECT_FALSE(rig_.firmware().telemetry().connected());
  rig_.inbox.clear();
  rig_.imu_on = false;
  rig_.run_for(200);
  EXPECT_TRUE(rig_.texts().empty());
  rig_.companion_on = true;
  rig_.run_for(100);
  EXPECT_TRUE(rig_.said("IMU not responding"));
}

TEST_F(FirmwareLink, ACompanionIsThereForThreeSecondsAfterItsLastHeartbeat) {
  start();
  rig_.run_for(10);
  rig_.companion_on = false;
  rig_.run_for(2900);
  EXPECT_TRUE(rig_.firmware().telemetry().connected());
  rig_.run_for(300);
  EXPECT_FALSE(rig_.firmware().telemetry().connected());
}

// ---- TIMESYNC

TEST_F(FirmwareLink, TimeSyncRequestsAreAnsweredWithTheBootClockAnswersAreNot) {
  start();
  rig_.run_for(1000);
  rig_.inbox.clear();
  rig_.send(link::TimeSync{0, 987'654'321});
  rig_.send(link::TimeSync{5, 1});
  rig_.pass();
  const auto sync = rig_.got<link::TimeSync>();
  ASSERT_EQ(sync.size(), 1u);
  EXPECT_EQ(sync[0].ts1_ns, 987'654'321);
  EXPECT_EQ(sync[0].tc1_ns, rig_.now().count() * 1000);
}

// ---- auxiliary commands and external attitude

TEST_F(FirmwareLink, AuxiliaryCommandsDriveFreeChannelsUntilTheNext) {
  start();
  link::AuxCommand aux;
  aux.type[6] = 1;
  aux.value[6] = 0.5f;
  aux.type[12] = 2;
  aux.value[12] = 0.7f;
  rig_.send(aux);
  rig_.run_for(1000);
  EXPECT_FLOAT_EQ(rig_.outputs()[6], 0.75f);
  EXPECT_EQ(rig_.outputs()[12], 0.0f) << "a motor, and disarmed";
  rig_.arm();
  EXPECT_EQ(rig_.outputs()[12], 0.0f) << "the command came before";
  rig_.send(aux);
  rig_.run_for(20);
  EXPECT_FLOAT_EQ(rig_.outputs()[12], 0.7f);
  aux.type[6] = 3;
  aux.value[12] = 0.2f;
  rig_.send(aux);
  rig_.run_for(20);
  EXPECT_FLOAT_EQ(rig_.outputs()[12], 0.7f) << "an unknown type refuses the whole message";
}

TEST_F(FirmwareLink, ExternalAttitudeTurnsTheEstimate) {
  start();
  rig_.run_for(4000);
  for (int k = 0; k < 1000; ++k) {
    rig_.send(link::ExternalAttitude{{0.9950042f, 0.0f, 0.0f, 0.0998334f}});  // yaw 0.2 rad
    rig_.pass();
  }
  const auto q = rig_.got<link::Attitude>().back().q_WB;
  EXPECT_NEAR(2.0f * std::atan2(q[3], q[0]), 0.2f, 0.01f);
}

}  // namespace
}  // namespace rosflight::core
