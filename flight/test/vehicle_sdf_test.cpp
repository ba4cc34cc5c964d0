// SPDX-License-Identifier: BSD-3-Clause
#include "flight/vehicle_sdf.hpp"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "sim/vehicle.hpp"

namespace rosflight::flight {
namespace {

std::string sdf_of(const std::string& vehicle, SdfModel model = SdfModel::kWithJoints,
                   const std::vector<std::string>& overrides = {}) {
  return vehicle_sdf(sim::Vehicle::from_file("vehicles/" + vehicle + ".yaml", overrides), vehicle,
                     model);
}

/// What each match of the first group holds.
std::vector<std::string> found(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::vector<std::string> out;
  for (std::sregex_iterator it(text.begin(), text.end(), regex), end; it != end; ++it)
    out.push_back((*it)[1]);
  return out;
}

std::vector<double> numbers(const std::string& text) {
  std::istringstream in(text);
  std::vector<double> out;
  for (double x = 0.0; in >> x;) out.push_back(x);
  return out;
}

/// Each element is closed in the order in which it was opened.
void expect_well_formed(const std::string& xml) {
  const std::regex tag("<(/?)([a-z_0-9]+)([^>]*)>");
  std::vector<std::string> open;
  for (std::sregex_iterator it(xml.begin(), xml.end(), tag), end; it != end; ++it) {
    const std::string name = (*it)[2];
    if ((*it)[1] == "/") {
      ASSERT_FALSE(open.empty());
      ASSERT_EQ(open.back(), name);
      open.pop_back();
    } else if (!(*it)[3].str().ends_with("/")) {
      open.push_back(name);
    }
  }
  EXPECT_TRUE(open.empty());
}

TEST(VehicleSdf, MassesOfAllLinksAddUpToThatOfTheFile) {
  double sum_kg = 0.0;
  for (const std::string& mass : found(sdf_of("multirotor"), "<mass>([^<]*)</mass>"))
    sum_kg += std::stod(mass);
  EXPECT_NEAR(sum_kg, 3.5, 1e-12);
  const auto one = found(sdf_of("multirotor", SdfModel::kOneLink), "<mass>([^<]*)</mass>");
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(std::stod(one.front()), 3.5);
}

TEST(VehicleSdf, InertiaIsTurnedIntoAxesForwardLeftUp) {
  // Rotation by 180 degrees about x: J_xy and J_xz change their sign.
  const std::vector<std::string> overrides{
      "body.inertia_kg_m2.xy=0.01", "body.inertia_kg_m2.xz=-0.02", "body.inertia_kg_m2.yz=0.015"};
  const std::string sdf = sdf_of("multirotor", SdfModel::kOneLink, overrides);
  const sim::Matrix3 J =
      sim::Vehicle::from_file("vehicles/multirotor.yaml", overrides).body().inertia_kg_m2;
  const auto element = [&sdf](const std::string& name) {
    return std::stod(found(sdf, "<" + name + ">([^<]*)<").at(0));
  };
  EXPECT_EQ(element("ixx"), J(0, 0));
  EXPECT_EQ(element("iyy"), J(1, 1));
  EXPECT_EQ(element("izz"), J(2, 2));
  EXPECT_EQ(element("ixy"), -J(0, 1));
  EXPECT_EQ(element("ixz"), -J(0, 2));
  EXPECT_EQ(element("iyz"), J(1, 2));
  EXPECT_NE(J(0, 1), 0.0);
}

TEST(VehicleSdf, SpheresTouchThePointsOfTheGear) {
  const std::string sdf = sdf_of("multirotor");
  const auto poses =
      found(sdf, "<collision name=\"contact_\\d+\"><pose>([^<]*)</pose><geometry><sphere>");
  ASSERT_EQ(poses.size(), 8U);
  // A foot at (0.15, 0.15, 0.2) front-right-down: the lowest point of its sphere is 0.2 m below.
  EXPECT_EQ(numbers(poses[0]), (std::vector<double>{0.15, -0.15, -0.18, 0, 0, 0}));
  // A hub at (0.1768, 0.1768, -0.0762): the highest point.
  EXPECT_EQ(numbers(poses[4]), (std::vector<double>{0.1768, -0.1768, 0.0562, 0, 0, 0}));
}

TEST(VehicleSdf, WheelsRollAlongAndGripAcross) {
  const std::string sdf = sdf_of("anaconda");
  const auto along = found(sdf, "<mu>([^<]*)</mu>");
  const auto across = found(sdf, "<mu2>([^<]*)</mu2>");
  ASSERT_EQ(along.size(), 9U);  // six points, then three wheels
  EXPECT_EQ(along[0], "0.6");
  EXPECT_EQ(along[8], "0.05");
  EXPECT_EQ(across[8], "0.6");
}

TEST(VehicleSdf, EachRotorAndSurfaceHasAJoint) {
  const std::string sdf = sdf_of("anaconda");
  EXPECT_EQ(found(sdf, "<joint name=\"([^\"]*)\"").size(), 4U);
  // The propeller pushes forward: z of its link points along x of the body.
  const auto propeller = numbers(found(sdf, "<link name=\"rotor_0\">\\s*<pose>([^<]*)<").at(0));
  EXPECT_NEAR(propeller[4], 1.5707963267948966, 1e-9);
  EXPECT_NEAR(std::stod(found(sdf, "<upper>([^<]*)<").at(1)), 0.6981317, 1e-6);  // 40 degrees
  EXPECT_TRUE(found(sdf_of("anaconda", SdfModel::kOneLink), "<joint name=\"([^\"]*)\"").empty());
}

TEST(VehicleSdf, AQuadPlaneHasRotorsWingAndSurfaces) {
  const std::string sdf = sdf_of("quadplane");
  const auto wing = found(sdf, "<collision name=\"wing\"><geometry><box><size>([^<]*)</size>");
  ASSERT_EQ(wing.size(), 1U);
  EXPECT_EQ(numbers(wing[0]), (std::vector<double>{0.235, 2.08, 0.01}));
  EXPECT_EQ(found(sdf, "<link name=\"(rotor_\\d)\"").size(), 5U);  // four of them lift, one pushes
  EXPECT_EQ(found(sdf, "<link name=\"(surface_\\d)\"").size(), 3U);
}

TEST(VehicleSdf, IsWellFormedForEveryVehicle) {
  for (const auto& entry : std::filesystem::directory_iterator("vehicles")) {
    if (entry.path().extension() != ".yaml") continue;
    const std::string vehicle = entry.path().stem();
    SCOPED_TRACE(vehicle);
    const std::string sdf = sdf_of(vehicle);
    expect_well_formed(sdf);
    EXPECT_TRUE(sdf.find("nan") == std::string::npos && sdf.find("inf<") == std::string::npos);
  }
}

}  // namespace
}  // namespace rosflight::flight
