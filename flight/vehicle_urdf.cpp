// SPDX-License-Identifier: BSD-3-Clause
#include "flight/vehicle_urdf.hpp"

#include <fmt/format.h>

#include "flight/vehicle_shapes.hpp"
#include "messages/frames.hpp"

namespace rosflight::flight {
namespace {

using messages::flu;
using sim::Vector3;

std::string triple(const Vector3& v) {
  // Adding zero turns -0 into 0.
  return fmt::format("{:.6g} {:.6g} {:.6g}", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);
}

std::string box(const Vector3& size) {
  return fmt::format("<box size=\"{}\"/>", triple(size));
}

std::string visual(const std::string& shape, const char* color) {
  return fmt::format(
      "    <visual>\n      <geometry>{}</geometry>\n"
      "      <material name=\"{}\"/>\n    </visual>\n",
      shape, color);
}

std::string material(const char* name, const char* rgba) {
  return fmt::format("  <material name=\"{}\"><color rgba=\"{}\"/></material>\n", name, rgba);
}

/// A link that is fixed to base_link. @param rpy_rad  about its fixed axes.
std::string part(const std::string& name, const Vector3& position, const Vector3& rpy_rad,
                 const std::string& shape, const char* color) {
  return fmt::format(
      "  <link name=\"{0}\">\n{1}  </link>\n"
      "  <joint name=\"{0}_joint\" type=\"fixed\">\n"
      "    <parent link=\"base_link\"/>\n    <child link=\"{0}\"/>\n"
      "    <origin xyz=\"{2}\" rpy=\"{3}\"/>\n  </joint>\n",
      name, visual(shape, color), triple(position), triple(rpy_rad));
}

/// J about the axes of base_link, of which y and z are turned round.
std::string inertia(const sim::Matrix3& J) {
  return fmt::format(
      "<inertia ixx=\"{:.6g}\" ixy=\"{:.6g}\" ixz=\"{:.6g}\" iyy=\"{:.6g}\" iyz=\"{:.6g}\" "
      "izz=\"{:.6g}\"/>",
      J(0, 0), 0.0 - J(0, 1), 0.0 - J(0, 2), J(1, 1), J(1, 2) + 0.0, J(2, 2));
}

}  // namespace

std::string vehicle_urdf(const FlightSetup& setup) {
  const auto& rotors = setup.rotors.rotors;
  const auto& contacts = setup.vehicle.ground().contacts_B;
  const VehicleShapes shapes{setup.vehicle, setup.rotors};

  std::string urdf =
      fmt::format("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n", setup.vehicle.type());
  urdf += material("body", "0.25 0.3 0.35 1") + material("rotor", "0.2 0.5 0.8 0.5") +
          material("wing", "0.75 0.75 0.7 1") + material("gear", "0.1 0.1 0.1 1");
  urdf += fmt::format(
      "  <link name=\"base_link\">\n    <inertial>\n      <mass value=\"{:.6g}\"/>\n      {}\n"
      "    </inertial>\n{}  </link>\n",
      setup.vehicle.body().mass_kg, inertia(setup.vehicle.body().inertia_kg_m2),
      visual(box(shapes.body_m), "body"));
  for (std::size_t k = 0; k < rotors.size(); ++k) {
    urdf += part(fmt::format("rotor_{}", k), flu(rotors[k].p_B), pointing(flu(rotors[k].e_B)),
                 fmt::format("<cylinder radius=\"{:.6g}\" length=\"{}\"/>",
                             0.5 * setup.rotors.propeller.diameter_m, kPlateThickness_m),
                 "rotor");
  }
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    urdf += part(fmt::format("contact_{}", k), flu(contacts[k]), Vector3::Zero(),
                 fmt::format("<sphere radius=\"{}\"/>", 2.0 * kPlateThickness_m), "gear");
  }
  if (shapes.has_wing())
    urdf += part("wing", Vector3::Zero(), Vector3::Zero(), box(shapes.wing_m), "wing");
  return urdf + "</robot>\n";
}

}  // namespace rosflight::flight
