// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gazebo/gazebo_engine.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <vector>

#include "flight/gazebo/test/gazebo_rig.hpp"
#include "flight/vehicle_sdf.hpp"
#include "sim/dynamics/rigid_body.hpp"
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
using Options = GazeboEngine::Options;

class GazeboEngines : public WithGazebo {};

/// dartsim moves it for some seconds.
BodyState moved(double gravity_m_s2, const BodyState& start, const Load& load, double duration_s,
                double step_s = kStep_s, const std::string& model = box_sdf()) {
  GazeboEngine engine(model, gravity_m_s2, Options::of_project());
  engine.set_state(start);
  const auto steps = std::lround(duration_s / step_s);
  for (int i = 0; i < steps; ++i) engine.step(step_s, load);
  return engine.state();
}

TEST_F(GazeboEngines, ReadTheStateThatWasSet) {
  BodyState start;
  start.p_W = {3.0, -4.0, -120.0};
  start.q_WB = Quaternion(Eigen::AngleAxisd(2.5, Vector3(1, -2, 3).normalized()));
  start.v_B = {10.0, -1.0, 2.0};
  start.w_B = {0.3, -0.2, 0.5};
  GazeboEngine engine(box_sdf(), kGravity_m_s2, Options::of_project());
  engine.set_state(start);
  EXPECT_LT((engine.state().p_W - start.p_W).norm(), 1e-12);
  EXPECT_LT(engine.state().q_WB.angularDistance(start.q_WB),
            1e-7);                                      // rounding of the arc cosine near 1
  EXPECT_GT(engine.state().q_WB.dot(start.q_WB), 0.0);  // and not its negative
  EXPECT_LT((engine.state().v_B - start.v_B).norm(), 1e-12);
  EXPECT_LT((engine.state().w_B - start.w_B).norm(), 1e-12);
  EXPECT_EQ(engine.contact(), nullptr);  // the ground of the vehicle file is part of the load
}

TEST_F(GazeboEngines, ThrowAParabolaWithAPositionOfFirstOrder) {
  BodyState start;
  start.p_W.z() = -50.0;
  start.v_B = {3.0, 0.0, -5.0};
  const Vector3 a(2.0, -3.0, kGravity_m_s2);  // 4 N and -6 N on 2 kg
  for (const double step_s : {kStep_s, 0.5 * kStep_s}) {
    const BodyState end =
        moved(kGravity_m_s2, start, {{4.0, -6.0, 0.0}, Vector3::Zero()}, 1.0, step_s);
    EXPECT_LT((end.v_B - (start.v_B + a)).norm(), 1e-9);
    // Semi-implicit Euler: p_n = p_0 + n h v_0 + h^2 a n (n + 1)/2, in closed form.
    const Vector3 exact = start.p_W + start.v_B + 0.5 * a;
    EXPECT_LT((end.p_W - (exact + 0.5 * step_s * a)).norm(), 1e-9) << step_s;
  }
}

TEST_F(GazeboEngines, TurnByHalfAlphaTSquared) {
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 unit = Vector3::Unit(axis);
    const Vector3 J(0.08, 0.10, 0.15);
    const BodyState end = moved(0.0, {}, {Vector3::Zero(), 2.0 * J(axis) * unit}, 1.0);
    EXPECT_LT((end.w_B - 2.0 * unit).norm(), 1e-9) << axis;
    // First order here too: the angle leads by h w/2.
    const Quaternion expected(Eigen::AngleAxisd(1.0 + 0.5 * kStep_s * 2.0, unit));
    EXPECT_LT(end.q_WB.angularDistance(expected), 1e-6) << axis;
  }
}

TEST_F(GazeboEngines, HaveTheInertiaMatrixOfTheVehicle) {
  const std::vector<std::string> overrides{
      "body.inertia_kg_m2.xy=0.01", "body.inertia_kg_m2.xz=-0.02", "body.inertia_kg_m2.yz=0.015"};
  const auto vehicle = sim::Vehicle::from_file("vehicles/multirotor.yaml", overrides);
  const Vector3 torque(0.1, -0.2, 0.3);
  const BodyState end = moved(0.0, {}, {Vector3::Zero(), torque}, kStep_s, kStep_s,
                              vehicle_sdf(vehicle, "vehicle", SdfModel::kOneLink));
  const Vector3 expected = kStep_s * (vehicle.body().inertia_kg_m2.inverse() * torque);
  EXPECT_LT((end.w_B - expected).norm(), 1e-9);
}

TEST_F(GazeboEngines, PrecessAsEulerSays) {
  // Symmetric top: w_x + i w_y turns with (J3 - J1)/J1 w_z, closed form; first order in the rates leaves
  // h/2 of that rate squared.
  BodyState start;
  start.w_B = {1.0, 0.0, 4.0};
  const BodyState end =
      moved(0.0, start, {}, 1.0, kStep_s, box_sdf("<ixx>0.1</ixx><iyy>0.1</iyy><izz>0.15</izz>"));
  EXPECT_NEAR(end.w_B.x(), std::cos(2.0), 0.5 * kStep_s * 4.0 * 1.2);
  EXPECT_NEAR(end.w_B.y(), std::sin(2.0), 0.5 * kStep_s * 4.0 * 1.2);
}

/// Motors off, from 1 m: the fall, the contact, the rebounds and the rest. @returns the highest speed downwards.
double dropped_from_1_m(const sim::Vehicle& vehicle, sim::PhysicsEngine* engine,
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

TEST_F(GazeboEngines, FallReboundAndRestOnOurGround) {
  const sim::Vehicle vehicle = sim::Vehicle::from_file("vehicles/multirotor.yaml");
  GazeboEngine engine(vehicle_sdf(vehicle, "vehicle", SdfModel::kOneLink),
                      vehicle.environment().gravity_m_s2, Options::of_project());
  std::vector<double> ours_m;
  std::vector<double> theirs_m;
  EXPECT_NEAR(dropped_from_1_m(vehicle, nullptr, ours_m),
              dropped_from_1_m(vehicle, &engine, theirs_m), 0.1);
  ASSERT_EQ(ours_m.size(), theirs_m.size());
  // h v/2 at 4 m/s is 5 mm, on the way down and up again.
  for (std::size_t k = 0; k < ours_m.size(); ++k) EXPECT_NEAR(ours_m[k], theirs_m[k], 0.012) << k;
  EXPECT_NEAR(ours_m.back(), theirs_m.back(), 1e-5);
}

/// A shell script in place of gazebo_engine.
Options with_script(const std::string& text) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "engine.sh";
  std::ofstream(file) << "#!/bin/sh\n" << text << "\n";
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  Options options;
  options.program = file;
  options.timeout = options.start_timeout = std::chrono::milliseconds(300);
  return options;
}

TEST(GazeboEngine, AProgramThatEndsIsOneLine) {
  Options options = with_script("exit 3");
  options.start_timeout = std::chrono::seconds(20);
  EXPECT_EQ(gazebo_complaint(options),
            "--physics gazebo: its program ended with status 3; it printed nothing");
}

TEST(GazeboEngine, AProgramThatHangsIsEnded) {
  EXPECT_EQ(gazebo_complaint(with_script("exec sleep 60")),
            "--physics gazebo: no answer for 300 ms; it printed nothing");
}

TEST_F(GazeboEngines, ALibraryThatIsMissingIsOneLine) {
  // The dynamic linker finds an empty file in place of Gazebo's library of SDF.
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "libraries";
  std::filesystem::create_directories(folder);
  for (const char* name : {"libsdformat12.so.12", "libsdformat14.so.14"})
    std::ofstream(folder / name).flush();
  ::setenv("LD_LIBRARY_PATH", folder.c_str(), 1);
  const std::string said = gazebo_complaint(Options::of_project());
  ::unsetenv("LD_LIBRARY_PATH");
  EXPECT_EQ(said.rfind("--physics gazebo: its program ended with status 127; its last output: ", 0),
            0U)
      << said;
  EXPECT_NE(said.find("libsdformat1"), std::string::npos) << said;
  EXPECT_EQ(said.find('\n'), std::string::npos);
}

/// The state that the kernel shows after the name: stopped, or ended and not yet waited for.
bool ended_or_stopped(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const char state = text.at(text.rfind(')') + 2);
  return state == 'T' || state == 'Z';
}

TEST_F(GazeboEngines, ThatAreKilledOrStopAreReported) {
  Options options = Options::of_project();
  options.timeout = std::chrono::milliseconds(500);
  for (const int signal : {SIGKILL, SIGSTOP}) {
    pid_t process = 0;
    const std::string said = gazebo_complaint(options, [&](GazeboEngine& engine) {
      engine.set_state({});
      engine.step(kStep_s, {});
      process = engine.process();
      ::kill(process, signal);
      while (!ended_or_stopped(process)) ::usleep(1000);
      engine.step(kStep_s, {});
    });
    EXPECT_EQ(said, signal == SIGKILL
                        ? "--physics gazebo: its program was ended by signal 9; it printed nothing"
                        : "--physics gazebo: no answer for 500 ms; it printed nothing");
    EXPECT_NE(::kill(process, 0), 0);  // nothing is left of it
  }
}

TEST_F(GazeboEngines, EndWithTheirOwner) {
  pid_t process = 0;
  EXPECT_EQ(gazebo_complaint(Options::of_project(),
                             [&](GazeboEngine& engine) { process = engine.process(); }),
            "none");
  EXPECT_NE(::kill(process, 0), 0);
}

TEST_F(GazeboEngines, RejectAModelWithoutTheirLink) {
  EXPECT_EQ(gazebo_complaint(Options::of_project(), {},
                             "<sdf version='1.9'><model name='m'><link name='a'/></model></sdf>"),
            "--physics gazebo: the vehicle's SDF has no model with a link base_link");
}

}  // namespace
}  // namespace rosflight::flight
