// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>
#include <vector>

#include "rosflight_common/time.hpp"
#include "rosflight_sim/frames.hpp"
#include "rosflight_sim/module_states.hpp"
#include "rosflight_sim/tick_tracker.hpp"
#include "rosflight_sim/waiting_clock.hpp"

namespace rosflight_sim {

namespace sim = rosflight::sim;
namespace hal = rosflight::hal;
namespace {

using rosflight_common::nanoseconds;
using rosflight_common::stamp_of;

constexpr std::int64_t kTick_ns = 2'500'000;

TEST(Stamps, KeepNanosecondsAndNeverShowAWholeSecondOfThem) {
  EXPECT_EQ(nanoseconds(stamp_of(1'999'999'999)), 1'999'999'999);
  EXPECT_EQ(stamp_of(1'999'999'999).nanosec, 999'999'999U);
  EXPECT_EQ(stamp_of(2'000'000'000).sec, 2);
  EXPECT_EQ(stamp_of(2'000'000'000).nanosec, 0U);
  EXPECT_EQ(nanoseconds(stamp_of(-5)), 0);
  EXPECT_EQ(nanoseconds(stamp_of(4'300'000'000'000)), 4'300'000'000'000);  // beyond 2^32 us
}

// ---- the board's time without simulated time ------------------------------------------------------

/// A board that is looked at every millisecond, with an IMU every other one.
struct Stage {
  WaitingClock clock;
  WaitingClock::Wall::time_point wall{std::chrono::seconds(100)};
  hal::Time latest = clock.at(wall);

  void run(int ms, bool imu, int apart_ms = 1) {
    for (int k = 0; k < ms; k += apart_ms) {
      wall += std::chrono::milliseconds(apart_ms);
      if (imu && k % 2 == 0) clock.came(WaitingClock::Source::kImu, wall);
      const hal::Time now = clock.at(wall);
      ASSERT_GE(now, latest);
      latest = now;
    }
  }
  /// The first of each; board time runs with the IMU alone afterwards, as the receiver has been given up.
  void start() {
    clock.came(WaitingClock::Source::kReceiver, wall);
    run(1000, true);
    static_cast<void>(clock.take_stalls());
  }
  /// What board time gains in this.
  std::int64_t gain_ms(int ms, bool imu, int apart_ms = 1) {
    const hal::Time before = latest;
    run(ms, imu, apart_ms);
    return hal::to_ms(latest - before);
  }
};

TEST(WaitingClock, RunsAsTheWallWhileSamplesCome) {
  Stage stage;
  stage.start();
  EXPECT_EQ(stage.gain_ms(3000, true), 3000);
  EXPECT_EQ(stage.clock.take_stalls().count, 0);
}

TEST(WaitingClock, WaitsAtTheStartForTheFirstOfEachButNotForEver) {
  Stage stage;
  EXPECT_EQ(stage.gain_ms(1000, false), 20);
  EXPECT_EQ(stage.gain_ms(1000, true), 40);  // and for the receiver 60 ms
  stage.clock.came(WaitingClock::Source::kReceiver, stage.wall);
  EXPECT_EQ(stage.gain_ms(50, true), 50);
  EXPECT_EQ(stage.clock.take_stalls().count, 0);

  Stage alone;
  EXPECT_EQ(alone.gain_ms(3100, false), 121);  // 20 before, 101 after 3 s
  EXPECT_EQ(alone.gain_ms(1000, false), 1000);
}

TEST(WaitingClock, StandsWhileSamplesAreLateAndSaysForHowLong) {
  Stage stage;
  stage.start();
  stage.run(100, true);
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(stage.gain_ms(300, false), 19);  // 20 ms after the last one, a millisecond ago
    EXPECT_EQ(stage.gain_ms(100, true), 99);   // which the first sample ends
  }
  const WaitingClock::Stalls stalls = stage.clock.take_stalls();
  EXPECT_EQ(stalls.count, 5);
  EXPECT_EQ(stalls.sum, hal::milliseconds(5 * 282));
  EXPECT_EQ(stage.clock.take_stalls().count, 0);
}

TEST(WaitingClock, GoesOnWithoutASourceThatIsDead) {
  Stage stage;
  stage.start();
  stage.run(100, true);
  EXPECT_EQ(stage.gain_ms(3000, false), 3000 - 500);
  EXPECT_EQ(stage.gain_ms(100, true), 100);  // and it comes back
  EXPECT_EQ(stage.gain_ms(400, false), 19);
}

TEST(WaitingClock, AProcessThatStoodStillItselfGivesNobodyUp) {
  Stage stage;
  stage.start();
  stage.run(100, true);
  EXPECT_EQ(stage.gain_ms(3000, false, 3000), 19);
  EXPECT_EQ(stage.gain_ms(300, false), 0);
}

TEST(WaitingClock, WaitsForTheReceiver) {
  Stage stage;
  stage.clock.came(WaitingClock::Source::kReceiver, stage.wall);
  EXPECT_EQ(stage.gain_ms(400, true), 60);
}

TEST(TickTracker, JitterNeitherLosesNorDoublesATick) {
  std::mt19937 random{1};
  std::uniform_int_distribution<std::int64_t> jitter(-700'000, 700'000);
  TickTracker ticks{kTick_ns};
  const std::int64_t start = 1'780'000'000'000'000'000;
  ASSERT_TRUE(ticks.step(start));
  for (int k = 1; k < 10'000; ++k) {
    ASSERT_TRUE(ticks.step(start + k * kTick_ns + jitter(random))) << k;
    ASSERT_EQ(ticks.time().count(), k * kTick_ns / 1000);
  }
}

TEST(TickTracker, AFirstStampThatCameLateIsForgotten) {
  TickTracker ticks{kTick_ns};
  ticks.step(1'100'000);  // 1.1 ms late
  int came = 0;
  for (int k = 1; k < 1000; ++k) came += ticks.step(k * kTick_ns) ? 1 : 0;
  EXPECT_EQ(came, 999);
}

TEST(TickTracker, LostStampsLeaveAGap) {
  TickTracker ticks{kTick_ns};
  ticks.step(0);
  ticks.step(kTick_ns);
  EXPECT_TRUE(ticks.step(5 * kTick_ns));
  EXPECT_EQ(ticks.time().count(), 12'500);
}

TEST(TickTracker, AFasterWorldGivesNoMoreTicks) {
  TickTracker ticks{kTick_ns};
  int came = 0;
  for (int k = 0; k < 1000; ++k) came += ticks.step(k * 1'000'000) ? 1 : 0;
  EXPECT_NEAR(came, 400, 2);
}

TEST(TickTracker, TimeGoesOnWhenTheClockIsSetBack) {
  TickTracker ticks{kTick_ns};
  ticks.step(100'000'000'000);
  ticks.step(100'000'000'000 + kTick_ns);
  EXPECT_TRUE(ticks.step(0));
  EXPECT_EQ(ticks.time().count(), 5000);
  EXPECT_TRUE(ticks.step(kTick_ns));
  EXPECT_EQ(ticks.time().count(), 7500);
}

/// dx/dt = -x/tau with tau = 0.1 s.
class Lag final : public sim::ForcesAndMoments {
 public:
  std::size_t state_size() const override { return 1; }
  void initial_state(std::span<double> x) const override { x[0] = 1.0; }
  void evaluate(const Input& /*in*/, std::span<const double> x, sim::Wrench& wrench,
                std::span<double> x_dot) const override {
    wrench.force_B.x() = x[0];
    x_dot[0] = -x[0] / 0.1;
  }
};

class ModuleStatesTest : public testing::Test {
 protected:
  double force_after(double dt_s, int steps) {
    Lag lag;
    ModuleStates states{lag};
    const sim::BodyState body;
    const sim::Matrix3 R = sim::Matrix3::Identity();
    const sim::Vector3 v = sim::Vector3::Zero();
    const sim::Air air;
    const hal::OutputValues outputs{};
    sim::Wrench wrench;
    sim::Truth truth;
    for (int i = 0; i < steps; ++i)
      states.step({body, R, v, air, outputs, 0.0}, dt_s, wrench, truth);
    return wrench.force_B.x();
  }
};

TEST_F(ModuleStatesTest, FollowTheExactSolution) {
  EXPECT_NEAR(force_after(0.0025, 40), std::exp(-1.0), 1e-8);
  EXPECT_NEAR(force_after(0.1, 1), std::exp(-1.0), 1e-8);  // split
}

TEST_F(ModuleStatesTest, APauseAndAStepBackChangeNothing) {
  EXPECT_EQ(force_after(3600.0, 1), 1.0);
  EXPECT_EQ(force_after(-0.1, 1), 1.0);
  EXPECT_EQ(force_after(0.0, 1), 1.0);
}

/// Direction of a vector of `child` in `map`, along the tree.
sim::Vector3 in_map(const sim::Vector3& v, const std::string& child,
                    const sim::Quaternion& q_WB = sim::Quaternion::Identity()) {
  if (child == "map") return v;
  if (child == "aircraft_body") return in_map(q_WB * v, "NED");
  for (const FrameEdge& edge : fixed_frames())
    if (child == edge.child) return in_map(edge.rotation * v, edge.parent, q_WB);
  ADD_FAILURE() << child << " is not in the tree";
  return v;
}

TEST(Frames, MapIsEastNorthUp) {
  EXPECT_TRUE(in_map({1, 0, 0}, "NED").isApprox(sim::Vector3(0, 1, 0), 1e-12));   // north
  EXPECT_TRUE(in_map({0, 1, 0}, "NED").isApprox(sim::Vector3(1, 0, 0), 1e-12));   // east
  EXPECT_TRUE(in_map({0, 0, 1}, "NED").isApprox(sim::Vector3(0, 0, -1), 1e-12));  // down
}

TEST(Frames, BaseLinkIsForwardLeftUp) {
  EXPECT_TRUE(in_map({1, 0, 0}, "base_link").isApprox(sim::Vector3(0, 1, 0), 1e-12));
  EXPECT_TRUE(in_map({0, 1, 0}, "base_link").isApprox(sim::Vector3(-1, 0, 0), 1e-12));
  EXPECT_TRUE(in_map({0, 0, 1}, "base_link").isApprox(sim::Vector3(0, 0, 1), 1e-12));
}

TEST(Frames, TheMeshFliesNoseFirstAndTopUp) {  // its nose is at -y, as in ROSflight 2.x
  EXPECT_TRUE(in_map({0, -1, 0}, "stl_frame").isApprox(sim::Vector3(0, 1, 0), 1e-12));
  EXPECT_TRUE(in_map({0, 0, 1}, "stl_frame").isApprox(sim::Vector3(0, 0, 1), 1e-12));
}

TEST(Frames, NamesOfASecondVehicleAreItsOwn) {
  EXPECT_EQ(frame_prefix("/"), "");
  EXPECT_EQ(frame_prefix("/air/two"), "air/two/");
}

}  // namespace
}  // namespace rosflight_sim
