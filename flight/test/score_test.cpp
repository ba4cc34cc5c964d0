// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "base/constants.hpp"
#include "flight/flight_summary.hpp"
#include "flight/landing_score.hpp"
#include "flight/link_state_estimator.hpp"
#include "flight/test/flight_rig.hpp"
#include "flight/waypoint_score.hpp"

namespace rosflight::flight {
namespace {

using base::kRadPerDeg;
using testing::Rig;

// ---- waypoints ----------------------------------------------------------------------------------

GuidanceOutput flying_to(std::size_t waypoint) {
  GuidanceOutput out;
  out.tracking = true;
  out.waypoint = waypoint;
  return out;
}

TEST(WaypointScore, TheNearestDistanceInTruthCountsAndNothingIsSubtracted) {
  WaypointScore score({{sim::Vector3(10, 0, -5), PassMeasure::kPoint}});
  const sim::Vector3 offset(0, 3, -4);  // between truth and estimate
  for (int k = 0; k <= 20; ++k) {
    const sim::Vector3 estimate(k, 0, -5);
    score.step(k, estimate + offset, estimate, flying_to(0));
  }
  const WaypointPass pass = score.passes().at(0);
  EXPECT_DOUBLE_EQ(pass.truth_distance_m, 5.0);
  EXPECT_DOUBLE_EQ(pass.estimate_distance_m, 0.0);
  EXPECT_DOUBLE_EQ(pass.t_s, 10.0);
  EXPECT_TRUE(pass.within(5.0));
  EXPECT_FALSE(pass.within(4.999));
}

TEST(WaypointScore, AWaypointCountsOnlyWhileItIsTheTargetOfAMissionThatIsFlown) {
  const sim::Vector3 place(0, 0, -5);
  WaypointScore score({{place, PassMeasure::kPoint}, {place, PassMeasure::kPoint}});
  GuidanceOutput pilot = flying_to(0);
  pilot.tracking = false;
  score.step(1.0, place, place, pilot);  // the pilot flies over it
  EXPECT_TRUE(std::isnan(score.passes()[0].truth_distance_m));
  EXPECT_FALSE(score.passes()[0].within(1e9));
  score.step(2.0, place + sim::Vector3(1, 0, 0), place, flying_to(0));
  EXPECT_DOUBLE_EQ(score.passes()[0].truth_distance_m, 1.0);
  EXPECT_TRUE(std::isnan(score.passes()[1].truth_distance_m)) << "never flown to";
}

TEST(WaypointScore, AFlyByCornerIsMeasuredToThePathBesideItOnceItIsBehind) {
  WaypointScore score({{sim::Vector3(100, 0, -50), PassMeasure::kFlyBy}});
  for (int k = 0; k <= 200; ++k) {
    GuidanceOutput out = flying_to(k <= 150 ? 0 : 1);
    // The path passes 20 m beside the waypoint; the vehicle is 3 m off it and 7 m behind the setpoint.
    out.setpoint.p_W = sim::Vector3(k, 20, -50);
    out.setpoint.v_W = sim::Vector3(15, 0, 0);
    const sim::Vector3 truth(k - 7.0, 23, -50);
    if (k == 120) {
      EXPECT_TRUE(std::isnan(score.passes()[0].truth_distance_m)) << "not yet behind";
    }
    score.step(k, truth, truth, out);
  }
  EXPECT_NEAR(score.passes()[0].truth_distance_m, 3.0, 1e-12);
}

TEST(WaypointScore, AFigureIsMeasuredWhereItIsFarthestFromThePath) {
  WaypointScore score({{sim::Vector3::Zero(), PassMeasure::kFigure}});
  for (int k = 0; k <= 100; ++k) {
    GuidanceOutput out = flying_to(0);
    out.setpoint.p_W = sim::Vector3(k, 0, -5);
    out.setpoint.v_W = sim::Vector3(1, 0, 0);
    out.mission_done = k == 100;
    score.step(k, out.setpoint.p_W + sim::Vector3(9, k == 40 ? -1.5 : 0.5, 0), out.setpoint.p_W,
               out);
  }
  EXPECT_NEAR(score.passes()[0].truth_distance_m, 1.5, 1e-12);
  EXPECT_DOUBLE_EQ(score.passes()[0].t_s, 40.0);
}

// ---- landing ------------------------------------------------------------------------------------

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

// ---- whole flights ------------------------------------------------------------------------------

TEST(Score, TheDefaultFlightIsDoneInTruth) {
  Rig rig(FlightChoice{});
  rig.flight->run();
  const FlightScore score = rig.flight->score();
  EXPECT_EQ(score.outcome, Outcome::kMissionDone) << score.verdict;
  EXPECT_EQ(score.waypoints_reached(), 7U);
  for (const WaypointPass& pass : score.waypoints) {
    EXPECT_LT(pass.estimate_distance_m, 0.2);
    EXPECT_GT(pass.truth_distance_m, pass.estimate_distance_m) << "GNSS drifts";
  }
  EXPECT_EQ(rig.flight->score(true).outcome, Outcome::kInterrupted);
  EXPECT_FALSE(rig.flight->score(true).success());
}

/// The project's estimator with an error of its own: it knows nothing of it, so guidance is content.
class Offset final : public StateEstimateSource {
 public:
  Offset(companion::Session& session, const FlightSetup& setup)
      : inner_{session, setup.estimator, autonomy::estimation::Airframe::kMultirotor} {}
  autonomy::StateEstimate estimate() const override {
    autonomy::StateEstimate out = inner_.estimate();
    out.p_W.y() += 4.0;
    return out;
  }
  const autonomy::estimation::EstimatorHealth& health() const override { return inner_.health(); }
  const std::optional<autonomy::Geodetic>& origin() const override { return inner_.origin(); }
  void set_enabled(bool enabled) override { inner_.set_enabled(enabled); }
  void restart() override { inner_.restart(); }

 private:
  LinkStateEstimator inner_;
};

TEST(Score, AMissThatTheEstimateDoesNotKnowOfIsNoSuccess) {
  FlightChoice choice;
  const FlightSetup setup(choice);
  FlightParts parts;
  parts.estimate_source = [&setup](companion::Session& session) {
    return std::make_unique<Offset>(session, setup);
  };
  Flight flight(setup, std::move(parts));
  flight.run();
  const FlightScore score = flight.score();
  EXPECT_TRUE(flight.runner().disarmed()) << "guidance is content";
  EXPECT_EQ(score.outcome, Outcome::kLandedElsewhere) << score.verdict;
  EXPECT_NE(score.verdict.find("waypoint 1 missed by"), std::string::npos) << score.verdict;
  EXPECT_GT(score.waypoints[0].truth_distance_m, 3.0);
  for (const WaypointPass& pass : score.waypoints) EXPECT_LT(pass.estimate_distance_m, 0.5);
}

TEST(Score, AMotorThatStopsEndsInACrash) {
  Rig rig(Rig::with_faults({"motor0_dead@20"}));
  rig.flight->run();
  const FlightScore score = rig.flight->score();
  EXPECT_EQ(score.outcome, Outcome::kCrash) << score.verdict;
  ASSERT_TRUE(score.landing.touchdown());
  EXPECT_LT(score.waypoints_reached(), 7U);
}

TEST(Score, APilotAtIdleWhoseStickLimitsTheThrottleKeepsTheVehicleOnTheGround) {
  FlightChoice choice;
  choice.pilot = "idle";
  choice.overrides = {"firmware.TAKE_MIN_THR=1"};
  Rig rig(choice);
  rig.flight->run();
  const FlightScore score = rig.flight->score();
  EXPECT_EQ(score.outcome, Outcome::kTimeout) << score.verdict;
  EXPECT_NE(score.verdict.find("never took off"), std::string::npos) << score.verdict;
  EXPECT_FALSE(score.landing.touchdown());
}

TEST(Score, AFixedWingThatNeverClimbedHasNoLowestAirspeed) {
  FlightChoice choice;
  choice.vehicle = "anaconda";
  choice.faults = {"link_cut@9"};  // before it is armed
  Rig rig(choice);
  rig.flight->run();
  std::string json = summary_json(summarise(*rig.flight));
  std::erase(json, ' ');
  EXPECT_NE(json.find("\"lowest_airspeed_m_s\":null"), std::string::npos) << json;
}

/// Throttle stick of the pilot over a flight: the moments at which it moves.
std::vector<std::pair<sim::Time, float>> stick_of(Rig& rig) {
  std::vector<std::pair<sim::Time, float>> moves;
  rig.flight->set_script([&moves](Flight& flight, sim::Time t) {
    const float stick = flight.pilot().position(sim::rc::Control::kThrottle).value_or(0.0F);
    if (moves.empty() || moves.back().second != stick) moves.emplace_back(t, stick);
  });
  rig.flight->run();
  rig.run_for(0.1);  // until the next frame of the radio
  return moves;
}

class BlindPilot : public ::testing::TestWithParam<FlightChoice> {};

TEST_P(BlindPilot, MovesHisStickASecondAfterArmingAndAfterDisarmingOnly) {
  Rig rig(GetParam());
  const auto moves = stick_of(rig);
  ASSERT_GE(moves.size(), 2U);
  EXPECT_EQ(moves[0].second, 0.0F);
  const double after_s = sim::to_seconds(moves[1].first - rig.flight->runner().armed_at());
  EXPECT_NEAR(after_s, 1.0, 0.035) << "the radio has 50 frames a second, guidance 100 steps";
  EXPECT_EQ(moves[1].second, static_cast<float>(rig.setup->hover_throttle));
  if (rig.flight->runner().stage() == Stage::kDone) {
    ASSERT_EQ(moves.size(), 3U);
    EXPECT_EQ(moves[2].second, 0.0F);
  } else {
    EXPECT_EQ(moves.size(), 2U);
  }
}

TEST(PilotStick, AScriptMovesItAndItStaysThere) {
  Rig rig(FlightChoice{});
  ASSERT_TRUE(rig.reach_mission());
  rig.flight->pilot().set(sim::rc::Control::kThrottle, 0.7F);
  rig.run_for(1.0);
  EXPECT_EQ(rig.flight->pilot().position(sim::rc::Control::kThrottle), 0.7F);
}

FlightChoice choice_of(const std::string& vehicle, std::vector<std::string> faults) {
  FlightChoice choice;
  choice.vehicle = vehicle;
  choice.faults = std::move(faults);
  return choice;
}

INSTANTIATE_TEST_SUITE_P(Flights, BlindPilot,
                         ::testing::Values(choice_of("multirotor", {}),
                                           choice_of("multirotor", {"baro_step=3@25"}),
                                           choice_of("multirotor", {"motor0_dead@20"}),
                                           choice_of("anaconda", {})));

}  // namespace
}  // namespace rosflight::flight
