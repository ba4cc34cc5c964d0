// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>
#include "base/constants.hpp"

#include "flight/gazebo/coupling/link_engine.hpp"
#include "flight/gazebo/coupling/link_loop.hpp"
#include "flight/gazebo/coupling/link_truth.hpp"
#include "flight/gazebo/coupling/plugin_options.hpp"
#include "flight/gazebo/coupling/wrench_steps.hpp"

namespace rosflight::flight::gazebo {
namespace {

using sim::BodyState;
using sim::Quaternion;
using sim::Vector3;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr double kG_m_s2 = 9.80665;
constexpr double kHalfTurn = base::kPi;

Quaternion yaw(double angle_rad) {
  return {std::cos(0.5 * angle_rad), 0.0, 0.0, std::sin(0.5 * angle_rad)};
}

// ---- frames

TEST(LinkState, EastInGazebosAxesIsEastInOurs) {
  LinkState link;  // level, nose to the east, 10 m up, 3 m/s forward, climbing at 1 m/s
  link.p_G = {5.0, 7.0, 10.0};
  link.v_G = {3.0, 0.0, 1.0};
  const BodyState body = body_of(link, Vector3::Zero());
  EXPECT_TRUE(body.p_W.isApprox(Vector3(7.0, 5.0, -10.0)));
  EXPECT_TRUE((body.q_WB * Vector3::UnitX()).isApprox(Vector3::UnitY()));  // east
  EXPECT_TRUE((body.q_WB * Vector3::UnitZ()).isApprox(Vector3::UnitZ()));
  EXPECT_TRUE(body.v_B.isApprox(Vector3(3.0, 0.0, -1.0)));
}

TEST(LinkState, TurningLeftInGazeboIsANegativeYawRate) {
  LinkState link;
  link.w_G = {0.1, 0.2, 0.5};  // about forward, left, up
  EXPECT_TRUE(body_of(link, Vector3::Zero()).w_B.isApprox(Vector3(0.1, -0.2, -0.5)));
}

TEST(LinkState, ThereAndBackAgain) {
  BodyState body;
  body.p_W = {1.0, -2.0, -3.0};
  body.q_WB = Quaternion(0.5, 0.1, -0.7, 0.3).normalized();
  body.v_B = {4.0, 5.0, -6.0};
  body.w_B = {0.3, -0.2, 0.1};
  const Vector3 c_L(0.02, -0.01, 0.05);
  const BodyState back = body_of(link_of(body, c_L), c_L, body.q_WB);
  EXPECT_TRUE(back.p_W.isApprox(body.p_W, 1e-14));
  EXPECT_TRUE(back.q_WB.coeffs().isApprox(body.q_WB.coeffs(), 1e-14));
  EXPECT_TRUE(back.v_B.isApprox(body.v_B, 1e-14));
  EXPECT_TRUE(back.w_B.isApprox(body.w_B, 1e-14));
}

TEST(LinkState, ACentreOfMassBesideTheOriginMovesWhenTheLinkTurns) {
  LinkState link;
  link.w_G = {0.0, 0.0, 2.0};
  const BodyState body = body_of(link, {0.5, 0.0, 0.0});  // half a metre in front, that is east
  EXPECT_TRUE(body.p_W.isApprox(Vector3(0.0, 0.5, 0.0)));
  EXPECT_TRUE((body.q_WB * body.v_B).isApprox(Vector3(1.0, 0.0, 0.0)));  // to the north
}

TEST(LinkState, AForceAtTheCentreOfMassIsAForceAndATorqueAtTheOrigin) {
  const sim::PhysicsEngine::Load up{{0.0, 0.0, -10.0}, {0.1, 0.2, 0.3}};
  const LinkWrench none = link_wrench(up, Quaternion::Identity(), Vector3::Zero());
  EXPECT_TRUE(none.force_G.isApprox(Vector3(0.0, 0.0, 10.0)));
  EXPECT_TRUE(none.torque_G.isApprox(Vector3(0.1, -0.2, -0.3)));
  // 0.5 m in front of the origin: the origin would turn nose up, about minus y.
  const LinkWrench off = link_wrench(up, Quaternion::Identity(), {0.5, 0.0, 0.0});
  EXPECT_TRUE(off.torque_G.isApprox(Vector3(0.1, -0.2 - 5.0, -0.3)));
  // The link looks north: its forward axis is y of the world.
  const LinkWrench turned = link_wrench(up, yaw(0.5 * kHalfTurn), Vector3::Zero());
  EXPECT_TRUE(turned.torque_G.isApprox(Vector3(0.2, 0.1, -0.3)));
}

TEST(LinkState, TheSignOfTheQuaternionDoesNotJump) {
  BodyState body;
  body.q_WB = Quaternion(-0.9, 0.1, 0.2, 0.3).normalized();
  EXPECT_LT(body_of(link_of(body, Vector3::Zero()), Vector3::Zero(), body.q_WB).q_WB.w(), 0.0);
}

// ---- truth

TEST(LinkTruth, ABodyAtRestFeelsItsWeightAndAFallingOneNothing) {
  LinkTruth truth(Vector3::Zero(), kG_m_s2);
  truth.begin({});
  constexpr double kStep_s = 0.0025;
  truth.move({}, kStep_s);
  EXPECT_TRUE(truth.truth().specific_force_B.isApprox(Vector3(0.0, 0.0, -kG_m_s2), 1e-12));
  LinkState falling;
  falling.v_G.z() = -kG_m_s2 * kStep_s;
  truth.move(falling, kStep_s);
  EXPECT_LT(truth.truth().specific_force_B.norm(), 1e-12);
}

TEST(LinkTruth, AnAttitudeTurnsWhatAccelerates) {
  LinkTruth truth(Vector3::Zero(), kG_m_s2);
  truth.begin(body_of({}, Vector3::Zero()));  // nose to the east
  LinkState link;
  link.v_G = {0.0, 0.1, 0.0};  // to the north: to the left
  link.w_G = {0.2, 0.0, 0.0};
  truth.move(link, 0.01);
  EXPECT_TRUE(truth.truth().specific_force_B.isApprox(Vector3(0.0, -10.0, -kG_m_s2), 1e-12));
  EXPECT_TRUE(truth.truth().angular_acceleration_B.isApprox(Vector3(20.0, 0.0, 0.0), 1e-12));
}

// ---- wrenches as steps

constexpr nanoseconds kStep = microseconds(2500);

/// Steps that are due now.
int take(WrenchSteps& steps, nanoseconds step = kStep) {
  int count = 0;
  while (steps.due(step)) {
    steps.move(step);
    ++count;
  }
  return count;
}

TEST(WrenchSteps, OneStepForEachWrenchWhateverTheJitter) {
  WrenchSteps steps(milliseconds(100));
  nanoseconds stamp = std::chrono::seconds(7);
  steps.add(stamp, {});
  EXPECT_EQ(take(steps), 0);  // the first one stands for no time
  const int jitter_us[] = {0, 900, -900, 300, 1100, -1100, 0};
  for (const int late : jitter_us) {
    stamp += kStep;
    steps.add(stamp + microseconds(late), {});
    EXPECT_EQ(take(steps), 1) << late;
  }
}

TEST(WrenchSteps, NoTimeIsLostInTheLongRun) {
  WrenchSteps steps(milliseconds(100));
  int count = 0;
  for (int k = 0; k <= 1000; ++k) {
    steps.add(milliseconds(3) * k, {});
    count += take(steps);
  }
  EXPECT_EQ(count, 1200);  // 3 s
}

TEST(WrenchSteps, AGapIsBoundedAndStampsThatStandOrGoBackAreNoTime) {
  WrenchSteps steps(milliseconds(100));
  steps.add(milliseconds(0), {});
  EXPECT_EQ(steps.add(std::chrono::seconds(10), {}), std::chrono::seconds(10));
  EXPECT_EQ(take(steps), 40);
  steps.add(std::chrono::seconds(10), {});
  EXPECT_EQ(take(steps), 0);
  steps.add(std::chrono::seconds(3), {});
  EXPECT_EQ(take(steps), 0);
  steps.add(std::chrono::seconds(3) + kStep, {});
  EXPECT_EQ(take(steps), 1);
}

TEST(WrenchSteps, OneThatCannotFollowLosesTime) {
  WrenchSteps steps(milliseconds(100));
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(steps.loses_time(kStep), k > 1) << k;
    steps.add(milliseconds(100) * k, {});
  }
  steps.move(kStep);
  EXPECT_TRUE(steps.loses_time(kStep));
  steps.move(kStep);
  EXPECT_FALSE(steps.loses_time(kStep));
  EXPECT_EQ(take(steps), 38);  // of 360
}

TEST(WrenchSteps, SmallerStepsOfTheSimulatorAreSeveralForEachWrench) {
  WrenchSteps steps(milliseconds(100));
  steps.add(milliseconds(0), {});
  steps.add(kStep, {});
  EXPECT_EQ(take(steps, microseconds(500)), 5);
}

TEST(WrenchSteps, AStepThatWasNotDueIsMadeUp) {
  WrenchSteps steps(milliseconds(100));
  steps.add(milliseconds(0), {});
  steps.move(kStep);
  steps.add(kStep, {});
  EXPECT_EQ(take(steps), 0);
  steps.add(2 * kStep, {});
  EXPECT_EQ(take(steps), 1);
}

TEST(WrenchSteps, ALeadIsForgottenWhenTheWorldIsPutElsewhere) {
  WrenchSteps steps(milliseconds(100));
  steps.add(milliseconds(0), {});
  steps.move(kStep);
  steps.forget_lead();
  steps.add(kStep, {});
  EXPECT_EQ(take(steps), 1);
}

TEST(WrenchSteps, TimeWhileTheSimulatorStandsDoesNotCount) {
  WrenchSteps steps(milliseconds(100));
  steps.add(milliseconds(0), {});
  steps.skip(std::chrono::seconds(5));
  steps.add(std::chrono::seconds(5) + kStep, {});
  EXPECT_EQ(take(steps), 1);
}

// ---- in step

/// Writes down its calls; throws when it is told to.
class FakeLoop final : public LinkLoop {
 public:
  explicit FakeLoop(std::vector<std::string>& calls) : calls_{calls} {}
  StepCommand before_step(nanoseconds step) override {
    calls_.push_back("before " + std::to_string(step.count() / 1000));
    if (calls_.size() > 5) throw std::runtime_error("the engine is gone");
    return {};
  }
  void after_step(const LinkState& /*state*/) override { calls_.push_back("after"); }
  std::optional<Run> while_paused() override {
    calls_.push_back("paused");
    return Run::kResume;
  }

 private:
  std::vector<std::string>& calls_;
};

class LinkCouplings : public testing::Test {
 protected:
  LinkCoupling::Time at(int number, nanoseconds step = kStep, bool paused = false) const {
    return {number * step, step, paused};
  }
  std::vector<std::string> calls;
  std::vector<std::string> said;
  LinkCoupling coupling{std::make_unique<FakeLoop>(calls),
                        [this](const std::string& line) { said.push_back(line); }};
};

using Calls = std::vector<std::string>;

TEST_F(LinkCouplings, CallBeforeAndAfterEachStepButNotWhileTimeStands) {
  coupling.before_step(at(1));
  coupling.after_step(at(1), LinkState{});
  EXPECT_EQ(coupling.before_step(at(1, kStep, true)).run, Run::kResume);
  coupling.after_step(at(1, kStep, true), LinkState{});
  coupling.before_step(at(2));
  EXPECT_EQ(calls, (Calls{"before 2500", "after", "paused", "before 2500"}));
  EXPECT_TRUE(said.empty());
}

TEST_F(LinkCouplings, RejectAStepThatIsNotOfTheFirmware) {
  for (int k = 1; k < 4; ++k) coupling.before_step(at(k, milliseconds(1)));
  EXPECT_EQ(said,
            Calls{"max_step_size: found 0.001 s, allowed 0.0025 s, the step of the firmware, or a "
                  "whole part of it such as 0.00125 or 0.0005; the vehicle is without forces from "
                  "here on"});
  EXPECT_TRUE(calls.empty());
  EXPECT_FALSE(coupling.works());
}

TEST_F(LinkCouplings, RejectAStepThatIsChangedOnTheWay) {
  coupling.before_step(at(1));
  coupling.after_step(at(1), LinkState{});
  coupling.before_step({milliseconds(6), milliseconds(2), false});
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].rfind("max_step_size: found 0.002 s", 0), 0U) << said[0];
}

TEST_F(LinkCouplings, RejectTimeThatGoesBack) {
  coupling.before_step(at(1));
  coupling.before_step(at(5));
  coupling.before_step(at(1));
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].rfind("simulated time: found 0.0025 s after 0.0125 s", 0), 0U) << said[0];
}

TEST_F(LinkCouplings, GiveUpWithOneLineWhenTheLoopThrowsOrThereIsNoState) {
  for (int k = 1; k < 5; ++k) {
    coupling.before_step(at(k));
    coupling.after_step(at(k), LinkState{});
  }
  EXPECT_EQ(said, Calls{"the engine is gone; the vehicle is without forces from here on"});
  LinkCoupling other{std::make_unique<FakeLoop>(calls = {}),
                     [this](const std::string& line) { said.push_back(line); }};
  other.before_step(at(1));
  LinkState nan;
  nan.v_G.x() = std::nan("");
  other.after_step(at(1), nan);
  ASSERT_EQ(said.size(), 2U);
  EXPECT_EQ(said[1].rfind("the simulator has no finite state of the link", 0), 0U);
}

// ---- engine of a whole loop

TEST(LinkEngine, SeesNoContactInTheAirAndTheWeightOnTheGround) {
  LinkEngine engine(2.0, kG_m_s2, Vector3::Zero());
  engine.set_state(body_of({}, Vector3::Zero()));
  ASSERT_TRUE(engine.take_placing());
  EXPECT_FALSE(engine.take_placing());
  constexpr double kStep_s = 0.0025;
  const sim::PhysicsEngine::Load load{{4.0, 0.0, -10.0}, Vector3::Zero()};
  LinkState link;
  link.v_G = {0.0, 2.0 * kStep_s, (5.0 - kG_m_s2) * kStep_s};
  engine.move(link, kStep_s, load);
  EXPECT_FALSE(engine.contact()->touches);
  engine.move(link, kStep_s, {{0.0, 0.0, 0.0}, Vector3::Zero()});  // its velocity stays
  EXPECT_TRUE(engine.contact()->touches);
  EXPECT_NEAR(engine.contact()->wrench.force_B.z(), -2.0 * kG_m_s2, 1e-9);
  EXPECT_NEAR(engine.contact()->normal_up, 1.0, 1e-9);
}

TEST(LinkEngine, MeasuresTheSpeedOfAnImpactAgainstTheSurface) {
  LinkEngine engine(2.0, kG_m_s2, Vector3::Zero());
  LinkState link;
  link.v_G = {6.0, 0.0, -1.0};
  engine.set_state(body_of(link, Vector3::Zero()));
  LinkState landed;  // friction takes some of the speed along the ground
  landed.v_G = {5.8, 0.0, 0.0};
  engine.move(landed, 0.0025, {});
  EXPECT_GT(engine.contact()->normal_up, 0.5);
  EXPECT_NEAR(engine.contact()->approach_m_s, 1.0, 1e-12);
  engine.set_state(body_of(link, Vector3::Zero()));
  engine.move({}, 0.0025, {});  // a wall
  EXPECT_LT(engine.contact()->normal_up, 0.5);
  EXPECT_NEAR(engine.contact()->approach_m_s, 6.0, 1e-12);
  EXPECT_THROW(engine.step(0.0025, {}), std::logic_error);
}

// ---- elements of the plugin

std::string complaint(const PluginElements& elements) {
  try {
    read_plugin_options(elements);
  } catch (const config::Error& error) {
    return error.what();
  }
  return "none";
}

TEST(PluginOptions, AreReadAndWhatIsMissingIsTheDefault) {
  const PluginOptions least = read_plugin_options({{"vehicle", "multirotor"}});
  EXPECT_EQ(least.mode, PluginOptions::Mode::kDynamicsOnly);
  EXPECT_EQ(least.link, "base_link");
  const PluginOptions whole = read_plugin_options({{"mode", "whole_loop"},
                                                   {"vehicle", "anaconda"},
                                                   {"seed", "7"},
                                                   {"wind", "5,270"},
                                                   {"at_end", "stop"},
                                                   {"gz:system_priority", "3"}});
  EXPECT_EQ(whole.mode, PluginOptions::Mode::kWholeLoop);
  EXPECT_EQ(whole.choice.vehicle, "anaconda");
  EXPECT_EQ(whole.choice.seed, 7U);
  EXPECT_EQ(whole.choice.wind, "5,270");
  EXPECT_EQ(whole.at_end, Run::kStop);
  EXPECT_EQ(read_plugin_options({{"vehicle", "a"}, {"wait_s", "0.5"}}).wait, milliseconds(500));
}

TEST(PluginOptions, WhatIsNotAllowedIsOneLine) {
  EXPECT_EQ(complaint({{"vehicle", "multirotor"}, {"mode", "both"}}),
            "<mode>: found 'both', allowed dynamics_only, whole_loop");
  EXPECT_EQ(complaint({}), "<vehicle>: found none, allowed a name of vehicles/ or a YAML file");
  EXPECT_EQ(complaint({{"vehicle", "m"}, {"sead", "1"}}),
            "found an element <sead>, allowed at_end, fault, link, log, max_gap_s, mission, mode, "
            "namespace, seed, set, vehicle, wait_s, wind");
  EXPECT_EQ(complaint({{"vehicle", "m"}, {"seed", "-1"}}),
            "<seed>: found -1, allowed a number from 0 to 1000000000000");
  EXPECT_EQ(complaint({{"vehicle", "m"}, {"wait_s", "1e9"}}),
            "<wait_s>: found 1e9, allowed a number from 0.001 to 10");
  EXPECT_EQ(complaint({{"vehicle", "m"}, {"mission", "hop"}}),
            "found an element <mission> with <mode> dynamics_only, allowed with whole_loop");
}

}  // namespace
}  // namespace rosflight::flight::gazebo
