// SPDX-License-Identifier: BSD-3-Clause
// How LandingScore judges the motion of a body. Whole flights: score_test.cpp.
#include "flight/landing_score.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/constants.hpp"

namespace rosflight::flight {
namespace {

using base::kRadPerDeg;

constexpr double kStep_s = 0.0025;
constexpr double kRebound_m = 0.5;

/// A body whose height is a function of time, on the ground at 0.2 m.
struct Descent {
  LandingScore score;
  double t_s{0.0};
  double height_m{0.2};

  void move(double speed_up_m_s, double duration_s, double roll_rad = 0.0) {
    for (int k = 0; k < static_cast<int>(std::lround(duration_s / kStep_s)); ++k) {
      height_m = std::max(0.2, height_m + kStep_s * speed_up_m_s);
      sim::Truth truth;
      t_s += kStep_s;
      truth.time = sim::Time{static_cast<std::int64_t>(std::lround(t_s * 1e6))};
      truth.body.p_W = sim::Vector3(1.0, 2.0, -height_m);
      truth.body.q_WB = sim::Quaternion(Eigen::AngleAxisd(roll_rad, sim::Vector3::UnitX()));
      truth.on_ground = height_m <= 0.2;
      truth.body.v_B =
          truth.body.q_WB.inverse() * sim::Vector3(0.0, 0.0, truth.on_ground ? 0.0 : -speed_up_m_s);
      score.step(truth);
    }
  }
};

LandingLimits within_3_m() {
  LandingLimits limits;
  limits.aim_W = sim::Vector3(0.0, 0.0, 0.0);
  return limits;
}

TEST(LandingScore, SpeedIsThatBeforeTheFirstContact) {
  Descent d;
  d.move(0.0, 1.0);
  EXPECT_FALSE(d.score.airborne());
  d.move(1.0, 5.0);
  EXPECT_TRUE(d.score.airborne());
  EXPECT_FALSE(d.score.touchdown());
  d.move(-1.4, 5.0, 0.1);
  ASSERT_TRUE(d.score.touchdown());
  EXPECT_NEAR(d.score.touchdown()->speed_m_s, 1.4, 1e-9);
  EXPECT_NEAR(d.score.touchdown()->tilt_rad, 0.1, 1e-9);
  EXPECT_NEAR(d.score.distance_m(within_3_m()), std::sqrt(5.0), 1e-12);
  EXPECT_TRUE(d.score.soft(within_3_m()));
  EXPECT_TRUE(d.score.inside(within_3_m()));
}

TEST(LandingScore, LimitsOfSpeedTiltAndBank) {
  const auto landed_at = [](double speed_m_s, double roll_deg) {
    Descent d;
    d.move(2.0, 5.0);
    d.move(-speed_m_s, 20.0 / speed_m_s, kRadPerDeg * roll_deg);
    return d.score;
  };
  LandingLimits fixedwing = within_3_m();
  fixedwing.max_speed_m_s = 2.0;
  fixedwing.max_bank_rad = 15.0 * kRadPerDeg;
  EXPECT_TRUE(landed_at(1.49, 0.0).soft(within_3_m()));
  EXPECT_FALSE(landed_at(1.51, 0.0).soft(within_3_m()));
  EXPECT_TRUE(landed_at(1.99, 14.9).soft(fixedwing));
  EXPECT_FALSE(landed_at(2.01, 0.0).soft(fixedwing));
  EXPECT_FALSE(landed_at(1.0, -15.1).soft(fixedwing));
  EXPECT_FALSE(landed_at(3.99, 44.9).crashed());
  EXPECT_TRUE(landed_at(4.01, 0.0).crashed());
  EXPECT_TRUE(landed_at(1.0, 45.1).crashed());
}

TEST(LandingScore, ABounceBelongsToTheTouchdownAndAContactInFlightIsACrash) {
  Descent d;
  d.move(2.0, 5.0);
  d.move(-1.2, 8.6);
  d.move(1.0, 0.45);  // less than a rebound may be
  d.move(-1.4, 1.0);
  EXPECT_FALSE(d.score.crashed());
  EXPECT_TRUE(d.score.soft(within_3_m()));
  EXPECT_NEAR(d.score.touchdown()->speed_m_s, 1.2, 1e-9) << "of the first contact";
  EXPECT_NEAR(d.score.touchdown()->hardest_m_s, 1.4, 1e-9);
  d.move(1.0, 0.45);
  d.move(-1.6, 1.0);
  EXPECT_FALSE(d.score.soft(within_3_m())) << "the hardest contact counts";
  d.move(1.0, 3.0);
  EXPECT_FALSE(d.score.touchdown()) << "it flies on";
  EXPECT_EQ(d.score.early_contacts(), 1);
  d.move(-1.0, 5.0);
  EXPECT_TRUE(d.score.touchdown());
  EXPECT_TRUE(d.score.crashed());
}

TEST(LandingScore, ATakeOffFromRestIsAnotherFlightOfWhichTheHardestLandingCounts) {
  const auto lands_twice = [](double first_m_s, double rest_s, double roll_rad = 0.0,
                              double down_m = 8.0) {
    Descent d;
    d.move(2.0, 3.0);
    d.move(-first_m_s, down_m / first_m_s, roll_rad);
    d.move(0.0, rest_s, roll_rad);
    d.move(2.0, 3.0);
    EXPECT_FALSE(d.score.touchdown());
    d.move(-1.0, 8.0);
    return d.score;
  };
  EXPECT_TRUE(lands_twice(1.4, 4.0).soft(within_3_m()));
  EXPECT_EQ(lands_twice(1.4, 4.0).early_contacts(), 0);
  EXPECT_FALSE(lands_twice(1.6, 4.0).soft(within_3_m()));
  EXPECT_FALSE(lands_twice(1.6, 4.0).crashed());
  EXPECT_NEAR(lands_twice(1.6, 4.0).hardest()->hardest_m_s, 1.6, 1e-9);
  EXPECT_NEAR(lands_twice(0.5, 4.0).hardest()->hardest_m_s, 1.0, 1e-9);
  EXPECT_TRUE(lands_twice(4.1, 4.0).crashed());
  EXPECT_TRUE(lands_twice(1.0, 4.0, 0.8).crashed()) << "it had turned over";
  EXPECT_EQ(lands_twice(1.0, 0.0, 0.0, 6.5).early_contacts(), 1) << "it had not come to rest";
}

TEST(LandingScore, AVehicleThatTipsOverAfterASoftTouchdownHasCrashed) {
  Descent d;
  d.move(2.0, 5.0);
  d.move(-1.0, 12.0);
  EXPECT_FALSE(d.score.crashed());
  d.move(0.0, 1.0, 2.5);
  EXPECT_TRUE(d.score.crashed());
}

TEST(LandingScore, ARunwayIsLongAlongItsCourse) {
  Descent d;  // comes down at (1, 2)
  d.move(2.0, 5.0);
  d.move(-1.0, 12.0);
  LandingLimits runway;
  runway.half_length_m = 50.0;
  runway.half_width_m = 5.0;
  runway.course_rad = 0.0;
  runway.aim_W = sim::Vector3(-40.0, 0.0, 0.0);
  EXPECT_TRUE(d.score.inside(runway));
  runway.course_rad = 0.5 * base::kPi;
  EXPECT_FALSE(d.score.inside(runway));
  runway.aim_W = sim::Vector3(1.0, -47.0, 0.0);
  EXPECT_TRUE(d.score.inside(runway));
  runway.aim_W = sim::Vector3(1.0, -49.0, 0.0);
  EXPECT_FALSE(d.score.inside(runway));
}

/// Whatever a body does: a touchdown is reported only while it stays down, and a contact in between is
/// never forgotten.
TEST(LandingScore, HoldsOverRandomFlights) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> speed(-6.0, 6.0);
  std::uniform_real_distribution<double> duration(0.05, 0.9);
  std::uniform_real_distribution<double> tilt(-0.5, 0.5);
  for (int flight = 0; flight < 200; ++flight) {
    Descent d;
    bool down = false;       // in contact now
    double highest_m = 0.2;  // since the last contact
    int departures = 0;      // contacts after which it rose by more than a rebound
    double fastest_m_s = 0.0;
    double last_m_s = 0.0;  // the contact may come in the first step of a leg
    for (int leg = 0; leg < 30; ++leg) {
      const double any_m_s = speed(random);  // never at rest for so long that it has landed
      const double up_m_s = d.score.down_for_s() > 0.0 ? std::abs(any_m_s) : any_m_s;
      d.move(up_m_s, duration(random), tilt(random));
      const bool contact = d.height_m <= 0.2;
      if (contact && !down) fastest_m_s = std::max({fastest_m_s, -up_m_s, -last_m_s});
      last_m_s = up_m_s;
      highest_m = contact ? 0.2 : std::max(highest_m, d.height_m);
      if (down && !contact && highest_m > 0.2 + kRebound_m) ++departures;
      if (contact || highest_m > 0.2 + kRebound_m) down = contact;
      if (!d.score.airborne()) continue;
      if (contact) {
        EXPECT_TRUE(d.score.touchdown());
      }
      if (highest_m > 0.2 + kRebound_m) {
        EXPECT_FALSE(d.score.touchdown());
      }
      EXPECT_GE(d.score.early_contacts(), departures - 1) << "the first is the take-off";
      EXPECT_LE(d.score.early_contacts(), departures);
      if (d.score.touchdown()) {
        EXPECT_LE(d.score.touchdown()->speed_m_s, fastest_m_s + 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace rosflight::flight
