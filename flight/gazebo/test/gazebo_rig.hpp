// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>

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

}  // namespace rosflight::flight
