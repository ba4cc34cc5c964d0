// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rosflight::sim::world {
namespace {

struct Interval {
  double enter;
  double leave;
};
constexpr Interval kNever{kNoHit_m, -kNoHit_m};
constexpr Interval kAlways{-kNoHit_m, kNoHit_m};

/// Where a point that moves at `d` from `p` is between -h and h.
Interval slab(double p, double d, double h) {
  if (d == 0.0) return std::abs(p) <= h ? kAlways : kNever;
  const double a = (-h - p) / d;
  const double b = (h - p) / d;
  return {std::min(a, b), std::max(a, b)};
}

Interval common(const Interval& a, const Interval& b) {
  return {std::max(a.enter, b.enter), std::min(a.leave, b.leave)};
}

/// The surface of a convex body that the ray is in during this interval.
double first_surface(const Interval& inside) {
  if (inside.enter > inside.leave || inside.leave < 0.0) return kNoHit_m;
  return inside.enter >= 0.0 ? inside.enter : inside.leave;
}

/// Where a ray in two or three dimensions is within a radius; d need not have length 1.
template <class Vector>
Interval ball(const Vector& p, const Vector& d, double radius_m) {
  const double squared_speed = d.squaredNorm();
  if (squared_speed == 0.0) return p.norm() <= radius_m ? kAlways : kNever;
  const double nearest = -p.dot(d) / squared_speed;
  const double room = radius_m * radius_m - (p + nearest * d).squaredNorm();
  if (room < 0.0) return kNever;
  const double half = std::sqrt(room / squared_speed);
  return {nearest - half, nearest + half};
}

double distance_m(const std::shared_ptr<const TriangleSurface>& surface, const Ray& ray) {
  return surface->distance_m(ray);
}

double bounding_radius_m(const Geometry& geometry) {
  struct Visitor {
    double operator()(const Plane& /*plane*/) const { return kNoHit_m; }
    double operator()(const Sphere& sphere) const { return sphere.radius_m; }
    double operator()(const Cylinder& c) const {
      return std::sqrt(c.radius_m * c.radius_m + 0.25 * c.length_m * c.length_m);
    }
    double operator()(const Box& box) const { return 0.5 * box.size_m.norm(); }
    double operator()(const std::shared_ptr<const TriangleSurface>& surface) const {
      return surface->reach_m();
    }
  };
  // Rounding of the ray must not lose a touch of the outermost point.
  constexpr double kMargin = 1.0 + 1e-9;
  return kMargin * std::visit(Visitor{}, geometry);
}

}  // namespace

double distance_m(const Plane& /*plane*/, const Ray& ray) {
  if (ray.direction.z() == 0.0) return ray.origin.z() == 0.0 ? 0.0 : kNoHit_m;
  const double t = -ray.origin.z() / ray.direction.z();
  return t >= 0.0 ? t : kNoHit_m;
}

double distance_m(const Sphere& sphere, const Ray& ray) {
  return first_surface(ball(ray.origin, ray.direction, sphere.radius_m));
}

double distance_m(const Cylinder& cylinder, const Ray& ray) {
  const Eigen::Vector2d p = ray.origin.head<2>();
  const Eigen::Vector2d d = ray.direction.head<2>();
  const Interval along = slab(ray.origin.z(), ray.direction.z(), 0.5 * cylinder.length_m);
  return first_surface(common(ball(p, d, cylinder.radius_m), along));
}

double distance_m(const Box& box, const Ray& ray) {
  Interval inside = kAlways;
  for (int i = 0; i < 3; ++i) {
    inside = common(inside, slab(ray.origin[i], ray.direction[i], 0.5 * box.size_m[i]));
  }
  return first_surface(inside);
}

void WorldShapes::add(Shape shape) {
  bounds_.push_back({shape.p_WS, bounding_radius_m(shape.geometry)});
  shapes_.push_back(std::move(shape));
}

void WorldShapes::add_level_ground() {
  add({"ground", Vector3::Zero(), Matrix3::Identity(), Plane{}});
}

WorldShapes::Hit WorldShapes::cast(const Ray& ray, double max_m) const {
  Hit hit;
  double nearest_m = max_m;
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const Shape& shape = shapes_[i];
    const Bound& bound = bounds_[i];
    if (bound.radius_m < kNoHit_m) {
      const Interval near =
          ball(Vector3(ray.origin - bound.center_W), ray.direction, bound.radius_m);
      if (near.enter > near.leave || near.leave < 0.0 || near.enter > nearest_m) continue;
    }
    const Ray in_S{shape.R_WS.transpose() * (ray.origin - shape.p_WS),
                   shape.R_WS.transpose() * ray.direction};
    const double t = std::visit(
        [&in_S](const auto& geometry) { return distance_m(geometry, in_S); }, shape.geometry);
    if (!(t <= nearest_m) || t == kNoHit_m) continue;
    nearest_m = t;
    hit = {t, &shape};
  }
  return hit;
}

}  // namespace rosflight::sim::world
