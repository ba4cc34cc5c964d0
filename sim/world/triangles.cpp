// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/triangles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace rosflight::sim::world {
namespace {

constexpr double kNothing_m = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kMaxLeaf = 4;
/// Halves of up to 2^32 triangles, one more for each level.
constexpr std::size_t kMaxTreeDepth = 40;

/// Whether the ray is in the box before `nearest_m`. A little larger than the box, so that rounding
/// does not lose a triangle on its side.
bool enters(const Vector3& low, const Vector3& high, const Ray& ray, double nearest_m) {
  constexpr double kMargin_m = 1e-9;
  double enter = 0.0;
  double leave = nearest_m;
  for (int i = 0; i < 3; ++i) {
    const double p = ray.origin[i];
    const double d = ray.direction[i];
    if (d == 0.0) {
      if (p < low[i] - kMargin_m || p > high[i] + kMargin_m) return false;
      continue;
    }
    const double a = (low[i] - kMargin_m - p) / d;
    const double b = (high[i] + kMargin_m - p) / d;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave;
}

}  // namespace

TriangleSurface::TriangleSurface(std::vector<Vector3> points, std::vector<Triangle> triangles)
    : points_{std::move(points)}, triangles_{std::move(triangles)} {
  for (const Vector3& point : points_) reach_m_ = std::max(reach_m_, point.norm());
  build(0, static_cast<std::uint32_t>(triangles_.size()));
}

std::uint32_t TriangleSurface::build(std::uint32_t first, std::uint32_t count) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  Vector3 low = Vector3::Constant(kNothing_m);
  Vector3 high = -low;
  for (std::uint32_t k = first; k < first + count; ++k) {
    for (const std::uint32_t corner : triangles_[k]) {
      low = low.cwiseMin(points_[corner]);
      high = high.cwiseMax(points_[corner]);
    }
  }
  nodes_.push_back({low, high, first, count});
  if (count <= kMaxLeaf) return index;
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const auto begin = triangles_.begin() + first;
  const std::uint32_t half = count / 2;
  std::nth_element(begin, begin + half, begin + count, [&](const Triangle& a, const Triangle& b) {
    const auto centre = [&](const Triangle& t) {
      return points_[t[0]][axis] + points_[t[1]][axis] + points_[t[2]][axis];
    };
    return centre(a) < centre(b);
  });
  nodes_[index].count = 0;
  build(first, half);
  const std::uint32_t second = build(first + half, count - half);
  nodes_[index].first = second;
  return index;
}

double TriangleSurface::triangle_m(const Triangle& triangle, const Ray& ray) const {
  constexpr double kMargin = 1e-12;
  const Vector3& a = points_[triangle[0]];
  const Vector3 e1 = points_[triangle[1]] - a;
  const Vector3 e2 = points_[triangle[2]] - a;
  const Vector3 d_e2 = ray.direction.cross(e2);
  const double det = e1.dot(d_e2);
  if (det == 0.0) return kNothing_m;
  const Vector3 s = ray.origin - a;
  const double u = s.dot(d_e2) / det;
  const Vector3 s_e1 = s.cross(e1);
  const double v = ray.direction.dot(s_e1) / det;
  if (!(u >= -kMargin && v >= -kMargin && u + v <= 1.0 + kMargin)) return kNothing_m;
  const double t = e2.dot(s_e1) / det;
  return t >= 0.0 ? t : kNothing_m;
}

double TriangleSurface::distance_m(const Ray& ray) const {
  double nearest_m = kNothing_m;
  std::array<std::uint32_t, kMaxTreeDepth> waiting{};
  std::size_t depth = 0;
  waiting[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t index = waiting[--depth];
    const Node& node = nodes_[index];
    if (!enters(node.low, node.high, ray, nearest_m)) continue;
    if (node.count == 0) {
      waiting[depth++] = node.first;
      waiting[depth++] = index + 1;
      continue;
    }
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      nearest_m = std::min(nearest_m, triangle_m(triangles_[k], ray));
    }
  }
  return nearest_m;
}

}  // namespace rosflight::sim::world
