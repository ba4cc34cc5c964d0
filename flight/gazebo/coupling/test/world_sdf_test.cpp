// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gazebo/coupling/world_sdf.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "flight/gazebo/test/gazebo_rig.hpp"

namespace rosflight::flight::gazebo {
namespace {

std::string world_of(const std::string& vehicle, PluginElements elements = {},
                     const std::string& release = "fortress") {
  elements.emplace_back("vehicle", "vehicles/" + vehicle + ".yaml");
  return world_sdf(sim::Vehicle::from_file("vehicles/" + vehicle + ".yaml"), vehicle,
                   {release, elements});
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(WorldSdf, HasTheStepOfTheFirmwareAndTheGravityOfTheVehicleFile) {
  const std::string world = world_of("multirotor");
  EXPECT_TRUE(has(world, "<max_step_size>0.0025</max_step_size>"));
  EXPECT_TRUE(has(world, "<gravity>0 0 -9.80665</gravity>"));
  EXPECT_TRUE(has(world, "<latitude_deg>40.24637"));
}

TEST(WorldSdf, IsPacedByTheWrenchesOrByTheWallClock) {
  EXPECT_TRUE(has(world_of("multirotor"), "<real_time_factor>0</real_time_factor>"));
  EXPECT_TRUE(has(world_of("multirotor", {{"mode", "whole_loop"}}),
                  "<real_time_factor>1</real_time_factor>"));
}

TEST(WorldSdf, NamesTheSystemsAsTheReleaseDoes) {
  EXPECT_TRUE(has(world_of("multirotor"),
                  "filename=\"ignition-gazebo-physics-system\" "
                  "name=\"ignition::gazebo::systems::Physics\""));
  for (const char* release : {"harmonic", "jetty"})
    EXPECT_TRUE(has(world_of("multirotor", {}, release),
                    "filename=\"gz-sim-physics-system\" name=\"gz::sim::systems::Physics\""));
  EXPECT_THROW(world_of("multirotor", {}, "classic"), config::Error);
}

TEST(WorldSdf, EscapesWhatXmlWouldTakeForItsOwn) {
  EXPECT_TRUE(has(world_of("multirotor", {{"namespace", "/a<b&c"}}), "/a&lt;b&amp;c"));
}

TEST(WorldSdf, RejectsElementsThatThePluginWouldReject) {
  EXPECT_THROW(world_of("multirotor", {{"mode", "both"}}), config::Error);
}

class WorldSdfFiles : public WithGazebo {};

TEST_F(WorldSdfFiles, AreReadByTheParserOfGazebo) {
  for (const char* vehicle : {"multirotor", "anaconda", "aerosonde", "quadplane"}) {
    const std::string file = testing::TempDir() + "/" + vehicle + "_world.sdf";
    std::ofstream(file) << world_of(vehicle);
    EXPECT_EQ(
        std::system(
            (GazeboEngine::Options::program_of_project().string() + " --check " + file).c_str()),
        0)
        << vehicle;
  }
}

}  // namespace
}  // namespace rosflight::flight::gazebo
