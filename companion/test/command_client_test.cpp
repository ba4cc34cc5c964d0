// SPDX-License-Identifier: BSD-3-Clause
#include "companion/command_client.hpp"

#include <gtest/gtest.h>

#include <bit>

#include "companion/calibration_texts.hpp"
#include "companion/test/rig.hpp"

namespace rosflight::companion::test {
namespace {

using link::Command;

std::vector<FakeFcu::Parameter> calibration_table() {
  std::vector<FakeFcu::Parameter> table;
  for (const char* name : {"ACC_X_BIAS", "ACC_Y_BIAS", "ACC_Z_BIAS", "GYRO_X_BIAS", "GYRO_Y_BIAS",
                           "GYRO_Z_BIAS", "BARO_BIAS", "GROUND_LEVEL", "DIFF_PRESS_BIAS"}) {
    table.push_back({name, ParameterValue::of(0.0f)});
  }
  return table;
}

/// A rig whose list is in, so that only the command's own traffic is left.
struct CommandRig : Rig {
  CommandRig() : Rig(calibration_table()) {
    run_until(
        [this] { return session.parameters().complete() && !session.firmware_version().empty(); });
    fcu.received.clear();
  }
  std::size_t sent(Command command) const {
    std::size_t n = 0;
    for (const link::Message& m : fcu.received) {
      const auto* request = std::get_if<link::CommandRequest>(&m);
      n += request != nullptr && request->command == static_cast<std::uint8_t>(command) ? 1U : 0U;
    }
    return n;
  }
};

TEST(Command, EndsWithTheAcknowledge) {
  for (const Command c : {Command::kRcCalibration, Command::kReadParams, Command::kWriteParams,
                          Command::kSetParamDefaults, Command::kSendVersion}) {
    CommandRig rig;
    const auto job = rig.session.commands().start(c);
    ASSERT_TRUE(rig.run_job(job, 100ms));
    EXPECT_TRUE(job.done()) << job.text();
    EXPECT_TRUE(job.result().acknowledged);
    EXPECT_EQ(rig.sent(c), 1U);
  }
}

TEST(Command, NothingIsDueWhileItWaits) {
  CommandRig rig;
  const auto job = rig.session.commands().start(Command::kGyroCalibration);
  rig.run_for(100ms);
  ASSERT_TRUE(job.pending());
  int due_at_once = 0;
  for (int i = 0; i < 100; ++i) {
    rig.step();
    due_at_once += rig.session.next_due() <= rig.now ? 1 : 0;
  }
  EXPECT_EQ(due_at_once, 0);  // a runner would spin
}

TEST(Command, RefusalTellsThatTheVehicleIsArmed) {
  CommandRig rig;
  rig.fcu.on_command = [](Command) { return false; };
  auto job = rig.session.commands().start(Command::kWriteParams);
  ASSERT_TRUE(rig.run_job(job, 100ms));
  EXPECT_EQ(job.text(), "writing parameters: refused");
  rig.fcu.armed = true;
  link::Status status;
  status.armed = true;
  rig.fcu.send(status);
  rig.step();
  job = rig.session.commands().start(Command::kWriteParams);
  ASSERT_TRUE(rig.run_job(job, 100ms));
  EXPECT_TRUE(job.failed());
  EXPECT_EQ(job.text(), "writing parameters: refused: the vehicle is armed");
}

TEST(Command, IsRepeatedWhenTheAcknowledgeIsLostUnlessItAddsUp) {
  CommandRig rig;
  int asked = 0;
  rig.fcu.on_command = [&](Command) -> std::optional<bool> {
    return ++asked < 3 ? std::nullopt : std::optional(true);
  };
  auto job = rig.session.commands().start(Command::kSetParamDefaults);
  ASSERT_TRUE(rig.run_job(job, 5s));
  EXPECT_TRUE(job.done());
  EXPECT_EQ(rig.sent(Command::kSetParamDefaults), 3U);

  rig.fcu.on_command = [](Command) { return std::nullopt; };
  job = rig.session.commands().start(Command::kRcCalibration);
  ASSERT_TRUE(rig.run_job(job, 5s));
  EXPECT_EQ(job.text(), "RC trim calibration: no answer");
  EXPECT_EQ(rig.sent(Command::kRcCalibration), 1U);
}

TEST(Command, OfTheSameKindRunsOnceAtATimeAndNeverBlocksTheNext) {
  CommandRig rig;
  rig.fcu.on_command = [](Command) { return std::nullopt; };
  const auto lost = rig.session.commands().start(Command::kWriteParams);
  const auto second = rig.session.commands().start(Command::kWriteParams);
  EXPECT_TRUE(second.failed());
  EXPECT_EQ(second.text(), "writing parameters: already in progress");
  ASSERT_TRUE(rig.run_job(lost, 20s));
  EXPECT_TRUE(lost.failed());
  rig.fcu.on_command = nullptr;
  const auto third = rig.session.commands().start(Command::kWriteParams);
  ASSERT_TRUE(rig.run_job(third, 100ms));
  EXPECT_TRUE(third.done());
}

TEST(Command, UnknownCodesAreRefusedHere) {
  CommandRig rig;
  const auto job = rig.session.commands().start(std::bit_cast<Command>(std::uint8_t{11}));
  EXPECT_TRUE(job.failed());
  EXPECT_EQ(job.text(), "no such command");
}

struct CalibrationCase {
  Command command;
  std::string_view text;
  bool success;
};

class Calibration : public testing::TestWithParam<CalibrationCase> {};

TEST_P(Calibration, EndsWithWhatTheLogOfTheFcuSays) {
  const CalibrationCase& c = GetParam();
  CommandRig rig;
  const auto job = rig.session.commands().start(c.command);
  rig.run_for(2500ms);
  EXPECT_TRUE(job.pending());
  rig.fcu.send_text("[info] nothing to do with it");
  std::string line(c.text);
  line[0] = static_cast<char>(line[0] ^ 0x20);  // other case
  rig.fcu.send_text(line + " 1.23", link::Severity::kInfo);
  ASSERT_TRUE(rig.run_job(job, 300ms));
  EXPECT_EQ(job.done(), c.success) << job.text();
  EXPECT_EQ(job.result().fcu_text, line + " 1.23");
}

INSTANTIATE_TEST_SUITE_P(
    Texts, Calibration,
    testing::Values(
        CalibrationCase{Command::kAccelCalibration, "IMU offsets captured", true},
        CalibrationCase{Command::kAccelCalibration, "too much movement for IMU cal", false},
        CalibrationCase{Command::kAccelCalibration, "large accelerometer bias", false},
        CalibrationCase{Command::kAccelCalibration, "gyro calibration failed", false},
        CalibrationCase{Command::kAccelCalibration, "gyro calibration refused: mean", false},
        CalibrationCase{Command::kAccelCalibration, "accel calibration refused: tilt", false},
        CalibrationCase{Command::kGyroCalibration, "Gyro calibration complete", true},
        CalibrationCase{Command::kGyroCalibration, "gyro calibration failed", false},
        CalibrationCase{Command::kGyroCalibration, "gyro calibration refused: moved", false},
        CalibrationCase{Command::kBaroCalibration, "Baro Cal successful!", true},
        CalibrationCase{Command::kBaroCalibration, "too much movement for barometer cal", false},
        CalibrationCase{Command::kAirspeedCalibration, "Airspeed Cal Successful!", true},
        CalibrationCase{Command::kAirspeedCalibration, "too much movement for diff pressure cal",
                        false}));

// Both end with the same sample; whichever line comes first, a failure decides.
TEST(Calibration, ImuFailsIfTheGyroFailsRightAfterTheAccelerometerSucceeded) {
  CommandRig rig;
  const auto job = rig.session.commands().start(Command::kAccelCalibration);
  rig.run_for(2500ms);
  rig.fcu.send_text(kImuSuccess);
  rig.fcu.send_text(kGyroFailure, link::Severity::kError);
  ASSERT_TRUE(rig.run_job(job, 300ms));
  EXPECT_TRUE(job.failed());
}

TEST(Calibration, AResultFromBeforeTheStartDoesNotCount) {
  CommandRig rig;
  const auto job = rig.session.commands().start(Command::kBaroCalibration);
  rig.fcu.send_text(kBaroSuccess);  // of the automatic one after boot
  rig.run_for(1s);
  EXPECT_TRUE(job.pending());
}

// ROSflight 2.x has no line for a good gyro calibration: the biases go to zero at the start and are
// new then.
TEST(Calibration, NewBiasesProveSuccessWithoutALine) {
  CommandRig rig;
  rig.fcu.set_from_inside("GYRO_X_BIAS", ParameterValue::of(0.5f));
  rig.step();
  const auto job = rig.session.commands().start(Command::kGyroCalibration);
  rig.run_for(10ms);
  rig.fcu.set_from_inside("GYRO_X_BIAS", ParameterValue::of(0.0f));
  rig.run_for(1s);
  EXPECT_TRUE(job.pending());
  for (const char* name : {"GYRO_X_BIAS", "GYRO_Y_BIAS", "GYRO_Z_BIAS"}) {
    rig.fcu.set_from_inside(name, ParameterValue::of(0.01f));
  }
  ASSERT_TRUE(rig.run_job(job, 600ms));
  EXPECT_TRUE(job.done());
  EXPECT_EQ(job.text(), "gyro calibration: new values received");
}

// Our firmware puts the old biases back when a calibration fails.
TEST(Calibration, OldBiasesComingBackAreNoSuccess) {
  CommandRig rig;
  for (const char* name : {"GYRO_X_BIAS", "GYRO_Y_BIAS", "GYRO_Z_BIAS"}) {
    rig.fcu.set_from_inside(name, ParameterValue::of(0.01f));
  }
  rig.step();
  const auto job = rig.session.commands().start(Command::kGyroCalibration);
  rig.run_for(10ms);
  for (const char* name : {"GYRO_X_BIAS", "GYRO_Y_BIAS", "GYRO_Z_BIAS"}) {
    rig.fcu.set_from_inside(name, ParameterValue::of(0.0f));
    rig.fcu.set_from_inside(name, ParameterValue::of(0.01f));
  }
  ASSERT_TRUE(rig.run_job(job, 30s));
  EXPECT_TRUE(job.failed());
  EXPECT_EQ(job.text(), "gyro calibration: started, but no result came");
}

TEST(Calibration, AsksForTheBiasesWhenLineAndValuesWereLost) {
  CommandRig rig;
  const auto job = rig.session.commands().start(Command::kAirspeedCalibration);
  rig.run_for(1s);
  rig.fcu.find("DIFF_PRESS_BIAS")->value = ParameterValue::of(12.5f);  // without a message about it
  ASSERT_TRUE(rig.run_job(job, 30s));
  EXPECT_TRUE(job.done());
  EXPECT_NEAR(to_seconds(job.duration()), 20.5, 0.1);
}

TEST(Calibration, FailsWhenTheFcuRestartsOrTheLinkIsPulled) {
  CommandRig rig;
  rig.run_for(1s);
  auto job = rig.session.commands().start(Command::kBaroCalibration);
  rig.run_for(100ms);
  rig.fcu.restart();
  ASSERT_TRUE(rig.run_job(job, 100ms));
  EXPECT_EQ(job.text(), "barometer calibration: the flight control unit restarted");

  job = rig.session.commands().start(Command::kBaroCalibration);
  rig.run_for(100ms);
  rig.link.plug(false);
  ASSERT_TRUE(rig.run_job(job, 100ms));
  EXPECT_EQ(job.text(), "barometer calibration: connection lost");
}

TEST(Reboot, EndsWhenTheBootClockStartsAnew) {
  CommandRig rig;
  rig.run_for(1s);
  bool reboot = false;
  rig.fcu.on_command = [&](Command c) {
    reboot = c == Command::kReboot;
    return true;
  };
  const auto job = rig.session.commands().start(Command::kReboot);
  ASSERT_TRUE(rig.run_until([&] { return reboot; }));
  rig.fcu.silent = true;
  rig.run_for(3s);  // longer than the connection lasts
  EXPECT_TRUE(job.pending());
  rig.fcu.silent = false;
  rig.fcu.restart();
  ASSERT_TRUE(rig.run_job(job, 100ms));
  EXPECT_TRUE(job.done());
  EXPECT_EQ(job.text(), "reboot: restarted");
  EXPECT_EQ(rig.sent(Command::kReboot), 1U);
}

TEST(Reboot, FailsIfNothingRestarts) {
  CommandRig rig;
  const auto job = rig.session.commands().start(Command::kReboot);
  ASSERT_TRUE(rig.run_job(job, 20s));
  EXPECT_EQ(job.text(), "reboot: acknowledged, but no restart was seen");
}

TEST(Reboot, ToTheBootloaderEndsWithSilence) {
  CommandRig rig;
  const auto job = rig.session.commands().start(Command::kRebootToBootloader);
  rig.run_for(100ms);
  rig.fcu.silent = true;
  ASSERT_TRUE(rig.run_job(job, 3s));
  EXPECT_TRUE(job.done());
  EXPECT_EQ(job.text(), "reboot to bootloader: the flight control unit has left");
}

// ROSflight 2.x does not report which values a read or the defaults brought.
TEST(Command, ReadAndDefaultsBringTheMirrorUpToDate) {
  CommandRig rig;
  rig.fcu.set_from_inside("DIFF_PRESS_BIAS", ParameterValue::of(3.0f));
  rig.step();
  EXPECT_TRUE(rig.session.parameters().unsaved());
  rig.fcu.on_command = [&](Command) {
    rig.fcu.find("DIFF_PRESS_BIAS")->value = ParameterValue::of(5.0f);
    return true;
  };
  const auto job = rig.session.commands().start(Command::kReadParams);
  ASSERT_TRUE(rig.run_job(job, 100ms));
  ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().table().all_fresh(); }, 1s));
  EXPECT_FLOAT_EQ(rig.mirror("DIFF_PRESS_BIAS").as_float(), 5.0f);
  EXPECT_FALSE(rig.session.parameters().unsaved());
}

// The firmware measures them seconds after each start, which may be while parameters are written.
TEST(ParameterUnsaved, IsNotWhatTheBarometerMeasuresAtEveryStart) {
  CommandRig rig;
  rig.fcu.on_command = [&](Command) {
    rig.fcu.set_from_inside("BARO_BIAS", ParameterValue::of(3.0f));
    rig.fcu.set_from_inside("GROUND_LEVEL", ParameterValue::of(4.0f));
    return true;
  };
  const auto job = rig.session.commands().start(Command::kWriteParams);
  ASSERT_TRUE(rig.run_job(job, 100ms));
  rig.run_for(10ms);
  EXPECT_FLOAT_EQ(rig.mirror("GROUND_LEVEL").as_float(), 4.0f);
  EXPECT_FALSE(rig.session.parameters().unsaved());
}

}  // namespace
}  // namespace rosflight::companion::test
