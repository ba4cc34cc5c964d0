// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Eigenvalues>

#include "config/table.hpp"
#include "sim/parameter_tables.hpp"

namespace rosflight::sim {
namespace {

using config::Range;
using config::Row;
using config::Table;

/// Error of a measured moment of inertia. The Anaconda of ROSflight 2.x is 1.6 % beyond the
/// possible.
constexpr double kMeasured = 0.02;

const Range kOffset = Range::between(-20.0, 20.0);

using Body = BodyParameters;

Row<Body> moment(std::string_view key, int i) {
  return Row<Body>{key, [i](Body& b) -> double& { return b.inertia_kg_m2(i, i); }, "kg m^2",
                   Range::positive_up_to(1e6), ""}
      .needed();
}

Row<Body> product(std::string_view key, int i, int k) {
  return {key,
          [i, k](const Body& b) { return b.inertia_kg_m2(i, k); },
          [i, k](Body& b, double v) { b.inertia_kg_m2(i, k) = b.inertia_kg_m2(k, i) = v; },
          "kg m^2",
          Range::between(-1e6, 1e6),
          "element of the matrix: minus the integral over mass"};
}

}  // namespace

Table<BodyParameters> body_parameters() {
  using R = Row<Body>;
  const Table<Body> inertia{moment("xx", 0),     moment("yy", 1),     moment("zz", 2),
                            product("xy", 0, 1), product("xz", 0, 2), product("yz", 1, 2)};
  return {R{"mass_kg", &Body::mass_kg, "kg", Range::positive_up_to(1e5), ""}.needed(),
          R{"inertia_kg_m2", [](Body& b) -> Body& { return b; }, inertia}.needed(),
          {"center_of_mass_m", &Body::centre_of_mass_B, "m", kOffset,
           "in the axes of all other positions of the file, which count from the middle of the "
           "airframe "
           "then: rotors, contacts, sensors, and the point where the air acts. The inertia is "
           "about it"},
          {"integration",
           &Body::integration,
           {{"rk4", Integration::kRk4}, {"frozen_forces", Integration::kFrozenForces}},
           "frozen_forces: as ROSflight 2.x"},
          R{"max_step_s", &Body::max_step_s, "s", Range::between(1e-4, 0.1),
            "longer steps are split evenly"}
              .formerly("longest_step_s")};
}

Vector3 centre_of_mass(const config::Section& vehicle) {
  const auto body = vehicle.optional_section("body");
  if (!body) return Vector3::Zero();
  const auto at = body->numbers("center_of_mass_m", 3, kOffset, {0.0, 0.0, 0.0});
  return {at[0], at[1], at[2]};
}

BodyParameters read_body(const config::Section& section) {
  BodyParameters p;
  body_parameters().read(section, p);
  const Vector3 principal = Eigen::SelfAdjointEigenSolver<Matrix3>(p.inertia_kg_m2).eigenvalues();
  // Ascending; a flat plate reaches equality, and measured ones of an airplane, nearly a plate, may
  // pass it.
  if (principal.x() <= 0.0 || principal.z() > (principal.x() + principal.y()) * (1.0 + kMeasured)) {
    throw section.error("inertia_kg_m2",
                        "principal moments " + config::number_text(principal.x()) + ", " +
                            config::number_text(principal.y()) + ", " +
                            config::number_text(principal.z()),
                        "positive ones, none more than 2 % above the sum of the others");
  }
  section.finish();
  return p;
}

}  // namespace rosflight::sim
