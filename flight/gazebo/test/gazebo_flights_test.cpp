// SPDX-License-Identifier: BSD-3-Clause
// Missions in worlds of SDF.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "flight/flight.hpp"
#include "flight/fly.hpp"
#include "flight/gazebo/test/gazebo_rig.hpp"
#include "flight/repeat.hpp"
#include "flight/vehicle_sdf.hpp"
#include "sim/vehicle.hpp"

namespace rosflight::flight {
namespace {

class GazeboFlights : public WithGazebo {};

TEST_F(GazeboFlights, AMissionIsFlownOverThem) {
  const FlightSetup setup(hop_in(kField));
  Flight flight(setup);
  std::vector<std::string> said;
  flight.runner().set_notify([&](const FlightNote& note) {
    if (note.source == "world") said.push_back(note.text);
  });
  flight.run();
  EXPECT_TRUE(flight.score().success()) << flight.score().verdict;
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].rfind("touches ground at 0.", 0), 0U) << said[0];
}

/// A wall across the path of 4 m to the north.
std::string across_the_path() {
  return in_world(plane() + solid("wall", "0 2.5 5 0 0 0", "<box><size>20 0.5 10</size></box>"));
}

/// Speed in the event of the crash [m/s]; NaN: none.
double crash_speed_m_s(const std::vector<std::string>& overrides) {
  FlightChoice choice = hop_in(across_the_path());
  choice.overrides = overrides;
  const FlightSetup setup(choice);
  Flight flight(setup);
  double speed_m_s = std::nan("");
  flight.runner().set_notify([&](const FlightNote& note) {
    if (note.source != "world" || note.severity != link::Severity::kError) return;
    EXPECT_EQ(note.text.rfind("hit wall at ", 0), 0U) << note.text;
    speed_m_s = std::stod(note.text.substr(std::string("hit wall at ").size()));
  });
  while (!flight.finished() && std::isnan(speed_m_s)) flight.step();
  return speed_m_s;
}

TEST_F(GazeboFlights, ACrashHasTheSameSpeedInSubsteps) {
  const double whole_m_s = crash_speed_m_s({});
  EXPECT_GT(whole_m_s, 1.0);
  EXPECT_NEAR(crash_speed_m_s({"body.max_step_s=0.0005"}), whole_m_s, 0.05);
}

TEST_F(GazeboFlights, AHeldFixedWingStaysOnTheGround) {
  FlightChoice choice = hop_in(in_world(plane()));
  choice.vehicle = "anaconda";
  choice.mission = "default";
  choice.overrides = {"environment.wind.steady_W_m_s=[-6, 0, 0]"};
  const FlightSetup setup(choice);
  Flight flight(setup);
  std::vector<std::string> said;
  flight.runner().set_notify([&](const FlightNote& note) {
    if (note.source == "world") said.push_back(note.text);
  });
  flight.step();
  const sim::Vector3 start = flight.truth().body.p_W;
  while (flight.now() < std::chrono::seconds(10) && flight.autonomy().idle) {
    flight.step();
    ASSERT_EQ(flight.truth().body.p_W, start);
    ASSERT_TRUE(flight.truth().on_ground);
    ASSERT_NEAR(flight.truth().specific_force_B.norm(), 9.80665, 1e-9);
  }
  EXPECT_GT(flight.now(), std::chrono::seconds(5));
  flight.run();
  EXPECT_TRUE(flight.score().success()) << flight.score().verdict;
  for (const std::string& text : said) EXPECT_EQ(text.rfind("touches ground at ", 0), 0U) << text;
}

TEST_F(GazeboFlights, ACrashIsAnEventAndEndsTheMission) {
  const FlightSetup setup(hop_in(across_the_path()));
  Flight flight(setup);
  std::vector<FlightNote> said;
  flight.runner().set_notify([&](const FlightNote& note) {
    if (note.source == "world" && note.severity == link::Severity::kError) said.push_back(note);
  });
  flight.run();
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].text.rfind("hit wall at ", 0), 0U) << said[0].text;
  const FlightScore score = flight.score();
  EXPECT_EQ(score.outcome, Outcome::kCrash);
  EXPECT_EQ(score.verdict, "Crash: " + said[0].text + ".");
  EXPECT_EQ(flight.runner().failure(), "crash: " + said[0].text);
  EXPECT_LT(sim::to_seconds(flight.now() - said[0].t), 31.0);
}

/// Flies it to its end. @returns what is said of the world.
std::vector<std::string> flown(Flight& flight) {
  std::vector<std::string> said;
  flight.runner().set_notify([&](const FlightNote& note) {
    if (note.source == "world") said.push_back(note.text);
  });
  flight.run();
  EXPECT_TRUE(flight.score().success()) << flight.score().verdict;
  return said;
}

TEST_F(GazeboFlights, OnASlopeOfAMesh) {
  // 5 degrees: up to the north by 0.35 m where the hop ends.
  test_file("square.obj", kSquareObj);
  const FlightSetup setup(hop_in(
      in_world(solid("slope", "0 0 0 0.0872665 0 0", "<mesh><uri>square.obj</uri></mesh>"))));
  Flight flight(setup);
  const std::vector<std::string> said = flown(flight);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].rfind("touches slope at 0.", 0), 0U) << said[0];
  // It stands on the slope, at right angles to it.
  const sim::BodyState& body = flight.truth().body;
  const double up = std::acos((body.q_WB * sim::Vector3::UnitZ()).z());
  EXPECT_NEAR(up, 0.0872665, 0.01);
  const double surface_m = body.p_W.x() * std::tan(0.0872665);
  EXPECT_NEAR(-body.p_W.z() - surface_m, 0.2 / std::cos(0.0872665), 0.01);
}

TEST_F(GazeboFlights, OfAQuadPlane) {
  FlightChoice choice = hop_in(in_world(plane()));
  choice.vehicle = "quadplane";
  choice.mission = "default";
  const FlightSetup setup(choice);
  Flight flight(setup);
  for (const std::string& text : flown(flight))
    EXPECT_EQ(text.rfind("touches ground at ", 0), 0U) << text;
}

TEST_F(GazeboFlights, KeepTheirWorldAndAreRepeatedWithNoOther) {
  test_file("square.obj", kSquareObj);
  FlyOptions options;
  options.choice = hop_in(
      in_world(plane() + solid("far", "50 0 0 0 0 0", "<mesh><uri>square.obj</uri></mesh>")));
  const std::string text = read_text(options.choice.world);
  options.folder = std::filesystem::path(options.choice.world).parent_path() / "flight";
  std::filesystem::remove_all(*options.folder);
  const FlightSummary first = fly(options);
  EXPECT_EQ(read_text(first.folder / "world.sdf"), text);
  const RecordedFlight recorded = read_recorded_flight(first.folder);
  EXPECT_EQ(recorded.choice.world, options.choice.world);
  EXPECT_EQ(recorded.choice.world_sha256.size(), 64U);
  const FlightSetup setup(recorded.choice);
  EXPECT_NO_THROW(Flight{setup});
  test_file("square.obj", std::string(kSquareObj) + "# another one\n");
  try {
    const Flight other(setup);
    FAIL();
  } catch (const config::Error& error) {
    EXPECT_EQ(std::string(error.what())
                  .rfind("--repeat: found " + options.choice.world +
                             " or what it refers to with SHA-256 ",
                         0),
              0U)
        << error.what();
  }
}

/// Exit code of gazebo_engine --check for a model.
int checked(const std::string& model) {
  const std::string file = test_file("model.sdf", model);
  const std::string program = GazeboEngine::Options::program_of_project();
  return std::system((program + " --check " + file + " 2> " + file + ".errors").c_str());
}

TEST_F(GazeboFlights, AModelOfEveryVehicleIsAcceptedBySdformat) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("vehicles")) {
    if (entry.path().extension() != ".yaml") continue;
    ++count;
    const sim::Vehicle vehicle = sim::Vehicle::from_file(entry.path());
    EXPECT_EQ(checked(vehicle_sdf(vehicle, "vehicle")), 0) << entry.path();
  }
  EXPECT_GT(count, 10);
  // The inertia of this file is one that no body can have; with joints it is cut.
  const sim::Vehicle anaconda = sim::Vehicle::from_file("vehicles/anaconda.yaml");
  EXPECT_NE(checked(vehicle_sdf(anaconda, "vehicle", SdfModel::kOneLink)), 0);
}

}  // namespace
}  // namespace rosflight::flight
