// SPDX-License-Identifier: BSD-3-Clause
#include "flight/jsbsim/jsbsim_engine.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "sim/multirotor/multirotor.hpp"
#include "sim/vehicle.hpp"

namespace rosflight::flight {
namespace {

constexpr double kGravity_m_s2 = 9.80665;
constexpr double kStep_s = 0.0025;
using sim::BodyState;
using sim::Quaternion;
using sim::Vector3;
using Load = sim::PhysicsEngine::Load;

sim::BodyParameters body(const Vector3& principal = {0.08, 0.10, 0.15}) {
  sim::BodyParameters b;
  b.mass_kg = 2.0;
  b.inertia_kg_m2 = principal.asDiagonal();
  return b;
}

/// JSBSim moves it for some seconds.
BodyState moved(const sim::BodyParameters& parameters, double gravity_m_s2, const BodyState& start,
                const Load& load, double duration_s) {
  JsbsimEngine engine(parameters, gravity_m_s2, JsbsimEngine::Options::of_project());
  engine.set_state(start);
  const auto steps = std::lround(duration_s / kStep_s);
  for (int i = 0; i < steps; ++i) engine.step(kStep_s, load);
  return engine.state();
}

TEST(JsbsimEngine, ReadsTheStateThatWasSet) {
  BodyState start;
  start.p_W = {3.0, -4.0, -120.0};
  start.q_WB = Quaternion(Eigen::AngleAxisd(2.5, Vector3(1, -2, 3).normalized()));
  start.v_B = {10.0, -1.0, 2.0};
  start.w_B = {0.3, -0.2, 0.5};
  JsbsimEngine engine(body(), kGravity_m_s2, JsbsimEngine::Options::of_project());
  engine.set_state(start);
  // JSBSim keeps a position as feet from the planet's centre, which have a last place of 1.5e-7 m.
  EXPECT_LT((engine.state().p_W - start.p_W).norm(), 3e-7);
  EXPECT_LT(engine.state().q_WB.angularDistance(start.q_WB), 2e-7);  // the horizon there: 1.2e-7
  EXPECT_GT(engine.state().q_WB.dot(start.q_WB), 0.0);               // and not its negative
  EXPECT_LT((engine.state().v_B - start.v_B).norm(), 1e-6);
  EXPECT_LT((engine.state().w_B - start.w_B).norm(), 1e-9);
}

TEST(JsbsimEngine, ThrowsAParabola) {
  BodyState start;
  start.p_W.z() = -50.0;
  start.q_WB = Quaternion(Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()));
  start.v_B = start.q_WB.conjugate() * Vector3(3.0, 0.0, -5.0);
  start.w_B = {0.3, -0.2, 0.5};
  const BodyState end =
      moved(body(), kGravity_m_s2, start, {{4.0, -6.0, 0.0}, Vector3::Zero()}, 1.0);
  // 4 N and -6 N on 2 kg; gravity downwards. The second order of the position has an error at the start alone,
  // a h^2/2 = 3e-5 m.
  EXPECT_LT((end.p_W - Vector3(3.0 + 1.0, -1.5, -55.0 + 0.5 * kGravity_m_s2)).norm(), 5e-5);
  EXPECT_LT((end.q_WB * end.v_B - Vector3(3.0 + 2.0, -3.0, -5.0 + kGravity_m_s2)).norm(), 1e-5);
}

TEST(JsbsimEngine, TurnsByHalfAlphaTSquared) {
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 unit = Vector3::Unit(axis);
    const Vector3 J(0.08, 0.10, 0.15);
    const BodyState end = moved(body(J), 0.0, {}, {Vector3::Zero(), 2.0 * J(axis) * unit}, 1.0);
    EXPECT_LT((end.w_B - 2.0 * unit).norm(), 1e-9) << axis;
    const Quaternion expected(Eigen::AngleAxisd(1.0, unit));
    EXPECT_LT(end.q_WB.angularDistance(expected), 1e-6) << axis;
  }
}

TEST(JsbsimEngine, HasTheInertiaMatrixOfTheVehicle) {
  sim::BodyParameters parameters = body();
  sim::Matrix3& J = parameters.inertia_kg_m2;
  J(0, 1) = J(1, 0) = 0.01;
  J(0, 2) = J(2, 0) = -0.02;
  J(1, 2) = J(2, 1) = 0.015;
  const Vector3 torque(0.1, -0.2, 0.3);
  const BodyState end = moved(parameters, 0.0, {}, {Vector3::Zero(), torque}, kStep_s);
  EXPECT_LT((end.w_B - kStep_s * (J.inverse() * torque)).norm(), 1e-9);
}

TEST(JsbsimEngine, PrecessesAsEulerSays) {
  // Symmetric top: w_x + i w_y turns with (J3 - J1)/J1 w_z, closed form; JSBSim's first order in the rates leaves
  // h/2 of that rate squared.
  BodyState start;
  start.w_B = {1.0, 0.0, 4.0};
  const BodyState end = moved(body({0.1, 0.1, 0.15}), 0.0, start, {}, 1.0);
  EXPECT_NEAR(end.w_B.x(), std::cos(2.0), 0.5 * kStep_s * 4.0 * 1.2);
  EXPECT_NEAR(end.w_B.y(), std::sin(2.0), 0.5 * kStep_s * 4.0 * 1.2);
}

/// Motors off, from 1 m: the fall, the contact, the rebounds and the rest. @returns the highest speed downwards.
double dropped(const sim::Vehicle& vehicle, sim::PhysicsEngine* engine,
               std::vector<double>& height_m) {
  const sim::Multirotor forces{sim::read_multirotor(vehicle.root())};
  sim::RigidBody dynamics(vehicle.body(), vehicle.ground(), vehicle.environment(), forces,
                          sim::RandomSource{1});
  if (engine != nullptr) dynamics.set_engine(*engine);
  BodyState start;
  start.p_W.z() = -1.0;
  start.q_WB = Quaternion(Eigen::AngleAxisd(0.1, Vector3::UnitX()));
  EXPECT_TRUE(dynamics.set_state(start));
  double fastest_m_s = 0.0;
  while (dynamics.truth().time < std::chrono::seconds(3)) {
    dynamics.step(dynamics.truth().time + std::chrono::microseconds(2500), {});
    const BodyState& body = dynamics.truth().body;
    height_m.push_back(-body.p_W.z());
    fastest_m_s = std::max(fastest_m_s, (body.q_WB * body.v_B).z());
  }
  EXPECT_TRUE(dynamics.truth().on_ground);
  return fastest_m_s;
}

TEST(JsbsimEngine, FallsReboundsAndRestsOnOurGround) {
  const sim::Vehicle vehicle = sim::Vehicle::from_file("vehicles/multirotor.yaml");
  JsbsimEngine engine(vehicle.body(), vehicle.environment().gravity_m_s2,
                      JsbsimEngine::Options::of_project());
  std::vector<double> ours_m;
  std::vector<double> theirs_m;
  EXPECT_NEAR(dropped(vehicle, nullptr, ours_m), dropped(vehicle, &engine, theirs_m), 0.01);
  ASSERT_EQ(ours_m.size(), theirs_m.size());
  for (std::size_t k = 0; k < ours_m.size(); ++k) EXPECT_NEAR(ours_m[k], theirs_m[k], 0.01) << k;
  EXPECT_NEAR(ours_m.back(), theirs_m.back(), 1e-5);
}

/// What an engine with this program says when it starts, or when it steps.
std::string complaint(const JsbsimEngine::Options& options,
                      const std::function<void(JsbsimEngine&)>& use = {}) {
  try {
    JsbsimEngine engine(body(), kGravity_m_s2, options);
    if (use) use(engine);
  } catch (const boards::EmulatorError& error) {
    return error.what();
  }
  return "none";
}

/// A program in Python in place of jsbsim_engine.py.
JsbsimEngine::Options with_program(const std::string& text) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "engine.py";
  std::ofstream(file) << text;
  JsbsimEngine::Options options = JsbsimEngine::Options::of_project();
  options.script = file;
  options.timeout = options.start_timeout = std::chrono::milliseconds(300);
  return options;
}

TEST(JsbsimEngine, AProgramThatEndsIsOneLine) {
  JsbsimEngine::Options options = with_program("import sys; sys.exit(3)");
  options.start_timeout = std::chrono::seconds(20);
  EXPECT_EQ(complaint(options),
            "--physics jsbsim: its program ended with status 3; it printed nothing");
}

TEST(JsbsimEngine, AProgramThatHangsIsEnded) {
  EXPECT_EQ(complaint(with_program("import time; time.sleep(60)")),
            "--physics jsbsim: no answer for 300 ms; it printed nothing");
}

TEST(JsbsimEngine, AnEnvironmentWithoutJsbsimIsOneLine) {
  JsbsimEngine::Options options = JsbsimEngine::Options::of_project();
  options.python = "/usr/bin/python3";
  EXPECT_EQ(complaint(options), "--physics jsbsim: ModuleNotFoundError: No module named 'jsbsim'");
}

TEST(JsbsimEngine, AnInterpreterThatIsMissingIsOneLine) {
  JsbsimEngine::Options options = JsbsimEngine::Options::of_project();
  options.python = "/nowhere/python3";
  EXPECT_EQ(complaint(options),
            "--physics jsbsim: its program ended with status 127; it printed nothing");
}

/// The state that the kernel shows after the name: stopped, or ended and not yet waited for.
bool ended_or_stopped(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const char state = text.at(text.rfind(')') + 2);
  return state == 'T' || state == 'Z';
}

TEST(JsbsimEngine, OneThatIsKilledOrStopsIsReported) {
  JsbsimEngine::Options options = JsbsimEngine::Options::of_project();
  options.timeout = std::chrono::milliseconds(500);
  for (const int signal : {SIGKILL, SIGSTOP}) {
    pid_t process = 0;
    const std::string said = complaint(options, [&](JsbsimEngine& engine) {
      engine.set_state({});
      engine.step(kStep_s, {});
      process = engine.process();
      ::kill(process, signal);
      while (!ended_or_stopped(process)) ::usleep(1000);
      engine.step(kStep_s, {});
    });
    EXPECT_EQ(said, signal == SIGKILL
                        ? "--physics jsbsim: its program was ended by signal 9; it printed nothing"
                        : "--physics jsbsim: no answer for 500 ms; it printed nothing");
    EXPECT_NE(::kill(process, 0), 0);  // nothing is left of it
  }
}

TEST(JsbsimEngine, EndsWithItsOwner) {
  pid_t process = 0;
  EXPECT_EQ(complaint(JsbsimEngine::Options::of_project(),
                      [&](JsbsimEngine& engine) { process = engine.process(); }),
            "none");
  EXPECT_NE(::kill(process, 0), 0);
}

}  // namespace
}  // namespace rosflight::flight
