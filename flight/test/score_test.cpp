// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "flight/flight_summary.hpp"
#include "flight/link_state_estimator.hpp"
#include "flight/test/flight_rig.hpp"
#include "flight/waypoint_score.hpp"

namespace rosflight::flight {
namespace {

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
