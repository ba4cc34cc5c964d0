// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/shapes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "sim/random.hpp"

namespace rosflight::sim::world {
namespace {

Vector3 random_direction(RandomStream& stream) {
  const Vector3 v(stream.normal(), stream.normal(), stream.normal());
  return v / v.norm();
}

Ray random_ray(RandomStream& stream, double spread_m) {
  return {Vector3(stream.uniform(-spread_m, spread_m), stream.uniform(-spread_m, spread_m),
                  stream.uniform(-spread_m, spread_m)),
          random_direction(stream)};
}

Ray along(const Vector3& origin, const Vector3& towards) {
  return {origin, towards / towards.norm()};
}

// ---- closed forms

TEST(Plane, IsMetAtItsHeightOverTheSlope) {
  // 3 m above it, 30 degrees below the horizon: 3/sin 30 = 6 m.
  const double c = std::sqrt(0.75);
  EXPECT_NEAR(distance_m(Plane{}, along({5.0, -2.0, 3.0}, {c, 0.0, -0.5})), 6.0, 1e-14);
  EXPECT_NEAR(distance_m(Plane{}, along({5.0, -2.0, -3.0}, {c, 0.0, 0.5})), 6.0, 1e-14);
  EXPECT_EQ(distance_m(Plane{}, along({0.0, 0.0, 3.0}, {c, 0.0, 0.5})), kNoHit_m);
  EXPECT_EQ(distance_m(Plane{}, along({0.0, 0.0, 3.0}, {1.0, 0.0, 0.0})), kNoHit_m);
}

TEST(Sphere, IsMetAtBothSidesAndTouchedAtItsRim) {
  const Sphere ball{2.0};
  EXPECT_NEAR(distance_m(ball, along({-5.0, 0.0, 0.0}, {1.0, 0.0, 0.0})), 3.0, 1e-14);
  // Chord at a distance of 1.2 m from the centre: half of it is sqrt(4 - 1.44) = 1.6 m.
  EXPECT_NEAR(distance_m(ball, along({-5.0, 1.2, 0.0}, {1.0, 0.0, 0.0})), 3.4, 1e-14);
  EXPECT_NEAR(distance_m(ball, along({0.5, 0.0, 0.0}, {-1.0, 0.0, 0.0})), 2.5, 1e-14);  // inside
  EXPECT_EQ(distance_m(ball, along({-5.0, 2.001, 0.0}, {1.0, 0.0, 0.0})), kNoHit_m);
  EXPECT_EQ(distance_m(ball, along({5.0, 0.0, 0.0}, {1.0, 0.0, 0.0})), kNoHit_m);  // behind
}

TEST(Sphere, LosesNoDigitsFarAway) {
  // A ball of 1 m seen from 1e6 m: b^2 - (p^2 - r^2) alone would be off by 1e-4 m.
  const double t = distance_m(Sphere{1.0}, along({-1e6, 0.6, 0.0}, {1.0, 0.0, 0.0}));
  EXPECT_NEAR(t, 1e6 - 0.8, 1e-9);
}

TEST(Cylinder, IsMetAtItsSideAndItsEnds) {
  const Cylinder mast{0.5, 4.0};
  EXPECT_NEAR(distance_m(mast, along({-3.0, 0.3, 1.9}, {1.0, 0.0, 0.0})), 2.6, 1e-14);
  EXPECT_EQ(distance_m(mast, along({-3.0, 0.3, 2.1}, {1.0, 0.0, 0.0})), kNoHit_m);
  EXPECT_NEAR(distance_m(mast, along({0.2, 0.2, 5.0}, {0.0, 0.0, -1.0})), 3.0, 1e-14);
  EXPECT_EQ(distance_m(mast, along({0.4, 0.4, 5.0}, {0.0, 0.0, -1.0})), kNoHit_m);
  // From inside upwards at 45 degrees: the side is nearer than the end.
  EXPECT_NEAR(distance_m(mast, along({0.0, 0.0, 0.0}, {1.0, 0.0, 1.0})), 0.5 * std::sqrt(2.0),
              1e-14);
}

TEST(Box, IsMetAtTheFirstOfItsFaces) {
  const Box house{{10.0, 8.0, 6.0}};
  EXPECT_NEAR(distance_m(house, along({-9.0, 1.0, 1.0}, {1.0, 0.0, 0.0})), 4.0, 1e-14);
  // Along the diagonal of the x-y plane from (-8, -7): x = -5 after 3 m, y = -4 after 3 m: the corner.
  EXPECT_NEAR(distance_m(house, along({-8.0, -7.0, 0.0}, {1.0, 1.0, 0.0})), 3.0 * std::sqrt(2.0),
              1e-13);
  EXPECT_NEAR(distance_m(house, along({1.0, 1.0, 1.0}, {0.0, 0.0, 1.0})), 2.0, 1e-14);  // inside
  EXPECT_EQ(distance_m(house, along({-9.0, 4.1, 0.0}, {1.0, 0.0, 0.0})), kNoHit_m);
}

TEST(TriangleSurface, IsMetInItsTrianglesAlone) {
  // A square of 2 m in two triangles, 1 m above the origin and sloped: z = 1 + x/2.
  const TriangleSurface roof(
      {{-1.0, -1.0, 0.5}, {1.0, -1.0, 1.5}, {1.0, 1.0, 1.5}, {-1.0, 1.0, 0.5}},
      {{0, 1, 2}, {0, 2, 3}});
  EXPECT_NEAR(roof.distance_m(along({0.5, 0.2, 4.0}, {0.0, 0.0, -1.0})), 2.75, 1e-14);
  EXPECT_NEAR(roof.distance_m(along({0.5, 0.5, 4.0}, {0.0, 0.0, -1.0})), 2.75,
              1e-14);  // the shared edge
  EXPECT_EQ(roof.distance_m(along({1.1, 0.2, 4.0}, {0.0, 0.0, -1.0})), kNoHit_m);
  EXPECT_NEAR(roof.distance_m(along({0.0, 0.0, 0.0}, {0.0, 0.0, 1.0})), 1.0, 1e-14);  // from below
}

// ---- properties over random rays

/// How far a point is outside the surface; 0 on it, negative inside. In the frame of the shape.
double off(const Sphere& s, const Vector3& p) {
  return p.norm() - s.radius_m;
}
double off(const Cylinder& c, const Vector3& p) {
  return std::max(p.head<2>().norm() - c.radius_m, std::abs(p.z()) - 0.5 * c.length_m);
}
double off(const Box& b, const Vector3& p) {
  return (p.cwiseAbs() - 0.5 * b.size_m).maxCoeff();
}
double off(const Plane& /*plane*/, const Vector3& p) {
  return p.z();
}

template <class Shape>
void expect_nearest_surface(const Shape& shape, std::uint64_t seed) {
  RandomStream stream = RandomSource{seed}.stream("rays");
  constexpr int kRays = 2000;
  constexpr int kSteps = 100;
  int hits = 0;
  for (int k = 0; k < kRays; ++k) {
    const Ray ray = random_ray(stream, 4.0);
    const double t = distance_m(shape, ray);
    const double end = t == kNoHit_m ? 12.0 : t;
    if (t < kNoHit_m) {
      ++hits;
      ASSERT_NEAR(off(shape, ray.origin + t * ray.direction), 0.0, 1e-12) << "ray " << k;
    }
    // No nearer surface: all points before it are on the side of the first.
    const bool outside = off(shape, ray.origin) > 0.0;
    for (int i = 1; i < kSteps; ++i) {
      const Vector3 p = ray.origin + end * i / kSteps * ray.direction;
      if (std::abs(off(shape, p)) < 1e-9) continue;
      ASSERT_EQ(off(shape, p) > 0.0, outside) << "ray " << k << " at " << end * i / kSteps;
    }
  }
  EXPECT_GT(hits, kRays / 20);
  EXPECT_LT(hits, kRays);
}

TEST(RandomRays, MeetTheSurfaceOfEachShapeAndNoneNearer) {
  expect_nearest_surface(Plane{}, 1);
  expect_nearest_surface(Sphere{1.5}, 2);
  expect_nearest_surface(Cylinder{1.0, 3.0}, 3);
  expect_nearest_surface(Box{{2.0, 3.0, 1.0}}, 4);
}

TEST(RandomRays, MeetTheTriangleThatASearchOfAllFinds) {
  // Hills on a grid: the tree of boxes against each triangle by its plane and its three sides.
  std::vector<Vector3> points;
  std::vector<TriangleSurface::Triangle> triangles;
  constexpr std::uint32_t kSide = 24;
  for (std::uint32_t row = 0; row < kSide; ++row) {
    for (std::uint32_t column = 0; column < kSide; ++column) {
      points.emplace_back(column, row, std::sin(0.7 * column) * std::cos(0.5 * row));
      if (row + 1 == kSide || column + 1 == kSide) continue;
      const std::uint32_t at = row * kSide + column;
      triangles.push_back({at, at + 1, at + kSide});
      triangles.push_back({at + 1, at + kSide + 1, at + kSide});
    }
  }
  const auto by_planes = [&](const Ray& ray) {
    double nearest = kNoHit_m;
    for (const auto& t : triangles) {
      const Vector3 &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
      const Vector3 n = (b - a).cross(c - a);
      const double x = n.dot(a - ray.origin) / n.dot(ray.direction);
      const Vector3 p = ray.origin + x * ray.direction;
      const bool inside = n.dot((b - a).cross(p - a)) >= 0.0 &&
                          n.dot((c - b).cross(p - b)) >= 0.0 && n.dot((a - c).cross(p - c)) >= 0.0;
      if (inside && x >= 0.0) nearest = std::min(nearest, x);
    }
    return nearest;
  };
  const TriangleSurface hills(points, triangles);
  RandomStream stream = RandomSource{5}.stream("rays");
  int hits = 0;
  for (int k = 0; k < 300; ++k) {
    Ray ray = random_ray(stream, 12.0);
    ray.origin += Vector3(11.5, 11.5, 0.0);
    const double expected = by_planes(ray);
    const double t = hills.distance_m(ray);
    ASSERT_EQ(t == kNoHit_m, expected == kNoHit_m) << "ray " << k;
    if (t == kNoHit_m) continue;
    ++hits;
    ASSERT_NEAR(t, expected, 1e-10) << "ray " << k;
  }
  EXPECT_GT(hits, 40);
}

TEST(RandomRays, FallThroughNoSeamOfATerrain) {
  // Straight down on the edges and corners of the grid, where triangles meet.
  std::vector<Vector3> points;
  std::vector<TriangleSurface::Triangle> triangles;
  constexpr std::uint32_t kSide = 8;
  RandomStream stream = RandomSource{6}.stream("heights");
  for (std::uint32_t at = 0; at < kSide * kSide; ++at) {
    points.emplace_back(0.3 * (at % kSide), 0.3 * (at / kSide), stream.uniform(0.0, 2.0));
    if (at % kSide + 1 == kSide || at / kSide + 1 == kSide) continue;
    triangles.push_back({at, at + 1, at + kSide});
    triangles.push_back({at + 1, at + kSide + 1, at + kSide});
  }
  const TriangleSurface terrain(points, triangles);
  for (std::uint32_t at = 0; at < points.size(); ++at) {
    const Vector3& p = points[at];
    EXPECT_NEAR(terrain.distance_m(along({p.x(), p.y(), 5.0}, {0.0, 0.0, -1.0})), 5.0 - p.z(), 1e-9)
        << at;
    if (at % kSide + 1 == kSide) continue;
    const Vector3 middle = 0.37 * p + 0.63 * points[at + 1];
    EXPECT_NEAR(terrain.distance_m(along({middle.x(), middle.y(), 5.0}, {0.0, 0.0, -1.0})),
                5.0 - middle.z(), 1e-9)
        << at;
  }
}

// ---- the world

WorldShapes village() {
  WorldShapes world;
  world.add_level_ground();
  const auto turned = [](double angle, const Vector3& axis) {
    return Matrix3(Eigen::AngleAxisd(angle, axis / axis.norm()));
  };
  world.add({"house", {24.0, 0.0, -3.0}, turned(0.4, {0.0, 0.0, 1.0}), Box{{8.0, 10.0, 6.0}}});
  world.add({"mast", {0.0, 30.0, -5.0}, turned(0.1, {1.0, 0.0, 0.0}), Cylinder{0.2, 10.0}});
  world.add({"tank", {-15.0, 5.0, -4.0}, turned(1.0, {1.0, 2.0, 3.0}), Sphere{3.0}});
  return world;
}

TEST(WorldShapes, FindsTheNearestOfThem) {
  const WorldShapes world = village();
  const auto hit = world.cast(along({-15.0, 5.0, -20.0}, {0.0, 0.0, 1.0}));
  ASSERT_NE(hit.shape, nullptr);
  EXPECT_EQ(hit.shape->name, "tank");
  EXPECT_NEAR(hit.distance_m, 13.0, 1e-12);
  EXPECT_EQ(world.cast(along({-40.0, 5.0, -20.0}, {0.0, 0.0, 1.0})).shape->name, "ground");
  EXPECT_EQ(world.cast(along({-15.0, 5.0, -20.0}, {0.0, 0.0, -1.0})).shape, nullptr);
  EXPECT_EQ(world.cast(along({-15.0, 5.0, -20.0}, {0.0, 0.0, 1.0}), 12.9).shape, nullptr);
}

TEST(WorldShapes, GivesTheSmallestDistanceOfAllForRandomRays) {
  const WorldShapes world = village();
  RandomStream stream = RandomSource{7}.stream("rays");
  int hits = 0;
  for (int k = 0; k < 5000; ++k) {
    const Ray ray = random_ray(stream, 20.0);
    double expected = kNoHit_m;  // of each shape, without its bounding sphere
    for (const Shape& shape : world.shapes()) {
      const Ray inside{shape.R_WS.transpose() * (ray.origin - shape.p_WS),
                       shape.R_WS.transpose() * ray.direction};
      std::visit(
          [&](const auto& geometry) {
            if constexpr (requires { distance_m(geometry, inside); })
              expected = std::min(expected, distance_m(geometry, inside));
          },
          shape.geometry);
    }
    const auto hit = world.cast(ray);
    ASSERT_EQ(hit.distance_m, expected) << "ray " << k;
    if (hit.shape != nullptr && hit.shape->name != "ground") ++hits;
  }
  EXPECT_GT(hits, 100);
}

TEST(WorldShapes, DoesNotDependOnWhereItIsAndHowItIsTurned) {
  // The same village seen from a turned and moved frame: the same distances.
  const WorldShapes world = village();
  const Matrix3 R(Eigen::AngleAxisd(2.1, Vector3(1.0, -2.0, 0.5).normalized()));
  const Vector3 p(100.0, -50.0, 7.0);
  WorldShapes moved;
  for (const Shape& shape : world.shapes())
    moved.add({shape.name, R * shape.p_WS + p, R * shape.R_WS, shape.geometry});
  RandomStream stream = RandomSource{8}.stream("rays");
  for (int k = 0; k < 5000; ++k) {
    const Ray ray = random_ray(stream, 40.0);
    const auto a = world.cast(ray, 500.0);
    const auto b = moved.cast({R * ray.origin + p, R * ray.direction}, 500.0);
    if (a.shape == nullptr || b.shape == nullptr) continue;  // at the limit
    ASSERT_NEAR(a.distance_m, b.distance_m, 1e-8) << "ray " << k;
  }
}

}  // namespace
}  // namespace rosflight::sim::world
