// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "sim/types.hpp"

namespace rosflight::sim::world {

/// Points origin + t direction, t >= 0.
struct Ray {
  Vector3 origin{Vector3::Zero()};
  Vector3 direction{Vector3::UnitX()};  ///< Its length is 1.
};

/// A surface of triangles: a mesh or the terrain of a height map. Both sides of a triangle count.
///
/// A ray meets triangle (a, b, c) at t where, with e1 = b - a, e2 = c - a, s = origin - a,
///
///     det = e1.(d x e2),  u = s.(d x e2)/det,  v = d.(s x e1)/det,  t = e2.(s x e1)/det       (1)
///
/// if u >= 0, v >= 0 and u + v <= 1, each with a margin of 1e-12, so that a ray through an edge that two
/// triangles share meets one of them (T. Moeller, B. Trumbore, "Fast, minimum storage ray/triangle
/// intersection", J. Graphics Tools 2(1), 1997). Triangles are found by a tree of boxes, halved at the
/// median of their centres along the longest side.
class TriangleSurface {
 public:
  using Triangle = std::array<std::uint32_t, 3>;

  /// @param triangles  indices into points; at least one, each below points.size().
  TriangleSurface(std::vector<Vector3> points, std::vector<Triangle> triangles);

  /// The nearest of (1); infinity: none.
  double distance_m(const Ray& ray) const;
  /// Distance of the farthest point from the origin.
  double reach_m() const { return reach_m_; }
  const std::vector<Vector3>& points() const { return points_; }
  const std::vector<Triangle>& triangles() const { return triangles_; }

 private:
  struct Node {
    Vector3 low, high;
    std::uint32_t first;  ///< Its first triangle; or its second child, the first follows the node.
    std::uint32_t count;  ///< 0: it has children.
  };
  std::uint32_t build(std::uint32_t first, std::uint32_t count);
  double triangle_m(const Triangle& triangle, const Ray& ray) const;

  std::vector<Vector3> points_;
  std::vector<Triangle> triangles_;  ///< In the order of the tree.
  std::vector<Node> nodes_;
  double reach_m_{};
};

}  // namespace rosflight::sim::world
