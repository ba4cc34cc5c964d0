// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "flight/flight_setup.hpp"
#include "flight/gazebo/gazebo_engine.hpp"

namespace rosflight::flight {

/// What tests with Gazebo's engine share. They are skipped where gazebo_engine is not built, which needs packages
/// that no other part needs: tools/ready.sh packages gazebo, tools/ready.sh build gazebo gazebo_engine.
class WithGazebo : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(GazeboEngine::Options::program_of_project()))
      GTEST_SKIP() << "gazebo_engine is not built";
  }
};

/// A body of 2 kg without anything that collides, in forward-left-up axes.
/// @param inertia  elements of SDF.
inline std::string box_sdf(
    const std::string& inertia = "<ixx>0.08</ixx><iyy>0.10</iyy><izz>0.15</izz>",
    const std::string& shapes = "") {
  return "<sdf version='1.9'><model name='vehicle'><link "
         "name='base_link'><inertial><mass>2</mass><inertia>" +
         inertia + "</inertia></inertial>" + shapes + "</link></model></sdf>";
}

/// What an engine with these options says when it starts or is used; "none": nothing.
inline std::string gazebo_complaint(const GazeboEngine::Options& options,
                                    const std::function<void(GazeboEngine&)>& use = {},
                                    const std::string& model = box_sdf()) {
  try {
    GazeboEngine engine(model, 9.80665, options);
    if (use) use(engine);
  } catch (const boards::EmulatorError& error) {
    return error.what();
  }
  return "none";
}

inline constexpr const char* kField = "flight/gazebo/test/worlds/field.sdf";
inline constexpr double kWeight = 2.0 * 9.80665;  ///< Weight of the body above [N].

/// A box of 0.4 m x 0.4 m x 0.2 m with the gear's name: its contacts are none of the airframe.
inline std::string crate(const std::string& name = "contact_0") {
  return box_sdf("<ixx>0.033</ixx><iyy>0.033</iyy><izz>0.053</izz>",
                 "<collision name='" + name +
                     "'><geometry><box><size>0.4 0.4 0.2</size></box></geometry></collision>");
}

inline GazeboEngine::Options field(const std::string& world = kField) {
  GazeboEngine::Options options = GazeboEngine::Options::of_project();
  options.world_file = world;
  return options;
}

inline sim::BodyState at(double north_m, double east_m, double height_m,
                         const sim::Vector3& v_B = sim::Vector3::Zero()) {
  sim::BodyState state;
  state.p_W = {north_m, east_m, -height_m};
  state.v_B = v_B;
  return state;
}

/// A file of this test with this text. @param name  with folders.
inline std::string test_file(const std::string& name, const std::string& text) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) /
                                     testing::UnitTest::GetInstance()->current_test_info()->name() /
                                     name;
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file) << text;
  return file;
}

inline std::string world_file(const std::string& text) {
  return test_file("world.sdf", text);
}

inline std::string in_world(const std::string& text) {
  return world_file("<sdf version='1.9'><world name='w'>" + text + "</world></sdf>");
}

/// A link with one shape. @param geometry  as SDF.
inline std::string shape(const std::string& geometry) {
  return "<link name='l'><collision name='c'><geometry>" + geometry +
         "</geometry></collision></link>";
}

/// A body of one static shape. @param pose  six numbers.
inline std::string solid(const std::string& name, const std::string& pose,
                         const std::string& geometry) {
  return "<model name='" + name + "'><static>true</static><pose>" + pose + "</pose>" +
         shape(geometry) + "</model>";
}

inline std::string plane(const std::string& pose = "0 0 0 0 0 0") {
  return solid("ground", pose, "<plane><normal>0 0 1</normal></plane>");
}

/// A square of 60 m at z = 0.
inline constexpr const char* kSquareObj =
    "v -30 -30 0\nv 30 -30 0\nv 30 30 0\nv -30 30 0\nf 1 2 3\nf 1 3 4\n";

inline FlightChoice hop_in(const std::string& world) {
  FlightChoice choice;
  choice.physics = "gazebo";
  choice.mission = "hop";
  choice.world = world;
  return choice;
}

}  // namespace rosflight::flight
