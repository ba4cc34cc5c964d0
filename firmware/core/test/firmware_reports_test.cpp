// SPDX-License-Identifier: BSD-3-Clause
// What the whole firmware reports as texts: sensors that fail and answer again, frames that are lost.
#include "firmware/core/test/firmware_rig.hpp"

namespace rosflight::core {
namespace {

class FirmwareReports : public testing::Test {
 protected:
  void start() {
    rig_.store_quadrotor();
    rig_.start();
  }
  FirmwareRig rig_;
};

// ---- sensors

// Weak point 72.
TEST_F(FirmwareReports, SensorStartMessagesAreToldAsTexts) {
  rig_.board.system.add_message("IMU: ok", true);
  rig_.board.system.add_message("Barometer: no answer", false);
  start();
  rig_.run_for(500);
  EXPECT_TRUE(rig_.said("IMU: ok"));
  for (const auto& t : rig_.got<link::StatusText>()) {
    if (std::string(t.text.data()) == "Barometer: no answer") {
      EXPECT_EQ(t.severity, link::Severity::kError);
    }
  }
  EXPECT_TRUE(rig_.said("Barometer: no answer"));
}

TEST_F(FirmwareReports, ASensorThatFallsSilentAndItsReturnAreTold) {
  start();
  const auto with_baro = [this](std::int64_t ms) {
    for (const Time end = rig_.now() + hal::milliseconds(ms); rig_.now() < end;) {
      rig_.board.baro.put({rig_.now(), 101'325.0f, 290.0f});
      rig_.pass();
    }
  };
  with_baro(2000);
  rig_.run_for(5000);
  EXPECT_EQ(rig_.count_text("Sensor silent: baro"), 1u);
  EXPECT_FALSE(rig_.said("Sensor silent: mag")) << "it never answered";
  with_baro(1000);
  EXPECT_EQ(rig_.count_text("Sensor answers again: baro"), 1u);
}

TEST_F(FirmwareReports, SensorErrorsThatTheBoardCountsAreToldEveryTenSecondsAtMost) {
  start();
  rig_.run_for(1100);
  for (std::uint16_t n = 1; n <= 250; ++n) {
    rig_.board.system.set_sensor_errors(n);
    rig_.run_for(100);
  }
  std::size_t told = 0;
  for (const std::string& line : rig_.texts()) {
    told += line.rfind("Sensor errors since start: ", 0) == 0 ? 1u : 0u;
  }
  EXPECT_EQ(told, 3u);
}

TEST_F(FirmwareReports, AFailedSensorIsReportedOnceAndItsErrorsAreNotReportedInAddition) {
  start();
  rig_.run_for(1100);
  auto& system = rig_.board.system;
  system.set_sensor_errors(1);
  rig_.run_for(100);
  system.add_change("Barometer: no answer", false);
  system.set_sensor_errors(2);
  rig_.run_for(5000);
  system.add_change("Barometer: ok", true);
  rig_.run_for(5000);
  std::vector<std::string> found;
  for (const auto& t : rig_.got<link::StatusText>()) {
    const std::string text = t.text.data();
    if (text.find("Barometer") == std::string::npos && text.find("errors") == std::string::npos)
      continue;
    found.push_back(text);
    EXPECT_EQ(t.severity, text == "Barometer: ok" ? link::Severity::kInfo : link::Severity::kError);
  }
  EXPECT_EQ(found, (std::vector<std::string>{"Barometer: no answer", "Barometer: ok"}));
}

// ---- losses

TEST_F(FirmwareReports, WhatTheLinkLosesIsCountedAndToldOnceInTenSeconds) {
  start();
  rig_.run_for(2100);
  rig_.inbox.clear();
  EXPECT_EQ(rig_.firmware().telemetry().dropped(), 0u);
  const std::vector<std::uint8_t> broken{0xFE, 0x09, 0x00, 0x01, 0x32, 0x00, 1,    2,   3,
                                         4,    5,    6,    7,    8,    9,    0xAA, 0xBB};
  for (int k = 0; k < 300; ++k) {  // 30 s
    rig_.serial.put(broken.data(), broken.size());
    rig_.run_for(100);
  }
  std::size_t told = 0;
  for (const std::string& line : rig_.texts())
    told += line.rfind("Link lost: in ", 0) == 0 ? 1u : 0u;
  EXPECT_GE(told, 3u);
  EXPECT_LE(told, 4u);
  rig_.inbox.clear();
  rig_.send(link::ReportRequest{1, static_cast<std::uint8_t>(link::ReportKind::kCounters)});
  rig_.run_for(20);
  ASSERT_EQ(rig_.got<link::Counters>().size(), 1u);
  EXPECT_GE(rig_.got<link::Counters>()[0].frames_dropped, 300u);
  rig_.run_for(15'000);
  rig_.inbox.clear();
  rig_.run_for(30'000);
  for (const std::string& line : rig_.texts()) EXPECT_NE(line.rfind("Link lost", 0), 0u) << line;
}

TEST(FirmwareOnAFullLine, FramesThatThePortDoesNotTakeAreCountedAndTold) {
  boards::SimulatedBoard board;
  boards::MemorySerial serial{100};  // an IMU sample and an attitude, not the outputs too
  link::MavlinkCodec fcu{{1, 250}};
  Firmware firmware(board.roles(serial), fcu);
  firmware.start();
  for (int k = 1; k <= 800; ++k) {
    const Time now = hal::microseconds(std::int64_t{2500} * k);
    board.clock.set(now);
    board.imu.put({now, {0.001f * static_cast<float>(k % 7), 0.0f, -9.8f}, {}, 300.0f});
    firmware.run();
    static_cast<void>(serial.take_sent());
  }
  EXPECT_GE(firmware.telemetry().dropped(), 100u);
  EXPECT_EQ(firmware.telemetry().dropped(), serial.dropped());
}

}  // namespace
}  // namespace rosflight::core
