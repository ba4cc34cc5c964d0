// SPDX-License-Identifier: BSD-3-Clause
// The default mission of the multirotor indoors: no satellites from power-on, the pose by motion capture, 50 ms late and
// with the noise of a real system. Judged by the truth: docs/simulation/world-sensors.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "flight/test/flight_rig.hpp"

namespace rosflight::flight::testing {
namespace {

using autonomy::estimation::Aid;

constexpr std::uint64_t kSeeds = 10;

FlightChoice indoors(std::uint64_t seed, std::vector<std::string> faults = {},
                     std::vector<std::string> more = {}) {
  FlightChoice choice;
  choice.seed = seed;
  choice.overrides = {"sensors.gnss.enabled=false",
                      "world_sensors={mocap: {type: motion_capture, rate_Hz: 100, delay_us: 50000, "
                      "position_m: {noise_sigma: 0.002}, attitude_rad: {noise_sigma: 0.005}}}"};
  choice.overrides.insert(choice.overrides.end(), more.begin(), more.end());
  choice.faults = std::move(faults);
  return choice;
}

struct Result {
  double estimate_m{};  ///< Largest error of the estimated position in the air, while there is one.
  double tracking_rms_m{};
  double drift_m{};  ///< Horizontal distance from where the position was lost to where it stands.
  double touchdown_m_s{};
  std::uint64_t poses{};
  std::vector<std::string> notes;

  long count(const std::string& text) const { return std::count(notes.begin(), notes.end(), text); }
  /// These notes, in this order, with others between them.
  bool in_order(const std::vector<std::string>& wanted) const {
    auto from = notes.begin();
    for (const std::string& text : wanted) {
      from = std::find(from, notes.end(), text);
      if (from == notes.end()) return false;
    }
    return true;
  }
};

Result fly(Rig& rig) {
  Result result;
  rig.flight->runner().set_notify(
      [&](const FlightNote& note) { result.notes.push_back(note.source + ": " + note.text); });
  std::optional<sim::Vector3> lost_W;
  while (!rig.flight->finished()) {
    rig.flight->step();
    const sim::Truth& truth = rig.flight->truth();
    if (truth.on_ground || rig.flight->runner().stage() != Stage::kFly) continue;
    const autonomy::StateEstimate& estimate = rig.flight->runner().estimate();
    if (estimate.horizontal == autonomy::Quality::kNone) {
      if (!lost_W) lost_W = truth.body.p_W;
    } else {
      result.estimate_m = std::max(result.estimate_m, (estimate.p_W - truth.body.p_W).norm());
    }
  }
  const FlightScore score = rig.flight->score();
  result.tracking_rms_m = rig.flight->tracking().rms();
  if (lost_W) result.drift_m = (rig.flight->truth().body.p_W - *lost_W).head<2>().norm();
  if (score.landing.touchdown()) result.touchdown_m_s = score.landing.touchdown()->hardest_m_s;
  result.poses = rig.flight->estimate_source().health().of(Aid::kPose).accepted;
  return result;
}

constexpr const char* kDeadReckoning = "estimator: position by dead reckoning";
constexpr const char* kLost = "estimator: position lost";
constexpr const char* kAided = "estimator: position aided";

TEST(MotionCapture, CarriesTheDefaultMissionWithoutSatellites) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    Rig rig(indoors(seed));
    const Result result = fly(rig);
    EXPECT_TRUE(rig.completed()) << rig.flight->score().verdict;
    const autonomy::estimation::EstimatorHealth& health = rig.flight->estimate_source().health();
    EXPECT_EQ(health.of(Aid::kGnssVelocity).accepted, 0U);
    EXPECT_FALSE(rig.flight->estimate_source().origin().has_value());
    EXPECT_GT(result.poses, 3000U);
    EXPECT_EQ(health.of(Aid::kPose).rejected, 0U);
    EXPECT_EQ(result.count(kDeadReckoning), 0);
    EXPECT_LE(result.estimate_m, 0.1);
    EXPECT_LE(result.tracking_rms_m, 0.1);
  }
}

TEST(MotionCapture, DropOutsOfHalfASecondAreFlownThrough) {
  std::vector<std::string> faults;
  for (int t = 16; t < 90; t += 3) faults.push_back("motion_capture@" + std::to_string(t) + ":0.5");
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    Rig whole(indoors(seed));
    Rig rig(indoors(seed, faults));
    const Result result = fly(rig);
    EXPECT_LT(result.poses, fly(whole).poses * 9 / 10);
    EXPECT_TRUE(rig.completed()) << rig.flight->score().verdict;
    EXPECT_EQ(result.count(kDeadReckoning), 0);
    EXPECT_LE(result.estimate_m, 0.1);
    EXPECT_LE(result.tracking_rms_m, 0.1);
  }
}

TEST(MotionCapture, DropOutsAtRandomAreFlownThrough) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    Rig rig(indoors(seed, {},
                    {"world_sensors.mocap.dropout_interval_s=3",
                     "world_sensors.mocap.dropout_duration_s=0.5"}));
    const Result result = fly(rig);
    EXPECT_TRUE(rig.completed()) << rig.flight->score().verdict;
    EXPECT_LE(result.estimate_m, 0.3);
  }
}

TEST(MotionCapture, FiveSecondsWithoutItAreReportedAndTheMissionGoesOn) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    Rig rig(indoors(seed, {"motion_capture@30:5"}));
    const Result result = fly(rig);
    EXPECT_TRUE(rig.completed()) << rig.flight->score().verdict;
    EXPECT_TRUE(result.in_order({kDeadReckoning, kAided}));
    EXPECT_EQ(result.count(kLost), 0);
    EXPECT_LE(result.estimate_m, 1.0);
  }
}

TEST(MotionCapture, InASmallRoomFiveSecondsWithoutItEndOnTheGround) {
  // Two seconds of dead reckoning are all that the room allows.
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    Rig rig(indoors(seed, {"motion_capture@30:5"}, {"autonomy.estimator.dead_reckoning_s=2"}));
    const Result result = fly(rig);
    EXPECT_EQ(rig.flight->score().outcome, Outcome::kLandedElsewhere);
    EXPECT_TRUE(
        result.in_order({kDeadReckoning, kLost, "autonomy: position lost",
                         "autonomy: phase landing", "autonomy: phase landed", "fcu: Disarmed"}));
    EXPECT_TRUE(rig.flight->runner().disarmed());
    EXPECT_GT(result.touchdown_m_s, 0.0);
    EXPECT_LE(result.touchdown_m_s, 1.0);
    EXPECT_LE(result.drift_m, 5.0);
  }
}

TEST(MotionCapture, LostForGoodItComesDownSoftly) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    Rig rig(indoors(seed, {"motion_capture@30"}));
    const Result result = fly(rig);
    EXPECT_EQ(rig.flight->score().outcome, Outcome::kLandedElsewhere);
    EXPECT_TRUE(
        result.in_order({kDeadReckoning, kLost, "autonomy: phase landed", "fcu: Disarmed"}));
    EXPECT_GT(result.touchdown_m_s, 0.0);
    EXPECT_LE(result.touchdown_m_s, 1.0);
  }
}

TEST(MotionCapture, WithNeitherSatellitesNorCamerasItDoesNotArm) {
  for (const auto& choice :
       {indoors(1, {"motion_capture@0"}), indoors(1, {}, {"autonomy.estimator.use_pose=false"})}) {
    Rig rig(choice);
    const Result result = fly(rig);
    EXPECT_EQ(result.poses, 0U);
    EXPECT_EQ(rig.flight->runner().stage(), Stage::kFailed);
    EXPECT_EQ(rig.flight->runner().armed_at(), sim::Time{0});
    EXPECT_NE(rig.flight->runner().failure().find("stage arm"), std::string::npos);
  }
}

}  // namespace
}  // namespace rosflight::flight::testing
