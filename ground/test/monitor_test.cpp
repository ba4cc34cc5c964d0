// SPDX-License-Identifier: BSD-3-Clause
#include "ground/monitor.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "companion/test/rig.hpp"

namespace rosflight::ground {
namespace {

using companion::test::Rig;
using nlohmann::json;

struct MonitorRig : Rig {
  MonitorRig() : monitor(session) {
    fcu.imu = false;
    run_for(std::chrono::seconds{1});
  }
  void send(const link::Message& message) {
    fcu.send(message);
    run_for(std::chrono::milliseconds{10});
  }
  Monitor monitor;
};

TEST(Monitor, WhatWasNotReceivedIsNullOrSaysSo) {
  MonitorRig rig;
  const json now = json::parse(rig.monitor.json());
  for (const char* name : {"state", "attitude", "imu", "gnss", "battery", "rc", "outputs"}) {
    EXPECT_TRUE(now[name].is_null()) << name;
  }
  EXPECT_TRUE(now["connected"]);
  EXPECT_NE(rig.monitor.screen().find("battery    not received\n"), std::string::npos);
  EXPECT_EQ(rig.monitor.line().find("attitude - | battery - | GNSS - | RC - | state unknown"), 0U);
}

TEST(Monitor, AnglesAreThoseOfTheQuaternion) {
  MonitorRig rig;
  // Yaw 90 deg, then pitch 30 deg, then roll 60 deg (Kuipers, Quaternions and Rotation Sequences, sec. 8.5).
  const float c45 = 0.70710678f, c15 = 0.96592583f, s15 = 0.25881905f, c30 = 0.8660254f, s30 = 0.5f;
  rig.send(link::Attitude{
      .q_WB = {c45 * c15 * c30 + c45 * s15 * s30, c45 * c15 * s30 - c45 * s15 * c30,
               c45 * s15 * c30 + c45 * c15 * s30, c45 * c15 * c30 - c45 * s15 * s30}});
  const json now = json::parse(rig.monitor.json());
  EXPECT_NEAR(now["attitude"]["roll_deg"], 60.0, 1e-4);
  EXPECT_NEAR(now["attitude"]["pitch_deg"], 30.0, 1e-4);
  EXPECT_NEAR(now["attitude"]["yaw_deg"], 90.0, 1e-4);
  EXPECT_EQ(rig.monitor.line().find("roll +60.0 pitch +30.0 yaw +90.0 deg"), 0U);
}

TEST(Monitor, StateErrorsAndChannelsAreInWords) {
  MonitorRig rig;
  rig.send(link::Status{.armed = true, .failsafe = true, .error_code = 0x04 | 0x80});
  link::RcChannels rc;
  rc.count = 2;
  rc.pulse_us = {1500, 1000, 999};
  rig.send(rc);
  const std::string line = rig.monitor.line();
  EXPECT_NE(line.find("RC 1500 1000 |"), std::string::npos) << line;
  EXPECT_NE(line.find("ARMED, FAILSAFE, pass-through; errors: RC lost, invalid failsafe throttle"),
            std::string::npos)
      << line;
  EXPECT_EQ(json::parse(rig.monitor.json())["state"]["errors"],
            json({"RC lost", "invalid failsafe throttle"}));
}

TEST(Monitor, TextsStayOnTheScreenAndComeOnceInLines) {
  MonitorRig rig;
  for (int i = 0; i < 12; ++i) {
    rig.fcu.send_text("text " + std::to_string(i) + ".", link::Severity::kWarning);
    rig.run_for(std::chrono::milliseconds{10});
  }
  const json now = json::parse(rig.monitor.json());
  ASSERT_EQ(now["texts"].size(), Monitor::kTexts);
  EXPECT_EQ(now["texts"].back(), (json{{"severity", "warning"}, {"text", "text 11."}}));
  EXPECT_EQ(json::parse(rig.monitor.json())["texts"].size(), 0U);
  const std::string screen = rig.monitor.screen();
  EXPECT_EQ(screen.find("text 3."), std::string::npos);
  EXPECT_NE(screen.find("warning    text 11.\n"), std::string::npos);
}

TEST(Monitor, LostFramesAndALostVehicleShow) {
  MonitorRig rig;
  rig.fcu.imu = true;
  rig.lossy_down.byte_loss = 0.01;
  rig.run_for(std::chrono::seconds{3});
  const json now = json::parse(rig.monitor.json());
  // A frame of 36 to 48 bytes is whole in 0.99^42 of the cases.
  EXPECT_NEAR(now["link"]["loss_percent"], 34.0, 10.0);
  rig.fcu.silent = true;
  rig.run_for(std::chrono::seconds{3});
  EXPECT_NE(rig.monitor.line().find("NO ANSWER"), std::string::npos);
  EXPECT_FALSE(json::parse(rig.monitor.json())["connected"]);
}

}  // namespace
}  // namespace rosflight::ground
