// SPDX-License-Identifier: BSD-3-Clause
// The images of the boards with an STM32H7 on the emulated chip, in lock-step with the world. A complaint of a
// model ends the flight with an exception, so each of these also says that there was none.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>

#include "flight/autopilot/chip_autopilot.hpp"
#include "flight/flight_recorder.hpp"
#include "flight/test/h7_rig.hpp"

namespace rosflight::flight::testing {
namespace {

using Breakdown = Autopilot::Breakdown;

constexpr double kFault_s = 20.0;  // as in faults_test.cpp

struct Logged {
  std::string hash;
  ProcessorFigures figures;
  std::optional<link::Counters> counters;
  double time_s{};
};

/// @param looked_at  called with the flight when it has ended.
Logged fly(const std::string& board, std::uint64_t seed,
           const std::function<void(const Rig&, const FlightChoice&)>& looked_at = {}) {
  FlightChoice choice = on_board({}, board);
  choice.seed = seed;
  const std::filesystem::path file =
      std::filesystem::path(::testing::TempDir()) / ("h7_log_" + std::to_string(::getpid()));
  Rig rig{choice};
  FlightRecorder recorder(*rig.flight, file);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
  EXPECT_EQ(rig.flight->session().statistics().frames.frames_dropped, 0U);
  Logged logged{recorder.close()->sha256, *chip_of(rig).figures(), recorder.counters(),
                sim::to_seconds(rig.flight->now())};
  if (looked_at) looked_at(rig, choice);
  std::filesystem::remove(file);
  return logged;
}

class EachImage : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Boards, EachImage, ::testing::Values("pixracer_pro", "varmint"),
                         [](const auto& board) { return std::string(board.param); });

TEST_P(EachImage, FliesTheDefaultMissionTwiceWithTheSameLog) {
  const Logged first = fly(GetParam(), 1, expect_tracked_as_in_process);
  EXPECT_EQ(fly(GetParam(), 1).hash, first.hash);
  EXPECT_EQ(first.figures.resets, 0U);
  EXPECT_EQ(first.figures.uart_lost, 0U);
  EXPECT_LE(first.figures.stack_bytes, 8192U);
  EXPECT_GE(first.figures.stack_bytes, 256U) << "painted and looked at";
  EXPECT_GT(first.figures.armed_us, 30e6);
  EXPECT_GE(first.figures.slept_us, 0.93 * first.figures.armed_us);
  EXPECT_LE(first.figures.slept_us, 0.99 * first.figures.armed_us) << "it works";
  // 15 bytes at 8 MHz, or 34 at 1 MHz, are on the wire for 15 or 272 us of it.
  const bool slow_bus = std::string(GetParam()) == "varmint";
  EXPECT_GT(first.figures.imu_to_output_us, slow_bus ? 272U : 15U);
  EXPECT_LE(first.figures.imu_to_output_us, slow_bus ? 400U : 120U);
  EXPECT_GT(first.figures.transfer_to_output_us, 5U) << "it is computed meanwhile";
  EXPECT_LE(first.figures.transfer_to_output_us, 60U);
  EXPECT_GT(first.figures.stamp_error_us, 0.0) << "stamps have whole microseconds";
  EXPECT_LE(first.figures.stamp_error_us, 2.0);
  // 1000 steps a second, 400 commands, and samples of the other sensors; not one for each sample of a gyro at 2 kHz
  // and each reading of a pressure at 500 Hz.
  ASSERT_TRUE(first.counters.has_value());
  const double passes_Hz = first.counters->passes / first.time_s;
  EXPECT_GT(passes_Hz, 1000.0);
  EXPECT_LT(passes_Hz, 1700.0);
}

TEST_P(EachImage, FliesOverUsbAndSurvivesAPulledCable) {
  FlightChoice choice = on_board({"link_cut@20:3"}, GetParam());
  choice.link = "usb";
  Rig rig{choice};
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
  EXPECT_EQ(chip_of(rig).figures()->resets, 0U);
  EXPECT_LT(rig.flight->tracking().rms(), kTracking95_m);
  const auto& streams = rig.flight->session().streams();
  const double on_usb_s = sim::to_seconds(rig.flight->now()) - 0.5 - 3.0;
  EXPECT_GT(static_cast<double>(streams.baro.count), 0.95 * 47.0 * on_usb_s)
      << "all of it went over USB: a sample of the barometer comes every 21 ms";
}

TEST_P(EachImage, DatesSolutionsOfSatellitesByTheirPulse) {
  Rig rig{on_board({}, GetParam())};
  rig.run_for(6.0);
  const link::Gnss& gnss = rig.flight->session().streams().gnss.value;
  const std::int64_t start_s = rig.flight->setup().vehicle.environment().start_unix_s;
  const std::int64_t valid_us = (gnss.unix_s - start_s) * 1'000'000 + gnss.unix_ns / 1000;
  EXPECT_GT(valid_us, 5'000'000);
  const std::int64_t stamp_us =
      static_cast<std::int64_t>(gnss.time_boot_us) + rig.flight->autopilot().boot_time().count();
  EXPECT_NEAR(static_cast<double>(stamp_us - valid_us), 0.0, 5.0);
}

TEST_P(EachImage, MeasuresTheBatteryThroughItsDivider) {
  Rig rig{on_board({}, GetParam())};
  rig.run_for(4.0);
  const auto& battery = rig.flight->session().streams().battery;
  ASSERT_GT(battery.count, 5U);
  const hal::BatterySample& world = chip_of(rig).process().to_chip().battery;
  ASSERT_GT(world.voltage_V, 5.0F);
  // 16 bits of 3.28 V behind the divider are 0.7 mV; the filter of the core is slower than the load.
  EXPECT_NEAR(battery.value.voltage_V, world.voltage_V, 0.1);
}

TEST_P(EachImage, FliesOnDshot) {
  FlightChoice choice = on_board({}, GetParam());
  choice.mission = "hop";
  for (const char* const channel : {"0", "1", "2", "3"}) {
    choice.overrides.push_back(std::string("firmware.PRI_MIXER_PWM_") + channel + "=300000");
  }
  Rig rig{choice};
  std::string notes;
  rig.flight->runner().set_notify([&notes](const FlightNote& note) { notes += note.text + "\n"; });
  rig.run_until(12.0);
  // In steps of a throttle of 11 bits; pulses would be finer.
  const float step = 2000.0F * chip_of(rig).process().from_chip().outputs[0];
  EXPECT_GT(step, 100.0F);
  EXPECT_NEAR(step, std::round(step), 1e-2);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
  EXPECT_NE(notes.find("PRI_MIXER_PWM: board cannot give all rates"), std::string::npos)
      << "while some channels of the timer still had the former rate";
}

TEST(PixracerPro, AnotherSeedIsAnotherFlight) {
  Rig one{on_board()};
  FlightChoice choice = on_board();
  choice.seed = 2;
  Rig two{choice};
  one.run_for(9.0);  // in the air
  two.run_for(9.0);
  EXPECT_NE(one.flight->truth().body.p_W, two.flight->truth().body.p_W);
}

TEST(PixracerPro, CutLinkIsSurvived) {
  Rig rig{on_board({"link_cut@20:0.3"})};
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
}

/// Whether the core has an IMU sample of the time after a reset in flight.
bool samples_again(Rig& rig) {
  const std::int64_t stamp_us = chip_of(rig).process().from_chip().firmware.imu_stamp_us;
  return stamp_us > 0 && stamp_us < 1'000'000;
}

/// A bus error in the driver of the IMU, or an interrupt that never ends: record, reset, armed again.
using Trouble = std::tuple<const char*, Breakdown>;
class HardwareTrouble : public ::testing::TestWithParam<Trouble> {};
TEST_P(HardwareTrouble, LeavesARecordResetsAndRearms) {
  const auto [board, kind] = GetParam();
  Rig rig{on_board({}, board)};
  std::string notes;
  rig.flight->runner().set_notify(
      [&notes](const FlightNote& note) { notes += note.source + ": " + note.text + "\n"; });
  rig.run_until(kFault_s);
  ASSERT_TRUE(view_of(rig).armed);
  const double height_m = rig.height_m();
  rig.flight->autopilot().break_down(rig.flight->now(), kind);
  while (chip_of(rig).figures()->resets == 0 &&
         sim::to_seconds(rig.flight->now()) < kFault_s + 0.2) {
    rig.flight->step();
  }
  EXPECT_EQ(chip_of(rig).figures()->resets, 1U);
  const sim::Time reset = rig.flight->now();
  while (!samples_again(rig) && rig.flight->now() < reset + sim::Time{500'000}) rig.flight->step();
  EXPECT_LE(sim::to_seconds(rig.flight->now() - (reset - Flight::kStep)), 0.020)
      << "first IMU sample; the reset was within the step before";
  while (chip_of(rig).process().from_chip().outputs[0] == 0.0F &&
         rig.flight->now() < reset + sim::Time{500'000}) {
    rig.flight->step();
  }
  EXPECT_LE(sim::to_seconds(rig.flight->now() - reset), 0.040) << "motors run again";
  rig.run_for(0.5);
  EXPECT_GT(rig.flight->autopilot().boot_time(), at_s(kFault_s));
  EXPECT_TRUE(view_of(rig).armed);
  rig.run_for(1.0);
  EXPECT_LT(rig.tilt_deg(), 30.0);
  EXPECT_NEAR(rig.height_m(), height_m, 1.5);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
  EXPECT_NE(notes.find("Rearmed after a fault in flight"), std::string::npos) << notes;
  EXPECT_NE(notes.find("Fault 1 at pc "), std::string::npos) << notes;
  EXPECT_EQ(chip_of(rig).figures()->resets, 1U);
}
INSTANTIATE_TEST_SUITE_P(Kinds, HardwareTrouble,
                         ::testing::Values(Trouble{"pixracer_pro", Breakdown::kCrash},
                                           Trouble{"pixracer_pro", Breakdown::kHang},
                                           Trouble{"varmint", Breakdown::kCrash},
                                           Trouble{"varmint", Breakdown::kHang}));

/// Sets a parameter, and stores it.
void store(Rig& rig, double value) {
  auto& session = rig.flight->session();
  auto set = session.parameters().set("FILT_ACC_KP", value);
  rig.run_for(0.5);
  ASSERT_FALSE(set.pending());
  auto stored = session.commands().start(link::Command::kWriteParams);
  rig.run_for(1.0);
  ASSERT_FALSE(stored.pending() || stored.failed()) << stored.text();
}

double stored_value_after_power_loss(Rig& rig) {
  rig.flight->autopilot().break_down(rig.flight->now(), Breakdown::kPowerLoss);
  rig.run_for(1.5);
  auto& session = rig.flight->session();
  auto read = session.parameters().read("FILT_ACC_KP");
  rig.run_for(1.0);
  EXPECT_FALSE(read.pending());
  return session.parameters().get("FILT_ACC_KP")->number();
}

TEST_P(EachImage, AParameterSurvivesThePower) {
  Rig rig{on_board({}, GetParam())};
  ASSERT_TRUE(rig.reach(Stage::kConfigure));
  rig.flight->runner().set_notify(nullptr);
  rig.run_for(0.5);
  store(rig, 0.875);
  EXPECT_EQ(stored_value_after_power_loss(rig), 0.875);
}

TEST(Varmint, DamagedWordsOfTheFlashCostNeitherTheStartNorTheParameters) {
  Rig rig{on_board({}, "varmint")};
  ASSERT_TRUE(rig.reach(Stage::kConfigure));
  rig.flight->runner().set_notify(nullptr);
  rig.run_for(0.5);
  store(rig, 0.875);
  chip_of(rig).inject(boards::stm32h7::HardwareFault::kDamagedFlash);
  rig.run_for(0.1);
  EXPECT_EQ(stored_value_after_power_loss(rig), 0.875) << "from the second copy";
  EXPECT_EQ(chip_of(rig).figures()->resets, 0U);
}

/// The wiring of the emulated board is checked with every transfer of a bus.
TEST(Varmint10X, FliesTheDefaultMissionWithTheBarometerOnABusOfItsOwn) {
  Rig rig{on_board({}, "varmint_10x")};
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
  EXPECT_LT(rig.flight->tracking().rms(), kTracking95_m);
  EXPECT_EQ(chip_of(rig).figures()->resets, 0U);
  EXPECT_EQ(view_of(rig).errors, 0U);
}

}  // namespace
}  // namespace rosflight::flight::testing
