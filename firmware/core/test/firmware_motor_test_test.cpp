// SPDX-License-Identifier: BSD-3-Clause
// Motor test, the list before arming over the link, counters, and motors that stay stopped.
#include <numeric>

#include "firmware/core/test/firmware_rig.hpp"

namespace rosflight::core {
namespace {

class FirmwareMotorTest : public testing::Test {
 protected:
  void SetUp() override {
    rig_.store_quadrotor();
    rig_.store([](Parameters& p) { static_cast<void>(p.set_int(Param::kRcArmChn, 5)); });
    rig_.start();
    rig_.run_for(700);
    ASSERT_EQ(rig_.errors(), 0);
  }
  void ask(std::uint8_t motor, float value, std::uint8_t target = 1) {
    rig_.send(link::MotorTest{target, motor, value});
    rig_.run_for(5);
  }
  State state() const { return rig_.firmware().state().state(); }
  /// Every motor but `motor` stands; -1: all do.
  void expect_only(int motor, float value) const {
    for (int k = 0; k < 14; ++k) {
      EXPECT_EQ(rig_.outputs()[static_cast<std::size_t>(k)], k == motor ? value : 0.0f) << k;
    }
  }
  FirmwareRig rig_;
};

TEST_F(FirmwareMotorTest, TurnsOneMotorAndEndsThreeTenthsOfASecondAfterTheLastMessage) {
  ask(2, 0.25f);
  EXPECT_EQ(state(), State::kMotorTest);
  expect_only(2, 0.25f);
  EXPECT_FALSE(rig_.armed());
  for (int k = 0; k < 10; ++k) {
    rig_.run_for(250);
    expect_only(2, 0.25f);
    ask(2, 0.25f);
  }
  rig_.run_for(290);
  expect_only(2, 0.25f);
  rig_.run_for(10);
  EXPECT_EQ(state(), State::kPreflight);
  expect_only(-1, 0.0f);
}

TEST_F(FirmwareMotorTest, RefusesWhatItShould) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<std::pair<std::uint8_t, float>> bad{{0, 0.3001f}, {0, -0.1f}, {0, kNan},
                                                        {0, 1e9f},    {4, 0.2f},  {9, 0.2f},
                                                        {13, 0.2f},   {255, 0.2f}};
  for (const auto& [motor, value] : bad) {
    ask(motor, value);
    EXPECT_EQ(state(), State::kPreflight) << int(motor) << " " << value;
    expect_only(-1, 0.0f);
  }
  ask(0, 0.2f, 2);
  EXPECT_EQ(state(), State::kPreflight) << "somebody else's";
  ask(0, 0.2f, 0);
  EXPECT_EQ(state(), State::kMotorTest) << "everybody's";
}

TEST_F(FirmwareMotorTest, ASecondMotorEndsIt) {
  ask(0, 0.2f);
  ask(1, 0.2f);
  EXPECT_EQ(state(), State::kPreflight);
  expect_only(-1, 0.0f);
  ask(1, 0.2f);
  expect_only(1, 0.2f);
  ask(1, 0.9f);
  EXPECT_EQ(state(), State::kPreflight) << "a bad value ends it too";
  expect_only(-1, 0.0f);
}

TEST_F(FirmwareMotorTest, AnArmRequestEndsItAndDoesNotArm) {
  ask(0, 0.2f);
  rig_.rc.channels[5] = 1.0f;
  rig_.ms_until([this] { return state() != State::kMotorTest; }, 100);
  EXPECT_EQ(state(), State::kPreflight);
  expect_only(-1, 0.0f);
  rig_.run_for(100);
  EXPECT_FALSE(rig_.armed());
}

TEST_F(FirmwareMotorTest, AnErrorEndsItInThatPass) {
  ask(0, 0.2f);
  rig_.rc.failsafe = true;
  while (state() == State::kMotorTest) rig_.pass();
  EXPECT_EQ(state(), State::kError);
  expect_only(-1, 0.0f);
  rig_.rc.failsafe = false;
  rig_.run_for(200);
  ask(0, 0.2f);
  ASSERT_EQ(state(), State::kMotorTest);
  rig_.imu_on = false;
  for (int k = 0; k < 30; ++k) {
    ask(0, 0.2f);
    rig_.run_for(10);
  }
  EXPECT_EQ(state(), State::kError);
  expect_only(-1, 0.0f);
}

TEST_F(FirmwareMotorTest, IsRefusedWhileArmedAndWithErrors) {
  rig_.rc.channels[5] = 1.0f;
  rig_.run_for(1000);
  ASSERT_TRUE(rig_.armed());
  ask(0, 0.2f);
  EXPECT_EQ(state(), State::kArmed);
  EXPECT_NEAR(rig_.outputs()[0], 0.1f, 1e-6f) << "idle, as before";
  rig_.run_for(100);
  EXPECT_TRUE(rig_.said("Motor test refused: not in preflight state"));
}

// ---- the list

TEST_F(FirmwareMotorTest, TheListBeforeArmingIsToldOnRequest) {
  rig_.inbox.clear();
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.5f;
  rig_.run_for(50);
  rig_.send(link::ReportRequest{1, static_cast<std::uint8_t>(link::ReportKind::kChecks)});
  rig_.run_for(200);
  const auto lines = rig_.got<link::CheckResult>();
  ASSERT_EQ(lines.size(), kCheckCount);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    EXPECT_EQ(lines[k].index, k);
    EXPECT_EQ(lines[k].count, kCheckCount);
    EXPECT_EQ(std::string(lines[k].name.data(), strnlen(lines[k].name.data(), 16)),
              kChecks[k].name);
    const bool throttle = kChecks[k].check == Check::kThrottle;
    EXPECT_EQ(lines[k].result, throttle ? 2 : 0) << kChecks[k].name;
    EXPECT_STREQ(lines[k].reason.data(), throttle ? "throttle not low" : "");
  }
  rig_.send(link::ReportRequest{2, 0});
  rig_.send(link::ReportRequest{1, 77});
  rig_.run_for(200);
  EXPECT_EQ(rig_.got<link::CheckResult>().size(), kCheckCount)
      << "not for others, not for nonsense";
}

TEST_F(FirmwareMotorTest, CountersAreToldOnRequest) {
  rig_.inbox.clear();
  rig_.send(link::ReportRequest{1, static_cast<std::uint8_t>(link::ReportKind::kCounters)});
  rig_.run_for(10);
  const auto told = rig_.got<link::Counters>();
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NEAR(told[0].passes, 280.0, 5.0);  // 700 ms
  EXPECT_EQ(told[0].pass_budget_us, 2000u);
  const auto& bins = told[0].imu_jitter;
  EXPECT_EQ(std::accumulate(bins.begin(), bins.end(), 0u), bins[0]) << "an even clock";
  EXPECT_GT(bins[0], 270u);
}

// ---- motors that stay stopped

TEST_F(FirmwareMotorTest, AfterASecondWithoutImuTheMotorsStandUntilDisarmed) {
  rig_.rc.channels[5] = 1.0f;
  rig_.run_for(100);
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.8f;
  rig_.run_for(600);
  ASSERT_NEAR(rig_.outputs()[0], 0.56f, 1e-2f);
  rig_.imu_on = false;
  rig_.run_for(900);
  rig_.imu_on = true;
  rig_.run_for(100);
  EXPECT_NEAR(rig_.outputs()[0], 0.56f, 1e-1f) << "less than a second: it flies on";
  rig_.run_for(1000);
  rig_.imu_on = false;
  rig_.run_for(1010);
  rig_.imu_on = true;
  rig_.run_for(60'000);
  EXPECT_TRUE(rig_.armed());
  expect_only(-1, 0.0f);
  EXPECT_TRUE(rig_.said("Motors stopped until disarmed: IMU silent for 1 s"));
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.0f;
  rig_.rc.channels[5] = 0.0f;
  rig_.run_for(300);
  ASSERT_FALSE(rig_.armed());
  rig_.rc.channels[5] = 1.0f;
  rig_.run_for(1000);
  ASSERT_TRUE(rig_.armed());
  EXPECT_NEAR(rig_.outputs()[0], 0.1f, 1e-6f) << "disarming ended it";
}

TEST_F(FirmwareMotorTest, DisarmReachesThePinsInItsPassWithoutAnImu) {
  rig_.rc.channels[5] = 1.0f;
  rig_.run_for(100);
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.8f;
  rig_.run_for(600);
  ASSERT_TRUE(rig_.armed());
  rig_.imu_on = false;
  rig_.rc.channels[5] = 0.0f;
  while (rig_.armed()) rig_.pass();
  expect_only(-1, 0.0f);
}

TEST_F(FirmwareMotorTest, TippedOverTheMotorsStopOnlyIfAskedFor) {
  for (const int crash_stop : {0, 1}) {
    rig_.set_param("CRASH_STOP", crash_stop);
    rig_.run_for(1000);
    rig_.rc.channels[5] = 1.0f;
    rig_.run_for(600);  // CRASH_STOP is stored first
    rig_.rc.channels[FirmwareRig::kThrottle] = 0.8f;
    rig_.run_for(600);
    ASSERT_TRUE(rig_.armed());
    rig_.gyro_rad_s = {3.14159f, 0.0f, 0.0f};
    rig_.accel_m_s2 = {0.0f, 0.0f, -1.0f};
    rig_.run_for(1000);
    rig_.gyro_rad_s = {1e-6f, 0.0f, 0.0f};
    rig_.run_for(700);
    const float sum = std::accumulate(rig_.outputs().begin(), rig_.outputs().begin() + 4, 0.0f);
    EXPECT_EQ(sum == 0.0f, crash_stop == 1) << sum;
    rig_.accel_m_s2 = {0.0f, 0.0f, -9.80665f};
    rig_.rc.channels[5] = 0.0f;
    rig_.rc.channels[FirmwareRig::kThrottle] = 0.0f;
    rig_.gyro_rad_s = {-3.14159f, 0.0f, 0.0f};
    rig_.run_for(1000);
    rig_.gyro_rad_s = {1e-6f, 0.0f, 0.0f};
    rig_.run_for(30'000);
    ASSERT_FALSE(rig_.armed());
  }
}

}  // namespace
}  // namespace rosflight::core
