// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "flight/flight_recorder.hpp"
#include "flight/fly.hpp"
#include "flight/test/flight_rig.hpp"

namespace rosflight::flight::testing {
namespace {

namespace fs = std::filesystem;

class FlightFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              (std::string("rosflight_") +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  log::LogSummary logged(const FlightChoice& choice, const char* name) {
    fs::create_directories(folder_);
    Rig rig(choice);
    FlightRecorder recorder(*rig.flight, folder_ / name);
    rig.flight->run();
    return *recorder.close();
  }

  fs::path folder_;
};

TEST_F(FlightFolder, SameSeedGivesTheSameBytesAnotherSeedOthers) {
  const auto first = logged(FlightChoice{}, "a.mcap");
  const auto again = logged(FlightChoice{}, "b.mcap");
  EXPECT_EQ(first.sha256, again.sha256);
  EXPECT_EQ(first.messages, again.messages);
  FlightChoice other;
  other.seed = 2;
  EXPECT_NE(logged(other, "c.mcap").sha256, first.sha256);
}

/// Somebody changes the throttle's meaning after the vehicle's parameters were loaded.
TEST(MotorParameters, OthersThanTheVehicleFilesKeepItOnTheGround) {
  Rig rig{FlightChoice{}};
  std::optional<companion::Job<companion::ParameterResult>> sent;
  rig.flight->set_script([&](Flight& flight, sim::Time) {
    if (flight.runner().stage() != Stage::kStore || sent) return;
    sent = flight.session().parameters().set("RC_MAX_THR", 0.2);
  });
  rig.flight->run();
  EXPECT_EQ(rig.flight->runner().stage(), Stage::kFailed);
  EXPECT_EQ(rig.flight->runner().failure(),
            "no take-off: the firmware has other motor parameters than the vehicle file: "
            "RC_MAX_THR 0.2 instead of 0.7");
  EXPECT_TRUE(rig.flight->truth().on_ground);
}

/// A waypoint on the map is flown to on the map: the estimate counts from the mission's origin, not
/// from where the first fixes place the vehicle.
TEST_F(FlightFolder, AMissionWithLatitudesCountsFromTheOriginOfTheMap) {
  fs::create_directories(folder_);
  const fs::path mission = folder_ / "geodetic.yaml";
  Rig local{FlightChoice{}};
  const sim::Geodetic& home = local.setup->vehicle.environment().origin;
  std::ofstream(mission) << "mission:\n  - {type: goto, use_lla: true, w: ["
                         << fmt::format("{:.9f}, {:.9f}, {:.3f}", home.latitude_deg + 1e-4,
                                        home.longitude_deg, home.altitude_m + 4.0)
                         << "], psi: 0}\n";
  FlightChoice choice;
  choice.mission = mission.string();
  Rig rig(choice);
  EXPECT_NEAR(rig.setup->waypoints.front().p_W.x(), 11.1, 0.1);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
  ASSERT_TRUE(rig.flight->estimate_source().origin());
  EXPECT_EQ(rig.flight->estimate_source().origin()->latitude_deg, home.latitude_deg);
  EXPECT_EQ(rig.flight->estimate_source().origin()->longitude_deg, home.longitude_deg);
  local.reach(Stage::kFly);
  ASSERT_TRUE(local.flight->estimate_source().origin());
  EXPECT_NE(local.flight->estimate_source().origin()->latitude_deg, home.latitude_deg);
}

TEST_F(FlightFolder, LogDoesNotDependOnWhereTheProgramRuns) {
  const auto here = logged(FlightChoice{}, "a.mcap");
  const fs::path before = fs::current_path();
  fs::current_path(fs::temp_directory_path());
  const auto there = logged(FlightChoice{}, "b.mcap");
  fs::current_path(before);
  EXPECT_EQ(here.sha256, there.sha256);
}

TEST_F(FlightFolder, HoldsEverythingAndSaysHowItWent) {
  FlyOptions options;
  options.folder = folder_;
  const FlightSummary summary = fly(options);
  EXPECT_TRUE(summary.score.success()) << summary.score.verdict;
  const std::string json = summary_json(summary);
  for (const char* name : {"flight.mcap", "summary.json", "analysis.json", "preflight.json",
                           "vehicle.yaml", "mission.yaml", "parameters.yaml"}) {
    EXPECT_GT(fs::file_size(folder_ / name), 100U) << name;
  }
  for (const auto& entry : fs::directory_iterator(folder_)) {
    EXPECT_NE(entry.path().extension(), ".part") << entry.path();
    EXPECT_NE(entry.path().filename(), "report.mcap");
  }
  for (const char* key : {"\"success\":true", "\"sim_time_s\"", "\"wall_time_s\"",
                          "\"realtime_factor\"", "\"waypoints_total\":7", "\"waypoints_reached\":7",
                          "\"tracking_rms_m\"", "\"tracking_max_m\"", "\"landed\":true",
                          "\"disarmed\":true", "\"log\"", "\"log_sha256\"", "\"seed\":1"}) {
    EXPECT_NE(json.find(key), std::string::npos) << key << " in " << json;
  }
}

TEST_F(FlightFolder, ThatIsNotEmptyIsRefusedAndKept) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / "mine.txt") << "precious";
  FlyOptions options;
  options.folder = folder_;
  EXPECT_THROW(static_cast<void>(fly(options)), config::Error);
  EXPECT_EQ(fs::file_size(folder_ / "mine.txt"), 8U);
  EXPECT_FALSE(fs::exists(folder_ / "flight.mcap.part"));
}

TEST_F(FlightFolder, SaysThatTheMissionFailed) {
  FlyOptions options;
  options.folder = folder_;
  options.choice.faults = {"motor0_dead@20"};
  const FlightSummary summary = fly(options);
  EXPECT_FALSE(summary.score.success());
  EXPECT_NE(summary.score.verdict.find("came down in flight"), std::string::npos)
      << summary.score.verdict;
  EXPECT_TRUE(fs::exists(folder_ / "analysis.json"));
}

TEST(Flight, LosesNoByteOnTheCableAndAllocatesItsParametersOnce) {
  Rig rig(FlightChoice{});
  rig.flight->run();
  ASSERT_TRUE(rig.completed());
  EXPECT_EQ(rig.flight->session().statistics().frames.frames_dropped, 0U);
  EXPECT_EQ(rig.flight->session().statistics().frames.sequence_gaps, 0U);
  EXPECT_EQ(rig.flight->session().parameters().table().values().size(), core::kParamCount);
  EXPECT_FALSE(rig.firmware().parameters().unsaved());
}

TEST(Flight, OverLeanFindsTheBoardByItselfAndLosesNoByte) {
  FlightChoice choice;
  choice.link_protocol = "lean";
  Rig rig(choice);
  rig.flight->run();
  ASSERT_TRUE(rig.completed());
  EXPECT_LT(rig.flight->own_tracking().rms(), 0.3);
  EXPECT_EQ(rig.flight->session().statistics().frames.frames_dropped, 0U);
  EXPECT_EQ(rig.flight->session().statistics().frames.sequence_gaps, 0U);
  EXPECT_EQ(rig.flight->session().parameters().table().values().size(), core::kParamCount);
}

TEST_F(FlightFolder, OverLeanIsRepeatableAndDecodedInTheLog) {
  FlightChoice choice;
  choice.link_protocol = "lean";
  const auto first = logged(choice, "a.mcap");
  const auto again = logged(choice, "b.mcap");
  const auto mavlink = logged(FlightChoice{}, "c.mcap");
  EXPECT_EQ(first.sha256, again.sha256);
  EXPECT_NE(first.sha256, mavlink.sha256);
  // Every frame is in the log raw and, if it is understood, as a message.
  EXPECT_NEAR(static_cast<double>(first.messages), static_cast<double>(mavlink.messages),
              0.01 * static_cast<double>(mavlink.messages));
}

struct BadChoice {
  const char* what;
  FlightChoice choice;
  const char* message;
};
class BadInput : public ::testing::TestWithParam<BadChoice> {};
TEST_P(BadInput, GivesOneLine) {
  try {
    const FlightSetup setup(GetParam().choice);
    const Flight flight(setup);
    FAIL() << "was accepted";
  } catch (const config::Error& e) {
    const std::string text = e.what();
    EXPECT_NE(text.find(GetParam().message), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
}
FlightChoice set(const char* text) {
  FlightChoice choice;
  choice.overrides = {text};
  return choice;
}
FlightChoice vehicle(const char* name) {
  FlightChoice choice;
  choice.vehicle = name;
  return choice;
}
FlightChoice mission(const char* name) {
  FlightChoice choice;
  choice.mission = name;
  return choice;
}
FlightChoice fault(const char* text) {
  FlightChoice choice;
  choice.faults = {text};
  return choice;
}
FlightChoice wind(const char* text) {
  FlightChoice choice;
  choice.wind = text;
  return choice;
}
FlightChoice visualiser(const char* name) {
  FlightChoice choice;
  choice.visualisers = {name};
  return choice;
}
FlightChoice plugin(const char* text) {
  FlightChoice choice;
  choice.plugins = {text};
  return choice;
}
INSTANTIATE_TEST_SUITE_P(
    Choices, BadInput,
    ::testing::Values(
        BadChoice{"unknown vehicle", vehicle("zeppelin"), "zeppelin"},
        BadChoice{"missing vehicle file", vehicle("./nowhere.yaml"), "nowhere.yaml"},
        BadChoice{"unknown mission", mission("moon"), "allowed a file or"},
        BadChoice{"missing mission file", mission("./nowhere.yaml"), "nowhere.yaml"},
        BadChoice{"unknown key", set("vehicle.body.colour=red"), "colour"},
        BadChoice{"wrong type", set("vehicle.body.mass_kg=heavy"), "mass_kg"},
        BadChoice{"out of range", set("vehicle.body.mass_kg=-1"), "mass_kg"},
        BadChoice{"no assignment", set("vehicle.body"), "body"},
        BadChoice{"unknown firmware parameter", set("vehicle.firmware.PID_ROLL=1"), "PID_ROLL"},
        BadChoice{"firmware parameter out of range", set("vehicle.firmware.PRIMARY_MIXER=99"),
                  "PRIMARY_MIXER"},
        BadChoice{"firmware parameter of the wrong type", set("vehicle.firmware.PRIMARY_MIXER=1.5"),
                  "whole number"},
        BadChoice{"unknown fault", fault("gremlin@3"), "gremlin"},
        BadChoice{"fault without time", fault("imu"), "imu"},
        BadChoice{"fault of a motor that is not there", fault("motor4_dead@3"),
                  "found motor 4, allowed 0 to 3"},
        BadChoice{"wind", wind("gale"), "--wind"},
        BadChoice{"unknown sensors module", set("vehicle.sensors.module=crystal_ball"),
                  "allowed standard"},
        BadChoice{"unknown visualiser", visualiser("tarot"), "visualiser: found tarot"},
        BadChoice{"missing plugin", plugin("./libnothing.so"), "libnothing.so"}),
    [](const auto& choice) {
      std::string name;
      for (const char c : std::string(choice.param.what)) name += c == ' ' ? '_' : c;
      return name;
    });

}  // namespace
}  // namespace rosflight::flight::testing
