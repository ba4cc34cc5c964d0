// SPDX-License-Identifier: BSD-3-Clause
// The firmware on the emulated Cortex-M7, in lock-step with the world.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "flight/autopilot/emulated_autopilot.hpp"
#include "flight/flight_recorder.hpp"
#include "flight/test/flight_rig.hpp"
#include "flight/test/last_words.hpp"
#include "sim/time_sources.hpp"

namespace rosflight::flight::testing {
namespace {

using boards::m7::Emulator;
using boards::m7::EmulatorError;
using Breakdown = Autopilot::Breakdown;

constexpr double kFault_s = 20.0;  // as in faults_test.cpp

FlightChoice on_m7(std::vector<std::string> faults = {}) {
  FlightChoice choice;
  choice.board = "qemu_m7";
  choice.faults = std::move(faults);
  return choice;
}

EmulatedAutopilot& as_emulated(Rig& rig) {
  return dynamic_cast<EmulatedAutopilot&>(rig.flight->autopilot());
}
FirmwareView view_of(const Rig& rig) {
  return rig.flight->autopilot().view();
}

/// What the runner received during a flight.
class Notes {
 public:
  explicit Notes(Rig& rig) {
    rig.flight->runner().set_notify(
        [this](const FlightNote& note) { text_ += note.source + ": " + note.text + "\n"; });
  }
  bool has(const std::string& part) const { return text_.find(part) != std::string::npos; }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// The crash report that the firmware sends when it is back.
class CrashReports final : public companion::Listener {
 public:
  explicit CrashReports(Rig& rig) : session_{rig.flight->session()} { session_.add(*this); }
  ~CrashReports() override { session_.remove(*this); }
  void on_event(const companion::Event& event) override {
    if (const auto* report = std::get_if<link::HardError>(&event)) reports.push_back(*report);
  }
  std::vector<link::HardError> reports;

 private:
  companion::Session& session_;
};

void expect_small_stack(const ProcessorFigures& figures) {
  EXPECT_LE(figures.stack_bytes, 8192U);
  EXPECT_GE(figures.stack_bytes, 256U) << "painted and looked at";
}
void expect_small_stack(const Rig& rig) {
  expect_small_stack(*rig.flight->autopilot().figures());
}

/// Speaking MAVLink, and with the image that speaks lean.
class EmulatedM7Speaking : public ::testing::TestWithParam<const char*> {};
TEST_P(EmulatedM7Speaking, FliesTheDefaultMissionToTheBitAsInProcess) {
  FlightChoice in_process;
  FlightChoice emulated = on_m7();
  in_process.link_protocol = emulated.link_protocol = GetParam();
  Rig here{in_process};
  Rig there{emulated};
  while (!here.flight->runner().finished()) {
    here.flight->step();
    there.flight->step();
    const sim::BodyState& a = here.flight->truth().body;
    const sim::BodyState& b = there.flight->truth().body;
    ASSERT_EQ(a.p_W, b.p_W) << "at " << sim::to_seconds(here.flight->now()) << " s";
    ASSERT_EQ(a.q_WB.coeffs(), b.q_WB.coeffs())
        << "at " << sim::to_seconds(here.flight->now()) << " s";
  }
  EXPECT_TRUE(here.completed());
  EXPECT_TRUE(there.completed());
  EXPECT_EQ(there.flight->session().statistics().frames.frames_dropped, 0U);
  EXPECT_EQ(here.flight->session().statistics().bytes_received,
            there.flight->session().statistics().bytes_received);
  EXPECT_EQ(as_emulated(there).figures()->resets, 0U);
  expect_small_stack(there);
}
INSTANTIATE_TEST_SUITE_P(Protocols, EmulatedM7Speaking, ::testing::Values("mavlink", "lean"));

/// Hash of the log of a flight on the estimate, which the log has as well: every byte of the link, a hundred
/// estimates a second.
std::string log_hash(const FlightChoice& choice, const std::filesystem::path& file) {
  Rig rig{choice};
  EXPECT_EQ(rig.setup->choice.state, "estimate");
  FlightRecorder recorder(*rig.flight, file);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
  const std::string hash = recorder.close()->sha256;
  std::filesystem::remove(file);
  return hash;
}

class EmulatedM7Log : public ::testing::TestWithParam<const char*> {};
TEST_P(EmulatedM7Log, IsTheSameToTheByteAsInProcess) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("rosflight_m7_log_" + std::string(GetParam()));
  FlightChoice in_process;
  FlightChoice emulated = on_m7();
  in_process.vehicle = emulated.vehicle = GetParam();
  EXPECT_EQ(log_hash(emulated, file), log_hash(in_process, file));
}
INSTANTIATE_TEST_SUITE_P(Vehicles, EmulatedM7Log, ::testing::Values("multirotor", "anaconda"));

TEST(EmulatedM7, RadioLossIsFailsafeThenTheMissionGoesOn) {
  Rig rig{on_m7({"rc_silence@20:2"})};
  rig.run_until(kFault_s + 0.225);
  EXPECT_TRUE(view_of(rig).failsafe);
  EXPECT_NE(view_of(rig).errors & static_cast<unsigned>(core::Error::kRcLost), 0U);
  rig.run_until(kFault_s + 2.0 + 0.025);
  EXPECT_FALSE(view_of(rig).failsafe);
  rig.flight->run();
  EXPECT_TRUE(rig.completed());
  expect_small_stack(rig);
}

TEST(EmulatedM7, ImuLossFallsWithMotorsOffAndStaysArmed) {
  Rig rig{on_m7({"imu@20"})};
  rig.run_until(kFault_s + 0.13);
  EXPECT_NE(view_of(rig).errors & static_cast<unsigned>(core::Error::kImuNotResponding), 0U);
  rig.flight->run();
  EXPECT_EQ(rig.flight->runner().stage(), Stage::kFailed);
  EXPECT_TRUE(view_of(rig).armed);
  EXPECT_EQ(as_emulated(rig).emulator().from_processor().outputs[0], 0.0F);
  expect_small_stack(rig);
}

/// A crash or a hang in flight: record, reset, armed again, the mission goes on.
class TroubleInFlight : public ::testing::TestWithParam<Breakdown> {};
TEST_P(TroubleInFlight, LeavesARecordResetsAndRearms) {
  Rig rig{on_m7()};
  const Notes notes(rig);
  const CrashReports crashes(rig);
  rig.run_until(kFault_s);
  ASSERT_TRUE(view_of(rig).armed);
  const double height_m = rig.height_m();
  const sim::Time boot = rig.flight->autopilot().boot_time();
  rig.flight->autopilot().break_down(rig.flight->now(), GetParam());
  rig.flight->step();
  EXPECT_EQ(as_emulated(rig).figures()->resets, 1U);
  EXPECT_GT(rig.flight->autopilot().boot_time(), boot);
  EXPECT_TRUE(view_of(rig).armed);
  rig.run_for(1.0);
  EXPECT_TRUE(view_of(rig).armed);
  EXPECT_LT(rig.tilt_deg(), 30.0);
  EXPECT_NEAR(rig.height_m(), height_m, 1.5);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
  EXPECT_TRUE(notes.has("Rearmed after a fault in flight")) << notes.text();
  EXPECT_TRUE(notes.has("Fault 1 at pc ")) << notes.text();
  // The address in the record lies in the image's code, in the driver that broke.
  ASSERT_EQ(crashes.reports.size(), 1U);
  const link::HardError& record = crashes.reports.front();
  EXPECT_GT(record.pc, 0U);
  EXPECT_LT(record.pc, 0x0040'0000U);
  EXPECT_EQ(record.reset_count, 1U);
  EXPECT_EQ(as_emulated(rig).figures()->resets, 1U);
  expect_small_stack(rig);
}
INSTANTIATE_TEST_SUITE_P(Kinds, TroubleInFlight,
                         ::testing::Values(Breakdown::kCrash, Breakdown::kHang),
                         [](const auto& kind) {
                           return kind.param == Breakdown::kHang ? "Hang" : "Crash";
                         });

TEST(EmulatedM7, CrashOnTheGroundLeavesItDisarmed) {
  Rig rig{on_m7()};
  ASSERT_TRUE(rig.reach(Stage::kCalibrate));
  const Notes notes(rig);
  rig.flight->autopilot().break_down(rig.flight->now(), Breakdown::kCrash);
  rig.flight->step();
  EXPECT_EQ(as_emulated(rig).figures()->resets, 1U);
  rig.run_for(1.0);
  EXPECT_FALSE(view_of(rig).armed);
  for (const float output : as_emulated(rig).emulator().from_processor().outputs)
    EXPECT_EQ(output, 0.0F);
  EXPECT_TRUE(notes.has("Fault 1 at pc ")) << notes.text();
}

TEST(EmulatedM7, PowerLossInFlightDoesNotRearm) {
  Rig rig{on_m7()};
  rig.run_until(kFault_s);
  rig.flight->autopilot().break_down(rig.flight->now(), Breakdown::kPowerLoss);
  rig.run_for(0.5);
  EXPECT_FALSE(view_of(rig).armed) << "backup memory does not survive the power";
}

/// Sets a parameter over the link, has it written, and waits until both are acknowledged.
void store_parameter(Rig& rig, const char* name, double value) {
  auto set = rig.flight->session().parameters().set(name, value);
  rig.run_for(0.5);
  ASSERT_FALSE(set.pending());
  auto write = rig.flight->session().commands().start(link::Command::kWriteParams);
  rig.run_for(0.5);
  ASSERT_FALSE(write.pending());
  ASSERT_FALSE(write.failed()) << write.text();
}

double read_parameter(Rig& rig, const char* name) {
  auto read = rig.flight->session().parameters().read(name);
  rig.run_for(1.0);
  const auto value = rig.flight->session().parameters().get(name);
  return !read.pending() && value ? value->number() : -1.0;
}

TEST(EmulatedM7, AParameterSurvivesResetAndEmulator) {
  Rig rig{on_m7()};
  ASSERT_TRUE(rig.reach(Stage::kConfigure));
  rig.flight->runner().set_notify(nullptr);
  rig.run_for(0.5);
  store_parameter(rig, "FILT_ACC_KP", 0.875);

  static_cast<void>(rig.flight->session().commands().start(link::Command::kReboot));
  rig.run_for(1.0);
  EXPECT_EQ(as_emulated(rig).figures()->resets, 1U) << "the processor has reset itself";
  EXPECT_EQ(as_emulated(rig).emulator().from_processor().boots, 2U);
  EXPECT_EQ(read_parameter(rig, "FILT_ACC_KP"), 0.875);

  const pid_t before = as_emulated(rig).emulator().process();
  rig.flight->autopilot().break_down(rig.flight->now(), Breakdown::kPowerLoss);
  EXPECT_NE(as_emulated(rig).emulator().process(), before);
  EXPECT_EQ(as_emulated(rig).emulator().from_processor().boots, 1U);
  rig.run_for(1.0);
  EXPECT_EQ(read_parameter(rig, "FILT_ACC_KP"), 0.875);
}

bool gone(pid_t process) {
  return ::kill(process, 0) == -1 && errno == ESRCH;
}

TEST(EmulatedM7, ADeadEmulatorEndsTheFlight) {
  Rig rig{on_m7()};
  rig.run_for(1.0);
  const pid_t process = as_emulated(rig).emulator().process();
  ASSERT_EQ(::kill(process, SIGKILL), 0);
  const std::string said = last_words(rig);
  EXPECT_NE(said.find("ended by signal 9"), std::string::npos) << said;
  EXPECT_TRUE(gone(process));
}

TEST(EmulatedM7, AHangingEmulatorEndsTheFlightWithinFiveSeconds) {
  Rig rig{on_m7()};
  rig.run_for(1.0);
  const pid_t process = as_emulated(rig).emulator().process();
  ASSERT_EQ(::kill(process, SIGSTOP), 0);
  const std::string said = last_words(rig);
  EXPECT_NE(said.find("no answer for 4000 ms"), std::string::npos) << said;
  EXPECT_TRUE(gone(process)) << "nothing stays behind";
}

/// Real time over the emulated UART: never repeatable, so only what must come in the end.
TEST(EmulatedUart, BringsTheFirmwareUpOverTheWire) {
  FlightChoice choice = on_m7();
  choice.link = "uart";
  sim::SteadyWallClock wall;
  sim::PacedTime pace(Flight::kStep, 1.0, wall);
  FlightParts parts;
  parts.time = &pace;
  Rig rig{choice, std::move(parts)};
  ASSERT_TRUE(rig.reach(Stage::kStore)) << rig.flight->runner().failure();
  EXPECT_TRUE(rig.flight->session().parameters().complete()) << "read byte by byte";
  EXPECT_EQ(view_of(rig).errors, 0U) << "calibrated, mixer chosen";
  const auto figures = rig.flight->autopilot().figures();
  EXPECT_GT(figures->uart_sent, 20'000U);
  EXPECT_GT(figures->uart_received, 200U);
  EXPECT_EQ(figures->resets, 0U);
  expect_small_stack(*figures);
}

TEST(EmulatedM7, WhatIsMissingIsNamedWithItsPackage) {
  Emulator::Options options;
  options.image = emulated_image();
  options.program = "qemu-system-arm-that-nobody-has";
  try {
    const Emulator emulator(options);
    FAIL() << "no emulator is an error";
  } catch (const EmulatorError& error) {
    EXPECT_NE(std::string(error.what()).find("not installed"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("package"), std::string::npos);
  }
  options.program = "qemu-system-arm";
  options.image = "/nonexistent/firmware.elf";
  try {
    const Emulator emulator(options);
    FAIL() << "no image is an error";
  } catch (const EmulatorError& error) {
    EXPECT_NE(std::string(error.what()).find("gcc-arm-none-eabi"), std::string::npos);
  }
}

TEST(EmulatedM7, AnImageThatIsNoneIsToldWithWhatTheEmulatorSaid) {
  const std::filesystem::path image = std::filesystem::path(::testing::TempDir()) /
                                      ("broken" + std::to_string(::getpid()) + ".elf");
  std::ofstream(image) << "this is no program";
  CableLink cable{sim::RandomSource{1}};
  Emulator::Options options;
  options.image = image;
  options.timeout = std::chrono::seconds(20);  // it ends by itself before
  EmulatedAutopilot autopilot(cable, options);
  try {
    autopilot.start(sim::Time{0});
    ADD_FAILURE() << "no program is an error";
  } catch (const EmulatorError& error) {
    EXPECT_NE(std::string(error.what()).find("its last output:\nqemu-system-arm: "),
              std::string::npos)
        << error.what();
  }
  EXPECT_FALSE(autopilot.emulator().running());
  std::filesystem::remove(image);
}

}  // namespace
}  // namespace rosflight::flight::testing
