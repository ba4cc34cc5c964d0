// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/dubins.hpp"

#include <gtest/gtest.h>

#include <random>

namespace rosflight::autonomy::fixedwing {
namespace {

Pose pose(double n, double e, double course_deg) {
  return {{n, e}, course_deg * kRadPerDeg};
}

/// Flies the parts and returns where they lead.
Pose end_of(const DubinsPath& path) {
  Pose at = path.parts[0].start;
  for (const DubinsPath::Part& part : path.parts) {
    EXPECT_LT((part.start.p_m - at.p_m).norm(), 1e-6);
    if (part.radius_m == 0.0) {
      at.p_m += part.length_m * along(part.start.course_rad);
      at.course_rad = part.start.course_rad;
    } else {
      const TurnCircle circle = TurnCircle::at(part.start, part.radius_m);
      at.course_rad = part.start.course_rad + part.length_m / part.radius_m;
      at.p_m = circle.point(at.course_rad);
    }
  }
  return at;
}

TEST(Dubins, StraightAheadIsStraight) {
  const DubinsPath path = shortest_dubins_path(pose(0, 0, 90), pose(0, 300, 90), 50.0);
  EXPECT_NEAR(path.length_m, 300.0, 1e-9);
}

TEST(Dubins, TurnOfHalfACircleToTheRight) {
  const DubinsPath path = shortest_dubins_path(pose(0, 0, 0), pose(0, 100, 180), 50.0);
  EXPECT_NEAR(path.length_m, 50.0 * kPi, 1e-9);
  EXPECT_EQ(path.word, DubinsWord::kRsr);
}

/// The formulas of Beard & McLain, Small Unmanned Aircraft, 2012, eq. 11.9 to 11.12, written out
/// as they stand there, from angles between circle centres.
double by_the_book(DubinsWord word, const Pose& s, const Pose& e, double r) {
  const auto mod = [](double x) { return x - 2.0 * kPi * std::floor(x / (2.0 * kPi)); };
  const auto right = [r](const Pose& p) -> Vector2 { return p.p_m + r * right_of(p.course_rad); };
  const auto left = [r](const Pose& p) -> Vector2 { return p.p_m - r * right_of(p.course_rad); };
  const double cs = s.course_rad;
  const double ce = e.course_rad;
  const double h = 0.5 * kPi;
  const bool first_right = word == DubinsWord::kRsr || word == DubinsWord::kRsl;
  const bool last_right = word == DubinsWord::kRsr || word == DubinsWord::kLsr;
  const Vector2 d = (last_right ? right(e) : left(e)) - (first_right ? right(s) : left(s));
  const double l = d.norm();
  const double th = course_of(d);
  switch (word) {
    case DubinsWord::kRsr:
      return l + r * mod(2 * kPi + mod(th - h) - mod(cs - h)) +
             r * mod(2 * kPi + mod(ce - h) - mod(th - h));
    case DubinsWord::kRsl: {
      const double t2 = th - h + std::asin(2 * r / l);
      return std::sqrt(l * l - 4 * r * r) + r * mod(2 * kPi + mod(t2) - mod(cs - h)) +
             r * mod(2 * kPi + mod(t2 + kPi) - mod(ce + h));
    }
    case DubinsWord::kLsr: {
      const double t2 = std::acos(2 * r / l);
      return std::sqrt(l * l - 4 * r * r) + r * mod(2 * kPi + mod(cs + h) - mod(th + t2)) +
             r * mod(2 * kPi + mod(ce - h) - mod(th + t2 - kPi));
    }
    default:
      return l + r * mod(2 * kPi + mod(cs + h) - mod(th + h)) +
             r * mod(2 * kPi + mod(th + h) - mod(ce + h));
  }
}

TEST(Dubins, LengthsAreThoseOfBeardAndMcLain) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-500.0, 500.0);
  std::uniform_real_distribution<double> angle(-kPi, kPi);
  int compared = 0;
  for (int k = 0; k < 500; ++k) {
    const Pose from{{place(random), place(random)}, angle(random)};
    const Pose to{{place(random), place(random)}, angle(random)};
    if ((to.p_m - from.p_m).norm() < 200.0) continue;
    for (const auto word :
         {DubinsWord::kRsr, DubinsWord::kRsl, DubinsWord::kLsr, DubinsWord::kLsl}) {
      const auto path = dubins_path(word, from, to, 50.0);
      ASSERT_TRUE(path);
      EXPECT_NEAR(path->length_m, by_the_book(word, from, to, 50.0), 1e-6);
      ++compared;
    }
  }
  EXPECT_GT(compared, 1000);
}

TEST(Dubins, EveryWordEndsInItsPose) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-150.0, 150.0);
  std::uniform_real_distribution<double> angle(-kPi, kPi);
  int arcs = 0;
  for (int k = 0; k < 500; ++k) {
    const Pose from{{place(random), place(random)}, angle(random)};
    const Pose to{{place(random), place(random)}, angle(random)};
    for (std::size_t w = 0; w < kDubinsWords; ++w) {
      const auto path = dubins_path(static_cast<DubinsWord>(w), from, to, 50.0);
      if (!path) continue;
      const Pose end = end_of(*path);
      EXPECT_LT((end.p_m - to.p_m).norm(), 1e-6) << "word " << w;
      EXPECT_NEAR(std::remainder(end.course_rad - to.course_rad, 2 * kPi), 0.0, 1e-6);
      if (path->word == DubinsWord::kRlr || path->word == DubinsWord::kLrl) {
        EXPECT_GT(path->parts[1].length_m, kPi * 50.0 - 1e-6);
        ++arcs;
      }
    }
  }
  EXPECT_GT(arcs, 100);
}

/// Turning on the spot by half a turn: the word L-R-L with arcs of 60, 300 and 60 degrees (7/3 pi
/// R; Shkel & Lumelsky 2001, sec. 2: short paths may need three arcs), where the straights cannot.
TEST(Dubins, ThreeArcsTurnOnTheSpot) {
  const DubinsPath path = shortest_dubins_path(pose(0, 0, 0), pose(0, 0, 180), 50.0);
  EXPECT_NEAR(path.length_m, 7.0 / 3.0 * kPi * 50.0, 1e-6);
  EXPECT_TRUE(path.word == DubinsWord::kLrl || path.word == DubinsWord::kRlr);
}

/// Beard & McLain ask for 3 R between the poses, so that three arcs are never shortest.
TEST(Dubins, FarPosesNeverNeedThreeArcs) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> angle(-kPi, kPi);
  std::uniform_real_distribution<double> far(200.0, 600.0);
  for (int k = 0; k < 500; ++k) {
    const Pose from{{0.0, 0.0}, angle(random)};
    const Pose to{far(random) * along(angle(random)), angle(random)};
    const DubinsPath path = shortest_dubins_path(from, to, 50.0);
    EXPECT_TRUE(path.word != DubinsWord::kLrl && path.word != DubinsWord::kRlr);
    EXPECT_GE(path.length_m, (to.p_m - from.p_m).norm() - 1e-9);
  }
}

/// Points 20, 21: no angle of a path comes from an acos or asin that could leave [-1, 1].
TEST(Dubins, CirclesThatTouchGiveNumbers) {
  const auto path = dubins_path(DubinsWord::kRsl, pose(0, 0, 0), pose(0, 200, 0), 50.0);
  ASSERT_TRUE(path);
  EXPECT_NEAR(path->length_m, 2.0 * kPi * 50.0, 1e-4);  // two half circles
  EXPECT_TRUE(std::isfinite(path->length_m));
}

TEST(Tangent, PointToPointIsTheLine) {
  const auto t = Tangent::between({{0, 0}, 0.0}, {{30, 40}, 0.0});
  ASSERT_TRUE(t);
  EXPECT_NEAR(t->length_m, 50.0, 1e-12);
  EXPECT_NEAR(t->course_rad, std::atan2(40, 30), 1e-12);
}

/// From 130 m a circle of 50 m: 5-12-13.
TEST(Tangent, PointToCircle) {
  const auto t = Tangent::between({{0, 0}, 0.0}, {{130, 0}, 50.0});
  ASSERT_TRUE(t);
  EXPECT_NEAR(t->length_m, 120.0, 1e-12);
  EXPECT_NEAR(t->course_rad, -std::atan2(50, 120), 1e-12);
  EXPECT_FALSE(Tangent::between({{0, 0}, 0.0}, {{40, 0}, 50.0}));
}

}  // namespace
}  // namespace rosflight::autonomy::fixedwing
