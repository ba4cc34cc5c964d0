// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "flight/flight.hpp"
#include "flight/gazebo/gazebo_engine.hpp"
#include "flight/gazebo/test/gazebo_rig.hpp"

namespace rosflight::flight {
namespace {

using sim::BodyState;
using sim::Vector3;

class GazeboWorlds : public WithGazebo {};

TEST_F(GazeboWorlds, CarryABodyAtRestWithItsWeight) {
  GazeboEngine engine(crate(), 9.80665, field());
  engine.set_state(at(0.0, 0.0, 0.101));
  for (int k = 0; k < 800; ++k) engine.step(0.0025, {});
  const auto& contact = *engine.contact();
  EXPECT_TRUE(contact.touches);
  EXPECT_FALSE(contact.airframe);
  EXPECT_EQ(contact.other, "ground");
  EXPECT_NEAR(contact.wrench.force_B.z(), -kWeight, 1e-3 * kWeight);
  EXPECT_LT(contact.wrench.torque_B.norm(), 1e-2);
  EXPECT_NEAR(contact.normal_up, 1.0, 1e-6);
  EXPECT_NEAR(-engine.state().p_W.z(), 0.1, 0.006);  // a resting body sinks by some millimetres
}

TEST_F(GazeboWorlds, AnEmptyStepInTheAirHasNoContact) {
  GazeboEngine engine(crate(), 9.80665, field());
  engine.set_state(at(0.0, 0.0, 5.0));
  engine.step(0.0025, {});
  EXPECT_FALSE(engine.contact()->touches);
  EXPECT_EQ(engine.contact()->wrench.force_B, Vector3::Zero());
}

TEST_F(GazeboWorlds, AFrictionOf0p6StopsASlide) {
  GazeboEngine engine(crate(), 9.80665, field());
  engine.set_state(at(0.0, 5.0, 0.1));
  for (int k = 0; k < 100; ++k) engine.step(0.0025, {});
  BodyState sliding = engine.state();
  sliding.v_B = Vector3(0.0, 2.0, 0.0);
  engine.set_state(sliding);
  for (int k = 0; k < 800; ++k) engine.step(0.0025, {});
  // v^2/(2 mu g) = 0.34 m.
  EXPECT_NEAR(engine.state().p_W.y() - sliding.p_W.y(), 2.0 * 2.0 / (2.0 * 0.6 * 9.80665), 0.02);
}

TEST_F(GazeboWorlds, AWallIsHitWithTheSpeedOfFlight) {
  GazeboEngine engine(crate("body"), 9.80665, field());
  engine.set_state(at(17.0, 0.0, 3.0, {6.0, 0.0, 0.0}));
  const sim::PhysicsEngine::Load hover{{0.0, 0.0, -kWeight}, Vector3::Zero()};
  int steps = 0;
  while (!engine.contact()->touches && steps < 1000) {
    engine.step(0.0025, hover);
    ++steps;
  }
  EXPECT_EQ(engine.contact()->other, "house");
  EXPECT_TRUE(engine.contact()->airframe);
  EXPECT_NEAR(engine.contact()->approach_m_s, 6.0, 1e-3);
  EXPECT_NEAR(engine.contact()->normal_up, 0.0, 1e-3);
  EXPECT_NEAR(steps * 0.0025, (20.0 - 17.0 - 0.2) / 6.0, 0.006);
  EXPECT_LT(engine.contact()->wrench.force_B.x(), 0.0);  // pushed back
}

TEST_F(GazeboWorlds, AMeshCarriesToo) {
  GazeboEngine engine(crate(), 9.80665, field());
  // Half way up the hill's northern face, of 4 m in 30 m: 2 m high.
  const double height_m = 2.0 + 0.1;
  engine.set_state(at(-25.0, 0.0, height_m + 0.05));
  for (int k = 0; k < 400; ++k) engine.step(0.0025, {});
  EXPECT_TRUE(engine.contact()->touches);
  EXPECT_EQ(engine.contact()->other, "hill");
  EXPECT_NEAR(-engine.state().p_W.z(), height_m, 0.05);
  EXPECT_NEAR(engine.contact()->normal_up, 30.0 / std::hypot(30.0, 4.0), 0.01);
}

TEST_F(GazeboWorlds, AVehicleInsideAnotherBodyIsOneLine) {
  // In the middle of a house of 6 m: out through the roof are half of it and half of the crate.
  EXPECT_EQ(gazebo_complaint(
                field(), [](GazeboEngine& engine) { engine.set_state(at(24, 0, 3)); }, crate()),
            "--physics gazebo: the vehicle is inside house of the world, 3.10 m deep");
}

TEST_F(GazeboWorlds, ABadFileIsOneLineThatNamesIt) {
  const auto complaint = [](const std::string& file) {
    const std::string said = gazebo_complaint(field(file), {}, crate());
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
    EXPECT_EQ(said.rfind("--physics gazebo: " + file, 0), 0U) << said;
    return said.substr(std::min(said.size(), std::string("--physics gazebo: " + file).size()));
  };
  EXPECT_EQ(complaint("/nowhere/world.sdf"), ": found no such file");
  EXPECT_FALSE(complaint(world_file("<sdf version='1.9'><world name='w'>")).empty());
  EXPECT_FALSE(complaint(world_file("not XML")).empty());
  EXPECT_EQ(
      complaint(world_file("<sdf version='1.9'><model name='a'><link name='b'/></model></sdf>")),
      ": found 0 worlds, allowed 1");
  EXPECT_EQ(complaint(in_world("<model name='vehicle'><link name='b'/></model>")),
            ": found a model vehicle, the name of the vehicle");
  EXPECT_NE(complaint(in_world("<include><uri>model://tree</uri></include>")).find("model://tree"),
            std::string::npos);
  const std::string shape =
      "<model name='m'><static>true</static><link name='l'><collision name='c'><geometry>";
  const std::string end = "</geometry></collision></link></model>";
  EXPECT_NE(complaint(in_world(shape + "<mesh><uri>tree.obj</uri></mesh>" + end)).find("tree.obj"),
            std::string::npos);
}

TEST(Worlds, NeedTheEngineOfGazebo) {
  FlightChoice choice = hop_in(kField);
  choice.physics = "runge_kutta";
  const FlightSetup setup(choice);
  try {
    const Flight flight(setup);
    FAIL();
  } catch (const config::Error& error) {
    EXPECT_EQ(std::string(error.what()), std::string("--world: found ") + kField +
                                             " with --physics runge_kutta, allowed with gazebo or "
                                             "with world_sensors in the vehicle file");
  }
}

}  // namespace
}  // namespace rosflight::flight
