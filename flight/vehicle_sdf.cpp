// SPDX-License-Identifier: BSD-3-Clause
#include "flight/vehicle_sdf.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include "flight/vehicle/quadplane_setup.hpp"
#include "flight/vehicle/vehicle_setup.hpp"
#include "flight/vehicle_shapes.hpp"
#include "messages/frames.hpp"
#include "sim/fixedwing/fixedwing.hpp"
#include "sim/quadplane/quadplane.hpp"

namespace rosflight::flight {
namespace {

using messages::flu;
using sim::Vector3;

constexpr double kJointInertia_kg_m2 = 1e-9;
constexpr double kEndless_rad = 1e16;  // SDF's own default: no limit

std::string sdf_triple(const Vector3& v) {
  // Adding zero turns -0 into 0.
  return fmt::format("{:.12g} {:.12g} {:.12g}", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);
}

std::string pose_element(const Vector3& position, const Vector3& rpy_rad = Vector3::Zero()) {
  return fmt::format("<pose>{} {}</pose>", sdf_triple(position), sdf_triple(rpy_rad));
}

std::string box_geometry(const Vector3& size) {
  return fmt::format("<geometry><box><size>{}</size></box></geometry>", sdf_triple(size));
}

std::string visual_element(const std::string& name, const std::string& geometry, const char* rgba,
                           const std::string& at = {}) {
  return fmt::format(
      "      <visual name=\"{}_visual\">{}{}<material><diffuse>{}</diffuse></material></visual>\n",
      name, at, geometry, rgba);
}

std::string collision_element(const std::string& name, const std::string& geometry,
                              const std::string& at = {}, const std::string& surface = {}) {
  return fmt::format("      <collision name=\"{}\">{}{}{}</collision>\n", name, at, geometry,
                     surface);
}

/// J about forward-left-up axes, of which y and z are those of J turned round.
std::string inertial_element(double mass_kg, const sim::Matrix3& J) {
  return fmt::format(
      "      <inertial><mass>{}</mass><inertia><ixx>{}</ixx><ixy>{}</ixy><ixz>{}</ixz><iyy>{}</iyy>"
      "<iyz>{}</iyz><izz>{}</izz></inertia></inertial>\n",
      mass_kg, J(0, 0), 0.0 - J(0, 1), 0.0 - J(0, 2), J(1, 1), J(1, 2) + 0.0, J(2, 2));
}

/// Coulomb friction: along the body's x axis, and across.
std::string friction(double along, double across) {
  return fmt::format(
      "<surface><friction><ode><mu>{:.6g}</mu><mu2>{:.6g}</mu2><fdir1>1 0 "
      "0</fdir1></ode></friction>"
      "</surface>",
      along, across);
}

std::string gear(const sim::GroundParameters& ground) {
  std::string out;
  const std::string sphere =
      fmt::format("<geometry><sphere><radius>{}</radius></sphere></geometry>", kContactRadius_m);
  for (std::size_t k = 0; k < ground.contacts_B.size(); ++k) {
    const Vector3 point = flu(ground.contacts_B[k]);
    const bool wheel = k + ground.wheels >= ground.contacts_B.size();
    const Vector3 centre = point - std::copysign(kContactRadius_m, point.z()) * Vector3::UnitZ();
    const std::string name = fmt::format("contact_{}", k);
    out += collision_element(
        name, sphere, pose_element(centre),
        friction(wheel ? ground.rolling_friction : ground.friction, ground.friction));
    out += visual_element(name, sphere, "0.1 0.1 0.1 1", pose_element(centre));
  }
  return out;
}

/// A link that turns about `axis` of its own axes. @param limit_rad  either way.
std::string turning(const std::string& name, const std::string& at, const std::string& geometry,
                    const char* rgba, const char* axis, double limit_rad) {
  return fmt::format(
      "    <link name=\"{0}\">\n      {1}\n{2}{3}    </link>\n"
      "    <joint name=\"{0}_joint\" type=\"revolute\">\n"
      "      <parent>base_link</parent>\n      <child>{0}</child>\n"
      "      "
      "<axis><xyz>{4}</xyz><limit><lower>{5:.12g}</lower><upper>{6:.12g}</upper></limit></axis>\n"
      "    </joint>\n",
      name, at, inertial_element(kJointMass_kg, kJointInertia_kg_m2 * sim::Matrix3::Identity()),
      visual_element(name, geometry, rgba), axis, -limit_rad, limit_rad);
}

/// For each propeller the square inside its disc.
std::string propellers(const sim::MultirotorParameters& parameters) {
  const double side_m = parameters.propeller.diameter_m * std::sqrt(0.5);
  std::string out;
  for (std::size_t k = 0; k < parameters.rotors.size(); ++k) {
    const sim::RotorParameters& rotor = parameters.rotors[k];
    out += collision_element(fmt::format("propeller_{}", k),
                             box_geometry({side_m, side_m, kPlateThickness_m}),
                             pose_element(flu(rotor.p_B), pointing(flu(rotor.e_B))));
  }
  return out;
}

/// Each of them is an entry of its own.
using Parts = std::vector<std::string>;

void add_rotors(const sim::MultirotorParameters& parameters, Parts& out) {
  for (std::size_t k = 0; k < parameters.rotors.size(); ++k) {
    const sim::RotorParameters& rotor = parameters.rotors[k];
    out.push_back(turning(
        fmt::format("rotor_{}", k), pose_element(flu(rotor.p_B), pointing(flu(rotor.e_B))),
        fmt::format(
            "<geometry><cylinder><radius>{:.6g}</radius><length>{}</length></cylinder></geometry>",
            0.5 * parameters.propeller.diameter_m, kPlateThickness_m),
        "0.2 0.5 0.8 0.5", "0 0 1", kEndless_rad));
  }
}

/// Ailerons behind the wing, all others side by side at the tail.
void add_surfaces(const sim::Vehicle& vehicle, const VehicleShapes& shapes, Parts& out) {
  std::vector<sim::SurfaceParameters> all;
  if (is_fixed_wing(vehicle)) all = sim::read_fixed_wing(vehicle.root()).surfaces;
  if (is_quadplane(vehicle)) all = sim::read_quadplane(vehicle.root()).surfaces;
  const double chord_m = 0.25 * shapes.wing_m.x();
  const double tail_m = -0.5 * shapes.body_m.x();
  const double span_m = 0.2 * shapes.wing_m.y();
  double y_m = 0.5 * span_m;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const bool aileron = all[k].effect.x() != 0.0;
    const Vector3 at =
        aileron ? Vector3{-0.5 * shapes.wing_m.x(), 0.0, 0.0} : Vector3{tail_m, y_m, 0.0};
    if (!aileron) y_m = y_m > 0.0 ? -y_m : -y_m + span_m;
    const Vector3 size{chord_m, aileron ? 0.8 * shapes.wing_m.y() : 0.9 * span_m,
                       kPlateThickness_m};
    out.push_back(turning(fmt::format("surface_{}", k), pose_element(at), box_geometry(size),
                          "0.8 0.4 0.2 1", "0 1 0", all[k].travel_rad));
  }
}

/// Mass is nowhere negative, so no principal moment exceeds the sum of the others. sdformat rejects a body for which it
/// does; the reader of vehicle files allows 2 %. @returns J with the largest moment cut to that sum.
sim::Matrix3 possible_inertia(const sim::Matrix3& J) {
  const Eigen::SelfAdjointEigenSolver<sim::Matrix3> solver(J);
  Vector3 moments = solver.eigenvalues();  // in increasing order
  const double allowed = moments(0) + moments(1);
  if (moments(2) <= allowed) return J;
  constexpr double kRounding = 1e-9;
  moments(2) = allowed * (1.0 - kRounding);
  return solver.eigenvectors() * moments.asDiagonal() * solver.eigenvectors().transpose();
}

}  // namespace

std::string vehicle_sdf(const sim::Vehicle& vehicle, const std::string& name, SdfModel model) {
  return fmt::format("<?xml version=\"1.0\"?>\n<sdf version=\"1.9\">\n{}</sdf>\n",
                     vehicle_model_element(vehicle, name, model, ""));
}

std::string vehicle_model_element(const sim::Vehicle& vehicle, const std::string& name,
                                  SdfModel model, const std::string& inside) {
  const sim::MultirotorParameters propulsion = read_rotors(vehicle);
  const VehicleShapes shapes{vehicle, propulsion};
  Parts joints;
  if (model == SdfModel::kWithJoints) {
    add_rotors(propulsion, joints);
    add_surfaces(vehicle, shapes, joints);
  }
  const double mass_kg =
      vehicle.body().mass_kg - kJointMass_kg * static_cast<double>(joints.size());
  std::string link = inertial_element(
      mass_kg, model == SdfModel::kOneLink ? vehicle.body().inertia_kg_m2
                                           : possible_inertia(vehicle.body().inertia_kg_m2));
  link += collision_element("body", box_geometry(shapes.body_m)) +
          visual_element("body", box_geometry(shapes.body_m), "0.25 0.3 0.35 1");
  if (shapes.has_wing())
    link += collision_element("wing", box_geometry(shapes.wing_m)) +
            visual_element("wing", box_geometry(shapes.wing_m), "0.75 0.75 0.7 1");
  link += propellers(propulsion);
  link += gear(vehicle.ground());
  return fmt::format(
      "  <model name=\"{}\" canonical_link=\"base_link\">\n{}    <link "
      "name=\"base_link\">\n{}    </link>\n{}  </model>\n",
      name, inside, link, fmt::join(joints, ""));
}

}  // namespace rosflight::flight
