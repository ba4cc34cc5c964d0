// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <limits>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "sim/types.hpp"
#include "sim/world/triangles.hpp"

/// What stands around the vehicle: shapes that do not move, and the distance to them along a ray.
namespace rosflight::sim::world {

/// z = 0 of the shape's frame, without an end.
struct Plane {};
struct Sphere {
  double radius_m{};  ///< > 0.
};
/// About z of the shape's frame, closed at both ends, its centre at the origin.
struct Cylinder {
  double radius_m{};  ///< > 0.
  double length_m{};  ///< > 0.
};
struct Box {
  Vector3 size_m{Vector3::Zero()};  ///< Each > 0; its centre is the origin.
};
using Geometry = std::variant<Plane, Sphere, Cylinder, Box, std::shared_ptr<const TriangleSurface>>;

/// A geometry in its own frame S at a place of the world W (north, east, down).
struct Shape {
  std::string name;
  Vector3 p_WS{Vector3::Zero()};
  Matrix3 R_WS{Matrix3::Identity()};
  Geometry geometry;
};

/// No shape within the range asked for.
inline constexpr double kNoHit_m = std::numeric_limits<double>::infinity();

/// Distance from a point along a unit vector to the surface of a geometry in its own frame, from
/// outside or from inside; 0 on the surface.
///
///     plane      t = -p_z / d_z                                                                (1)
///     sphere     t = -b -+ sqrt(r^2 - |p - b' d|^2),  b = p.d                                  (2)
///     cylinder   (2) across z between the ends, (1) at the ends                                (3)
///     box        slabs |p_i + t d_i| <= h_i: the last entry or, from inside, the first exit    (4)
///     triangles  triangles.hpp                                                                 (5)
///
/// The second term of (2) is the distance of the ray from the centre, which loses no digits far away.
/// (4) after T. Kay, J. Kajiya, "Ray tracing complex scenes", SIGGRAPH 1986.
/// @returns kNoHit_m if the ray does not meet it.
double distance_m(const Plane& plane, const Ray& ray);
double distance_m(const Sphere& sphere, const Ray& ray);
double distance_m(const Cylinder& cylinder, const Ray& ray);
double distance_m(const Box& box, const Ray& ray);

/// The shapes of one world. Only +, -, *, / and square roots, so that a ray gives the same bits on
/// every machine. Allocates in add() alone.
class WorldShapes {
 public:
  /// The shape takes part from now on.
  void add(Shape shape);
  /// Level ground at z_W = 0, as the ground contact of sim/dynamics has it.
  void add_level_ground();

  struct Hit {
    double distance_m{kNoHit_m};
    const Shape* shape{nullptr};  ///< nullptr: nothing; valid until the next add().
  };
  /// The nearest surface. @param ray  in W. @param max_m  what is farther counts as nothing.
  Hit cast(const Ray& ray, double max_m = kNoHit_m) const;

  const std::vector<Shape>& shapes() const { return shapes_; }
  bool empty() const { return shapes_.empty(); }

 private:
  /// A sphere around a shape: a ray that misses it needs no closer look.
  struct Bound {
    Vector3 center_W{Vector3::Zero()};
    double radius_m{kNoHit_m};
  };
  std::vector<Shape> shapes_;
  std::vector<Bound> bounds_;
};

}  // namespace rosflight::sim::world
