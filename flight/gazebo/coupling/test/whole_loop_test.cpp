// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gazebo/coupling/whole_loop.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "flight/gazebo/test/gazebo_rig.hpp"
#include "flight/vehicle_sdf.hpp"
#include "sim/dynamics/runge_kutta_engine.hpp"

namespace rosflight::flight::gazebo {
namespace {

using sim::Vector3;
using std::chrono::nanoseconds;

/// A world that is one plane, as `./rosflight sdf --world` has it.
std::string plane() {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "plane.sdf";
  std::ofstream(file)
      << "<sdf version='1.9'><world name='w'><model name='ground'><static>true</static>"
         "<link name='l'><collision name='c'><geometry><plane><normal>0 0 1</normal></plane>"
         "</geometry></collision></link></model></world></sdf>";
  return file;
}

/// Gazebo's engine dartsim as a simulator that steps by itself, with the calls of a plugin.
class DartSimulator {
 public:
  DartSimulator(const std::string& vehicle, nanoseconds step)
      : step_{step}, engine_{model(vehicle), 9.80665, options()} {
    engine_.set_state(
        {Vector3(0.0, 0.0, -1.0), sim::Quaternion::Identity(), Vector3::Zero(), Vector3::Zero()});
  }

  void iterate(LinkCoupling& coupling) {
    reached_ += step_;
    const LinkCoupling::Time time{reached_, step_, false};
    const StepCommand command = coupling.before_step(time);
    stopped_ = stopped_ || command.run == Run::kStop;
    sim::PhysicsEngine::Load load;
    if (command.place) {
      engine_.set_state(body_of(*command.place, Vector3::Zero()));
    } else {
      load.force_W = messages::enu(command.wrench.force_G);
      load.torque_B = engine_.state().q_WB.conjugate() * messages::enu(command.wrench.torque_G);
    }
    engine_.step(std::chrono::duration<double>(step_).count(), load);
    coupling.after_step(time, link_of(engine_.state(), Vector3::Zero()));
  }
  bool stopped() const { return stopped_; }

 private:
  static std::string model(const std::string& vehicle) {
    return vehicle_sdf(sim::Vehicle::from_file("vehicles/" + vehicle + ".yaml"), "vehicle",
                       SdfModel::kOneLink);
  }
  static GazeboEngine::Options options() {
    GazeboEngine::Options options = GazeboEngine::Options::of_project();
    options.world_file = plane();
    return options;
  }

  nanoseconds step_;
  nanoseconds reached_{0};
  GazeboEngine engine_;
  bool stopped_{false};
};

class WholeLoops : public WithGazebo {
 protected:
  void fly(const std::string& vehicle, const std::string& mission,
           nanoseconds step = Flight::kStep) {
    WholeLoop::Options options;
    options.choice.vehicle = vehicle;
    options.choice.mission = mission;
    options.at_end = Run::kStop;
    options.log_file = log;
    const LinkCoupling::Say say = [this](const std::string& line) { said.push_back(line); };
    auto made = std::make_unique<WholeLoop>(options, say);
    const WholeLoop& loop = *made;
    LinkCoupling coupling(std::move(made), say);
    DartSimulator simulator(vehicle, step);
    for (int k = 0; k < 1'000'000 && !simulator.stopped() && coupling.works(); ++k)
      simulator.iterate(coupling);
    ASSERT_TRUE(coupling.works()) << said.back();
    score = loop.flight().score();
    tracking_m = loop.flight().tracking().rms();
  }
  std::vector<std::string> said;
  std::string log;
  FlightScore score;
  double tracking_m{};
};

TEST_F(WholeLoops, FlyTheMissionThatFlyDoes) {
  fly("multirotor", "default");
  EXPECT_TRUE(score.success()) << score.verdict;
  ASSERT_FALSE(said.empty());
  EXPECT_EQ(said.back().rfind("mission_done after ", 0), 0U) << said.back();
  FlightChoice choice;
  choice.physics = "gazebo";
  choice.world = plane();
  const FlightSetup setup(choice);
  Flight flight(setup);
  flight.run();
  // The same noise, load and engine. The vehicle is put down one step earlier, and settles on its gear then.
  EXPECT_NEAR(tracking_m, flight.tracking().rms(), 0.005);
}

TEST_F(WholeLoops, FlyAFixedWing) {
  fly("anaconda", "default");
  EXPECT_TRUE(score.success()) << score.verdict;
}

TEST_F(WholeLoops, HoldTheLoadOverSmallerStepsOfTheSimulator) {
  fly("multirotor", "hop", std::chrono::microseconds(500));
  EXPECT_TRUE(score.success()) << score.verdict;
}

TEST_F(WholeLoops, WriteALog) {
  log = testing::TempDir() + "/whole_loop.mcap";
  fly("multirotor", "hop");
  EXPECT_TRUE(score.success()) << score.verdict;
  std::ifstream file(log, std::ios::binary);
  std::string magic(8, '\0');
  file.read(magic.data(), 8);
  EXPECT_EQ(magic, "\x89MCAP0\r\n");
  EXPECT_GT(std::filesystem::file_size(log), 100'000U);
}

TEST(Flight, InTwoHalvesIsTheSameToTheBit) {
  FlightChoice choice;
  choice.mission = "hop";
  choice.wind = "4,270,3";
  choice.physics = "runge_kutta_held";
  const FlightSetup setup(choice);
  Flight whole(setup);
  auto made = std::make_unique<sim::RungeKuttaEngine>(setup.vehicle.body(),
                                                      setup.vehicle.environment().gravity_m_s2);
  sim::PhysicsEngine& engine = *made;
  FlightParts parts;
  parts.engine = std::move(made);
  Flight halves(setup, std::move(parts));
  while (!whole.finished()) {
    whole.step();
    const sim::PhysicsEngine::Load load = halves.begin_step();
    engine.step(sim::to_seconds(Flight::kStep), load);
    halves.end_step();
    ASSERT_EQ(halves.truth().body.p_W, whole.truth().body.p_W);
    ASSERT_EQ(halves.truth().specific_force_B, whole.truth().specific_force_B);
  }
  EXPECT_TRUE(whole.score().success());
  EXPECT_TRUE(halves.finished());
}

TEST(Flight, HasNoHalvesWithoutAnEngineOfItsOwner) {
  FlightChoice choice;
  choice.mission = "hop";
  const FlightSetup setup(choice);
  Flight flight(setup);
  EXPECT_THROW(flight.begin_step(), std::logic_error);
}

std::string complaint(const WholeLoop::Options& options) {
  try {
    WholeLoop loop(options, [](const std::string&) {});
  } catch (const config::Error& error) {
    return error.what();
  }
  return "none";
}

TEST(WholeLoop, BadInputIsOneLine) {
  WholeLoop::Options options;
  options.choice.vehicle = "/nowhere/vehicle.yaml";
  EXPECT_NE(complaint(options).find("/nowhere/vehicle.yaml"), std::string::npos);
  options.choice.vehicle = "multirotor";
  options.choice.board = "varmint";
  EXPECT_EQ(complaint(options),
            "board: found varmint with link cable, allowed in_process and cable");
  options.choice.board = "in_process";
  options.choice.overrides = {"body.max_step_s=0.0005"};
  EXPECT_EQ(complaint(options), "body.max_step_s: found 0.0005, allowed 0.0025 or more in Gazebo");
}

}  // namespace
}  // namespace rosflight::flight::gazebo
