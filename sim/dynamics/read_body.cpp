// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Eigenvalues>

#include "sim/dynamics/rigid_body.hpp"

namespace rosflight::sim {
namespace {
/// Error of a measured moment of inertia. The Anaconda of ROSflight 2.x is 1.6 % beyond the
/// possible.
constexpr double kMeasured = 0.02;
}  // namespace

BodyParameters read_body(const config::Section& section) {
  using config::Range;
  BodyParameters p;
  p.mass_kg = section.number("mass_kg", Range::positive_up_to(1e5));
  const config::Section j = section.section("inertia_kg_m2");
  const Range product = Range::between(-1e6, 1e6);
  const double xx = j.number("xx", Range::positive_up_to(1e6));
  const double yy = j.number("yy", Range::positive_up_to(1e6));
  const double zz = j.number("zz", Range::positive_up_to(1e6));
  const double xy = j.number("xy", product, 0.0);
  const double xz = j.number("xz", product, 0.0);
  const double yz = j.number("yz", product, 0.0);
  p.inertia_kg_m2 << xx, xy, xz, xy, yy, yz, xz, yz, zz;
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
  p.integration = section.choice<Integration>(
      "integration", {{"rk4", Integration::kRk4}, {"frozen_forces", Integration::kFrozenForces}},
      Integration::kRk4);
  p.max_step_s = section.number("longest_step_s", Range::between(1e-4, 0.1), p.max_step_s);
  section.finish();
  return p;
}

}  // namespace rosflight::sim
