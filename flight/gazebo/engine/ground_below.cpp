// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gazebo/engine/ground_below.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rosflight::flight::gazebo {
namespace {

using Eigen::Vector3d;

/// Distance along the ray from `point` to the box, 0 inside it; negative: the ray misses it.
double distance_to_box(const Vector3d& point, const Vector3d& direction, const Vector3d& half) {
  double enters = 0.0;
  double leaves = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (std::abs(direction(k)) < 1e-12) {
      if (std::abs(point(k)) > half(k)) return -1.0;
      continue;
    }
    const double one = (-half(k) - point(k)) / direction(k);
    const double other = (half(k) - point(k)) / direction(k);
    enters = std::max(enters, std::min(one, other));
    leaves = std::min(leaves, std::max(one, other));
  }
  return enters <= leaves ? enters : -1.0;
}

/// Height of the triangle at the point's x and y; NaN: it is beside it, or the triangle is vertical.
double height_at(const Vector3d& point, const std::array<Vector3d, 3>& t) {
  constexpr double kOnTheEdge = -1e-9;  // so that no ray slips through between two triangles
  const Vector3d a = t[1] - t[0];
  const Vector3d b = t[2] - t[0];
  const Vector3d p = point - t[0];
  const double area = a.x() * b.y() - a.y() * b.x();
  const double u = (p.x() * b.y() - p.y() * b.x()) / area;
  const double v = (a.x() * p.y() - a.y() * p.x()) / area;
  const bool inside = u >= kOnTheEdge && v >= kOnTheEdge && u + v <= 1.0 - kOnTheEdge;
  return inside ? t[0].z() + u * a.z() + v * b.z() : std::nan("");
}

}  // namespace

std::size_t GroundBelow::number_of(const std::string& model) {
  if (models_.empty() || models_.back() != model) models_.push_back(model);
  return models_.size() - 1;
}

void GroundBelow::add_box(const std::string& model, const Eigen::Isometry3d& pose,
                          const Vector3d& half) {
  boxes_.push_back({number_of(model), pose, half});
}

void GroundBelow::add_triangle(const std::string& model, const std::array<Vector3d, 3>& corners) {
  triangles_.push_back({number_of(model), corners});
}

std::optional<GroundBelow::Surface> GroundBelow::nearest(const Vector3d& point, double up) const {
  std::optional<Surface> found;
  const auto take = [&](std::size_t model, double distance_m) {
    // A comparison with NaN is false.
    if (distance_m >= 0.0 && (!found || distance_m < found->distance_m))
      found = {models_[model], distance_m};
  };
  for (const Box& box : boxes_) {
    const Eigen::Isometry3d to_box = box.pose.inverse();
    take(box.model,
         distance_to_box(to_box * point, to_box.linear() * Vector3d(0.0, 0.0, up), box.half));
  }
  for (const Triangle& triangle : triangles_)
    take(triangle.model, up * (height_at(point, triangle.corners) - point.z()));
  return found;
}

}  // namespace rosflight::flight::gazebo
