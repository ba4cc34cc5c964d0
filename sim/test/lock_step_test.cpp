// SPDX-License-Identifier: BSD-3-Clause
#include "sim/lock_step.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim/time_sources.hpp"

namespace rosflight::sim {
namespace {

/// Modules that write down when they are called and with what.
using Journal = std::vector<std::string>;

std::string at(const char* what, Time t) {
  return std::string(what) + " " + std::to_string(t.count());
}

class FakeRc : public RcModule {
 public:
  explicit FakeRc(Journal& journal) : journal_{journal} {}
  bool step(Time t, hal::RcFrame& frame) override {
    journal_.push_back(at("rc", t));
    frame.stamp = t;
    return t.count() % 20'000 == 0;
  }

 private:
  Journal& journal_;
};

class FakeSensors : public SensorsModule {
 public:
  explicit FakeSensors(Journal& journal) : journal_{journal} {}
  void step(const Truth& truth, SensorSamples& samples) override {
    journal_.push_back(at("sensors", truth.time));
    samples.has_imu = true;
    samples.imu.stamp = truth.time;
  }

 private:
  Journal& journal_;
};

class FakeAutopilot : public AutopilotModule {
 public:
  explicit FakeAutopilot(Journal& journal) : journal_{journal} {}
  const hal::OutputValues& step(Time t, const SensorSamples& samples,
                                const hal::RcFrame* rc) override {
    journal_.push_back(at("board", t) + (rc != nullptr ? " with rc" : ""));
    EXPECT_TRUE(samples.has_imu);
    EXPECT_EQ(samples.imu.stamp, t);
    if (rc != nullptr) {
      EXPECT_EQ(rc->stamp, t);
    }
    outputs_[0] = static_cast<float>(t.count());
    return outputs_;
  }

 private:
  Journal& journal_;
  hal::OutputValues outputs_{};
};

class FakeDynamics : public Dynamics {
 public:
  FakeDynamics(Journal& journal, Time start) : journal_{journal} { truth_.time = start; }
  void step(Time t, const hal::OutputValues& outputs) override {
    journal_.push_back(at("dynamics", t));
    EXPECT_EQ(outputs[0], static_cast<float>(truth_.time.count()));
    truth_.time = t;
  }
  const Truth& truth() const override { return truth_; }
  bool set_state(const BodyState& /*state*/) override { return false; }

 private:
  Journal& journal_;
  Truth truth_;
};

class FakeVisualiser : public Visualiser {
 public:
  FakeVisualiser(Journal& journal, const char* name) : journal_{journal}, name_{name} {}
  void step(const Truth& truth, const hal::OutputValues& outputs) override {
    journal_.push_back(at(name_, truth.time) + " outputs of " +
                       std::to_string(static_cast<int>(outputs[0])));
  }

 private:
  Journal& journal_;
  const char* name_;
};

class FakeListener : public LockStepListener {
 public:
  explicit FakeListener(Journal& journal) : journal_{journal} {}
  void before_step(Time t) override { journal_.push_back(at("before", t)); }
  void after_autopilot(Time t, const hal::OutputValues& outputs) override {
    journal_.push_back(at("companion", t));
    EXPECT_EQ(outputs[0], static_cast<float>(t.count()));
  }

 private:
  Journal& journal_;
};

struct World {
  explicit World(Time start = Time{0}) : dynamics{journal, start} {}

  Journal journal;
  LockStepTime time{Time{2500}};
  FakeRc rc{journal};
  FakeSensors sensors{journal};
  FakeAutopilot board{journal};
  FakeDynamics dynamics;
  LockStep loop{time, rc, sensors, board, dynamics};
};

TEST(LockStep, CallsEveryModuleOnceInTheDocumentedOrder) {
  World world;
  FakeVisualiser log(world.journal, "log");
  FakeVisualiser view(world.journal, "view");
  FakeListener listener(world.journal);
  world.loop.add(log);
  world.loop.add(view);
  world.loop.set_listener(&listener);
  world.loop.step();
  world.loop.step();
  const Journal expected{"before 0",
                         "rc 0",
                         "sensors 0",
                         "board 0 with rc",
                         "companion 0",
                         "dynamics 2500",
                         "log 2500 outputs of 0",
                         "view 2500 outputs of 0",
                         "before 2500",
                         "rc 2500",
                         "sensors 2500",
                         "board 2500",
                         "companion 2500",
                         "dynamics 5000",
                         "log 5000 outputs of 2500",
                         "view 5000 outputs of 2500"};
  EXPECT_EQ(world.journal, expected);
}

TEST(LockStep, SubstepsAreTurnsOfSensorsAutopilotAndDynamicsAlone) {
  World world;
  FakeVisualiser log(world.journal, "log");
  world.loop.add(log);
  world.loop.set_substeps(5, Time{500});
  world.loop.step();
  const Journal expected{"rc 0",
                         "sensors 0",
                         "board 0 with rc",
                         "dynamics 500",
                         "sensors 500",
                         "board 500",
                         "dynamics 1000",
                         "sensors 1000",
                         "board 1000",
                         "dynamics 1500",
                         "sensors 1500",
                         "board 1500",
                         "dynamics 2000",
                         "sensors 2000",
                         "board 2000",
                         "dynamics 2500",
                         "log 2500 outputs of 2000"};
  EXPECT_EQ(world.journal, expected);
  EXPECT_EQ(world.loop.now(), Time{2500});
  EXPECT_EQ(world.loop.ticks(), 1U);
}

TEST(LockStep, RunsToATimeAndCounts) {
  World world;
  EXPECT_EQ(world.loop.run_until(Time{1'000'000}), 400U);
  EXPECT_EQ(world.loop.now(), Time{1'000'000});
  EXPECT_EQ(world.loop.ticks(), 400U);
  EXPECT_EQ(world.loop.run_until(Time{1'000'000}), 0U);
  EXPECT_EQ(world.loop.run_until(Time{1'000'001}), 1U);
  EXPECT_EQ(world.loop.now(), Time{1'002'500});
}

TEST(LockStep, StartsWhereTheWorldIs) {
  World world(Time{5000});
  world.loop.step();
  EXPECT_EQ(world.journal.front(), "rc 5000");
  EXPECT_EQ(world.loop.now(), Time{7500});
}

TEST(LockStep, ShowsTheFrameOfTheStepOnly) {
  World world;
  EXPECT_EQ(world.loop.rc_frame(), nullptr);
  world.loop.step();
  ASSERT_NE(world.loop.rc_frame(), nullptr);
  EXPECT_EQ(world.loop.rc_frame()->stamp, Time{0});
  EXPECT_TRUE(world.loop.samples().has_imu);
  world.loop.step();
  EXPECT_EQ(world.loop.rc_frame(), nullptr);
}

}  // namespace
}  // namespace rosflight::sim
