// SPDX-License-Identifier: BSD-3-Clause
// Faults in flight on the images of the boards with an STM32H7, emulated: what docs/faults.md says of them. Each flight is short: they
// begin in the middle of the mission hop.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "flight/test/h7_rig.hpp"

namespace rosflight::flight::testing {
namespace {

using Breakdown = Autopilot::Breakdown;

constexpr double kFault_s = 10.5;  // at 3 m, on the way to the first waypoint

FlightChoice hop(const std::string& board, std::vector<std::string> faults = {}) {
  FlightChoice choice = on_board(std::move(faults), board);
  choice.mission = "hop";
  return choice;
}

class EachImage : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Boards, EachImage, ::testing::Values("pixracer_pro", "varmint"),
                         [](const auto& board) { return std::string(board.param); });

/// A sensor that falls silent on its bus for five seconds: the others carry the flight.
struct Sensor {
  const char* fault;
  const char* name;  ///< In the firmware's texts.
  std::uint64_t (*samples)(const companion::Streams& streams);
};
void PrintTo(const Sensor& sensor, std::ostream* out) {
  *out << sensor.fault;
}
constexpr Sensor kSensors[] = {
    {"baro", "baro", [](const companion::Streams& s) { return s.baro.count; }},
    {"mag", "mag", [](const companion::Streams& s) { return s.mag.count; }},
    {"diff_pressure", "airspeed",
     [](const companion::Streams& s) { return s.diff_pressure.count; }},
    {"gnss", "GNSS", [](const companion::Streams& s) { return s.gnss.count; }},
};

class SilentSensor : public ::testing::TestWithParam<std::tuple<const char*, Sensor>> {};
INSTANTIATE_TEST_SUITE_P(Sensors, SilentSensor,
                         ::testing::Combine(::testing::Values("pixracer_pro", "varmint"),
                                            ::testing::ValuesIn(kSensors)),
                         [](const auto& flown) {
                           return std::string(std::get<0>(flown.param)) + "_" +
                                  std::get<1>(flown.param).fault;
                         });

/// RMS of the horizontal distance from the setpoint [m], by the vehicle's own position, of a hop without faults in process.
double nominal_rms_m() {
  static const double rms_m = [] {
    FlightChoice choice;
    choice.mission = "hop";
    choice.overrides = {"sensors.range.enabled=false"};  // the boards have none
    Rig rig{choice};
    rig.flight->run();
    EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
    return rig.flight->own_tracking().rms();
  }();
  return rms_m;
}

/// Names of the sensors that fall silent with one: on the Pixracer Pro a magnetometer that is stuck holds the bus of the pitot sensor.
std::vector<std::string> silent_with(const std::string& board, const Sensor& sensor) {
  std::vector<std::string> names{sensor.name};
  if (board == "pixracer_pro" && names[0] == "mag") names.emplace_back("airspeed");
  return names;
}

std::size_t count_of(const std::string& notes, const std::string& text) {
  std::size_t count = 0;
  for (std::size_t at = notes.find(text); at != std::string::npos; at = notes.find(text, at + 1))
    ++count;
  return count;
}

TEST_P(SilentSensor, IsReportedAndTheMissionGoesOn) {
  constexpr double kLasts_s = 5.0;
  const auto [board, sensor] = GetParam();
  const std::vector<std::string> silent = silent_with(board, sensor);
  Rig rig{hop(board, {std::string(sensor.fault) + "@10.5:5"})};
  std::string notes;
  rig.flight->runner().set_notify([&notes](const FlightNote& note) { notes += note.text + "\n"; });
  unsigned errors = 0;
  double tilt_deg = 0.0;
  rig.flight->set_script([&](Flight& flight, sim::Time) {
    if (flight.runner().stage() != Stage::kFly) return;
    errors |= view_of(rig).errors;
    tilt_deg = std::max(tilt_deg, rig.tilt_deg());
  });
  const auto samples = [&rig, &sensor = sensor] {
    return sensor.samples(rig.flight->session().streams());
  };
  rig.run_until(kFault_s);
  const std::uint64_t before = samples();
  ASSERT_GT(before, 10U);
  EXPECT_EQ(notes.find("Sensor silent"), std::string::npos) << notes;
  // The part is mute when the world has had no sample of it for 0.3 s.
  rig.run_until(kFault_s + 0.5);
  const std::uint64_t last = samples();
  rig.run_until(kFault_s + kLasts_s - 0.1);
  EXPECT_EQ(samples(), last) << "the stream stops";
  for (const std::string& name : silent)
    EXPECT_EQ(count_of(notes, "Sensor silent: " + name + "\n"), 1U) << notes;
  EXPECT_EQ(notes.find("Sensor answers again"), std::string::npos) << notes;
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
  EXPECT_GT(samples(), last + 20U) << "and goes on";
  EXPECT_EQ(count_of(notes, "Sensor silent"), silent.size()) << notes;
  for (const std::string& name : silent)
    EXPECT_EQ(count_of(notes, "Sensor answers again: " + name + "\n"), 1U) << notes;
  EXPECT_EQ(errors, 0U);
  EXPECT_LT(rig.flight->own_tracking().rms(), nominal_rms_m() + 0.2);
  EXPECT_LT(tilt_deg, 45.0);
  EXPECT_EQ(chip_of(rig).figures()->resets, 0U);
}

TEST_P(EachImage, RadioLossIsFailsafeThenTheMissionGoesOn) {
  Rig rig{hop(GetParam(), {"rc_silence@10.5:2"})};
  rig.run_until(kFault_s + 0.225);
  EXPECT_TRUE(view_of(rig).failsafe);
  rig.run_until(kFault_s + 2.0 + 0.05);
  EXPECT_FALSE(view_of(rig).failsafe);
  rig.flight->run();
  EXPECT_TRUE(rig.completed());
}

TEST_P(EachImage, ImuWithoutEdgesHoldsTheOutputsThenFallsWithMotorsOffAndStaysArmed) {
  Rig rig{hop(GetParam(), {"imu@10.5"})};
  const auto motor = [&rig] { return chip_of(rig).process().from_chip().outputs[0]; };
  rig.run_until(kFault_s + 0.13);
  EXPECT_NE(view_of(rig).errors & static_cast<unsigned>(core::Error::kImuNotResponding), 0U);
  const float held = motor();
  EXPECT_GT(held, 0.0F);
  rig.run_until(kFault_s + 0.29);
  EXPECT_EQ(motor(), held);
  rig.run_until(kFault_s + 0.34);
  EXPECT_EQ(motor(), 0.0F);
  EXPECT_TRUE(view_of(rig).armed);
}

/// A receiver on the same pin that speaks CRSF.
TEST_P(EachImage, FliesWithCrsfAndItsLinkQualityIsTheSignalStrength) {
  FlightChoice choice = hop(GetParam(), {"rc_silence@10.5:2"});
  choice.overrides = {"firmware.RC_TYPE=2"};
  Rig rig{choice};
  rig.run_until(kFault_s - 1.0);
  EXPECT_TRUE(view_of(rig).armed);
  EXPECT_EQ(rig.flight->session().streams().rc.value.rssi, 80 * 254 / 100);
  rig.run_until(kFault_s + 0.225);
  EXPECT_TRUE(view_of(rig).failsafe);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
}

TEST_P(EachImage, PowerLossInFlightDoesNotRearm) {
  Rig rig{hop(GetParam())};
  rig.run_until(kFault_s);
  ASSERT_TRUE(view_of(rig).armed);
  rig.flight->autopilot().break_down(rig.flight->now(), Breakdown::kPowerLoss);
  rig.run_for(0.5);
  EXPECT_FALSE(view_of(rig).armed) << "backup memory does not survive the power";
}

/// Between the estimated and the true direction of gravity.
double attitude_error_deg(const Rig& rig) {
  const core::Quaternion q = view_of(rig).q_WB;
  const Eigen::Quaterniond estimate(q.w, q.x, q.y, q.z);
  const auto down = sim::Vector3::UnitZ();
  const double c =
      (estimate.conjugate() * down).dot(rig.flight->truth().body.q_WB.conjugate() * down);
  return std::acos(std::min(1.0, c)) * 180.0 / 3.14159265358979323846;
}

/// A hang while the vehicle accelerates, brakes and turns: the attitude goes on from the record, and so
/// does the mission.
using Hang = std::tuple<const char*, double>;
class HangAt : public ::testing::TestWithParam<Hang> {};
TEST_P(HangAt, TiltsTheVehicleNoFurtherThanItsLimit) {
  const auto [board, hang_s] = GetParam();
  Rig rig{on_board({}, board)};
  rig.run_until(hang_s);
  rig.flight->autopilot().break_down(rig.flight->now(), Breakdown::kHang);
  double tilt_deg = 0.0;
  double error_deg = 0.0;
  while (rig.flight->now() < at_s(hang_s + 1.5)) {
    rig.flight->step();
    tilt_deg = std::max(tilt_deg, rig.tilt_deg());
    const bool again = chip_of(rig).figures()->resets > 0;
    if (again && chip_of(rig).process().from_chip().outputs[0] > 0.0F)
      error_deg = std::max(error_deg, attitude_error_deg(rig));
  }
  EXPECT_EQ(chip_of(rig).figures()->resets, 1U);
  EXPECT_TRUE(view_of(rig).armed);
  constexpr double kError_deg = 8.0;
  EXPECT_LT(tilt_deg, 35.0 + kError_deg)
      << "limits.tilt_deg of vehicles/multirotor.yaml, and an error that it cannot know";
  EXPECT_LT(error_deg, kError_deg) << "of roll and pitch";
  EXPECT_TRUE(rig.flight->autonomy().tracking) << "nobody took over";
}
INSTANTIATE_TEST_SUITE_P(Times, HangAt,
                         ::testing::Combine(::testing::Values("pixracer_pro", "varmint"),
                                            ::testing::Values(15.0, 17.5, 22.5, 25.0, 30.0)));

}  // namespace
}  // namespace rosflight::flight::testing
