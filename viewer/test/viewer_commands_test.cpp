// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/viewer_commands.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "companion/test/rig.hpp"
#include "config/strict_yaml.hpp"

namespace rosflight::viewer {
namespace {

using Desk = web::server::CommandDesk;
using namespace std::chrono_literals;

class ViewerCommandsTest : public testing::Test {
 protected:
  ViewerCommandsTest() { run(2s); }

  void run(std::chrono::microseconds time) {
    const auto end = rig_.now + time;
    while (rig_.now < end) {
      rig_.step();
      commands_.step(rig_.session, log_);
    }
  }
  /// The results of one command of viewer 2.
  std::vector<Desk::Result> ask(Desk::What what) {
    EXPECT_EQ(desk_.ask({2, "a", std::move(what)}), "");
    run(3s);
    const std::vector<Desk::Answer> answers = desk_.answers(2);
    EXPECT_EQ(answers.size(), 1U);
    return answers.empty() ? std::vector<Desk::Result>{} : answers[0].results;
  }

  void take_control() {
    ask(Desk::TakeControl{});
    notes_.clear();
  }

  companion::test::Rig rig_;
  Desk desk_;
  std::vector<std::string> changes_;  ///< Changes of the simulation, in order.
  ViewerCommands commands_{desk_, [this](const std::string& text) -> std::function<void()> {
                             if (text == "bad") throw config::Error("bad change");
                             return [this, text] { changes_.push_back(text); };
                           }};
  std::vector<std::string> notes_;
  ViewerCommands::Log log_ = [this](std::uint64_t viewer, const std::string& text) {
    notes_.push_back(std::to_string(viewer) + " " + text);
  };
};

TEST_F(ViewerCommandsTest, EachParameterSetHasAResultAndTheLogSaysWho) {
  take_control();
  const auto first = rig_.session.parameters().table()[0];
  const std::string name(companion::text_of(first.name));
  const auto results = ask(Desk::SetParameters{{{name, 7.0}, {"NO_SUCH", 1.0}}});
  ASSERT_EQ(results.size(), 2U);
  EXPECT_EQ(results[0].name, "NO_SUCH");
  EXPECT_FALSE(results[0].good);
  EXPECT_TRUE(results[1].good) << results[1].text;
  EXPECT_EQ(results[1].value, 7.0);
  EXPECT_EQ(rig_.session.parameters().get(name)->number(), 7.0);
  EXPECT_EQ(notes_, (std::vector<std::string>{"2 sets " + name + " 7 NO_SUCH 1"}));
  ASSERT_TRUE(desk_.parameters());
  EXPECT_TRUE(desk_.parameters()->unsaved);
}

TEST_F(ViewerCommandsTest, AValueThatTheLinkCannotCarryIsNotSent) {
  take_control();
  const companion::ParameterTable& table = rig_.session.parameters().table();
  for (std::size_t k = 0; k < table.count(); ++k) {
    const bool whole = table[k].value.type == link::ParamType::kInt32;
    const std::string name(companion::text_of(table[k].name));
    const auto results = ask(Desk::SetParameters{{{name, whole ? 0.5 : 1e300}}});
    ASSERT_EQ(results.size(), 1U);
    EXPECT_FALSE(results[0].good) << name;
  }
}

TEST_F(ViewerCommandsTest, WritingSaves) {
  take_control();
  const std::string name(companion::text_of(rig_.session.parameters().table()[0].name));
  ask(Desk::SetParameters{{{name, 7.0}}});
  const auto results = ask(Desk::WriteParameters{});
  ASSERT_EQ(results.size(), 1U);
  EXPECT_TRUE(results[0].good) << results[0].text;
  EXPECT_FALSE(desk_.parameters()->unsaved);
}

TEST_F(ViewerCommandsTest, WhatWaitsAtTheEndIsAnswered) {
  take_control();
  EXPECT_EQ(desk_.ask({2, "a", Desk::WriteParameters{}}), "");
  commands_.step(rig_.session, log_);
  commands_.end("the flight has ended");
  const auto answers = desk_.answers(2);
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].results[0].text, "the flight has ended");
}

TEST_F(ViewerCommandsTest, OneViewerAtATimeSteersAndTakingOverIsLogged) {
  EXPECT_EQ(ask(Desk::Steer{"wind 5,0"})[0].text, "take control first");
  EXPECT_TRUE(ask(Desk::TakeControl{})[0].good);
  EXPECT_TRUE(ask(Desk::Steer{"wind 5,0"})[0].good);
  EXPECT_EQ(ask(Desk::Steer{"bad"})[0].text, "bad change");
  EXPECT_EQ(desk_.ask({3, "t", Desk::TakeControl{}}), "");
  run(1s);
  EXPECT_EQ(ask(Desk::Steer{"wind 9,0"})[0].text, "viewer 3 has control");
  desk_.forget(3);
  run(1s);
  EXPECT_EQ(commands_.in_control(), 0U);
  EXPECT_EQ(changes_, (std::vector<std::string>{"wind 5,0"}));
  EXPECT_EQ(notes_, (std::vector<std::string>{
                        "2 is refused: steers: wind 5,0: take control first", "2 takes control",
                        "2 steers: wind 5,0", "2 is refused: steers: bad: bad change",
                        "3 takes control from viewer 2",
                        "2 is refused: steers: wind 9,0: viewer 3 has control", "3 is gone"}));
}

TEST_F(ViewerCommandsTest, WithoutControlASimulatedVehicleIsLookedAtAlone) {
  const std::string name(companion::text_of(rig_.session.parameters().table()[0].name));
  const std::vector<std::pair<Desk::What, std::string>> changes{
      {Desk::SetParameters{{{name, 7.0}}}, "sets " + name + " 7"},
      {Desk::WriteParameters{}, "writes the parameters"},
      {Desk::TestMotor{3, 0.1}, "tests motor 3 0.1"},
      {Desk::Calibrate{"gyro"}, "calibrates gyro"}};
  for (const auto& [what, text] : changes) {
    notes_.clear();
    const auto results = ask(what);
    ASSERT_EQ(results.size(), 1U) << text;
    EXPECT_FALSE(results[0].good) << text;
    EXPECT_EQ(results[0].text, "take control first") << text;
    ASSERT_EQ(notes_, (std::vector<std::string>{"2 is refused: " + text + ": take control first"}));
    EXPECT_TRUE(is_refusal(notes_[0].substr(2)));
    EXPECT_FALSE(parse_command(notes_[0].substr(2))) << "it is not repeated as a command";
  }
  EXPECT_NE(rig_.session.parameters().get(name)->number(), 7.0);
  notes_.clear();
  EXPECT_TRUE(ask(Desk::ReportChecks{})[0].good);
  EXPECT_EQ(notes_, (std::vector<std::string>{"2 asks for the checks before arming"}));
}

TEST_F(ViewerCommandsTest, EveryKindOfCommandIsInTheLogWithItsViewer) {
  take_control();
  const std::string name(companion::text_of(rig_.session.parameters().table()[0].name));
  const std::vector<std::pair<Desk::What, std::string>> all{
      {Desk::SetParameters{{{name, 7.0}}}, "2 sets " + name + " 7"},
      {Desk::WriteParameters{}, "2 writes the parameters"},
      {Desk::ReportChecks{}, "2 asks for the checks before arming"},
      {Desk::TakeControl{}, "2 takes control"},
      {Desk::Steer{"wind 5,0"}, "2 steers: wind 5,0"},
      {Desk::TestMotor{3, 0.1}, "2 tests motor 3 0.1"},
      {Desk::Calibrate{"baro"}, "2 calibrates baro"}};
  EXPECT_EQ(all.size() + 1, std::variant_size_v<Desk::What>) << "one that is gone follows";
  for (const auto& [what, line] : all) {
    notes_.clear();
    EXPECT_EQ(desk_.ask({2, "a", what}), "");
    run(10ms);
    EXPECT_EQ(notes_, (std::vector<std::string>{line}));
  }
  notes_.clear();
  desk_.forget(2);
  run(10ms);
  EXPECT_EQ(notes_, (std::vector<std::string>{"2 is gone"}));
}

TEST_F(ViewerCommandsTest, OfARealVehicleNothingIsChangedWithoutControlAndNothingSteered) {
  ViewerCommands real(desk_);
  const auto refused = [&](std::uint64_t viewer, Desk::What what) {
    EXPECT_EQ(desk_.ask({viewer, "a", std::move(what)}), "");
    real.step(rig_.session, log_);
    const auto answers = desk_.answers(viewer);
    return answers.empty() ? std::string() : answers[0].results[0].text;
  };
  EXPECT_EQ(refused(1, Desk::WriteParameters{}), "take control first");
  EXPECT_EQ(refused(1, Desk::SetParameters{{{"PID_ROLL_RATE_P", 1.0}}}), "take control first");
  EXPECT_EQ(refused(1, Desk::TestMotor{0, 0.1}), "take control first");
  EXPECT_EQ(refused(1, Desk::TakeControl{}), "in control");
  EXPECT_EQ(refused(1, Desk::TestMotor{0, 0.1}), "sent");
  EXPECT_EQ(refused(1, Desk::Steer{"switch arm on"}), "a real vehicle cannot be steered from here");
}

TEST_F(ViewerCommandsTest, ACalibrationByHandIsRunByTheOwnerAndLoggedLineByLine) {
  ViewerCommands real(desk_);
  real.set_procedures({"mag", "rc"});
  const auto ask_for = [&](std::uint64_t viewer, Desk::What what) {
    EXPECT_EQ(desk_.ask({viewer, "a", std::move(what)}), "");
    real.step(rig_.session, log_);
    const auto answers = desk_.answers(viewer);
    return answers.empty() ? std::string() : answers[0].results[0].text;
  };
  EXPECT_EQ(ask_for(1, Desk::Calibrate{"mag"}), "take control first");
  ask_for(1, Desk::TakeControl{});
  EXPECT_EQ(ask_for(1, Desk::Calibrate{"esc_props_off"}),
            "allowed: gyro, accel, baro, airspeed, mag, rc");
  EXPECT_EQ(
      notes_.back(),
      "1 is refused: calibrates esc_props_off: allowed: gyro, accel, baro, airspeed, mag, rc");
  EXPECT_EQ(ask_for(1, Desk::Calibrate{"stop"}), "no calibration runs");
  EXPECT_FALSE(real.begin_procedure());
  EXPECT_EQ(ask_for(1, Desk::Calibrate{"mag"}), "");
  EXPECT_FALSE(real.procedure_stopped());
  EXPECT_EQ(real.begin_procedure(), "mag");
  EXPECT_FALSE(real.begin_procedure());
  EXPECT_EQ(ask_for(1, Desk::Calibrate{"gyro"}), "mag is being calibrated");
  real.log_line("nose down", log_);
  EXPECT_EQ(notes_.back(), "1 calibration: nose down");
  EXPECT_FALSE(parse_command("calibration: nose down"));
  EXPECT_FALSE(real.procedure_stopped());
  EXPECT_EQ(ask_for(1, Desk::Calibrate{"stop"}), "stopping");
  EXPECT_TRUE(real.procedure_stopped());
  real.end_procedure(false, "stopped");
  EXPECT_EQ(desk_.answers(1)[0].results[0].text, "stopped");
  EXPECT_FALSE(real.procedure_stopped());

  EXPECT_EQ(ask_for(1, Desk::Calibrate{"rc"}), "");
  EXPECT_EQ(real.begin_procedure(), "rc");
  ask_for(2, Desk::TakeControl{});
  EXPECT_TRUE(real.procedure_stopped());  // its viewer has no control any more
}

TEST(ViewerCommandTexts, AreReadBack) {
  const std::vector<ViewerCommands::What> all{
      Desk::SetParameters{{{"A", 0.1}, {"B", 1e-300}, {"C", 1.0 / 3.0}}},
      Desk::WriteParameters{},
      Desk::ReportChecks{},
      Desk::TakeControl{},
      Desk::Steer{"fault motor2_dead:5"},
      Desk::TestMotor{3, 0.1},
      Desk::Calibrate{"gyro"},
      Desk::Gone{}};
  for (const auto& what : all) {
    const auto read = parse_command(text_of(what));
    ASSERT_TRUE(read) << text_of(what);
    EXPECT_EQ(text_of(*read), text_of(what));
    EXPECT_EQ(read->index(), what.index());
  }
  const auto set = parse_command(text_of(all[0]));
  EXPECT_EQ(std::get<Desk::SetParameters>(*set).values[2].second, 1.0 / 3.0);
  EXPECT_FALSE(parse_command("sets A"));
  EXPECT_FALSE(parse_command("dances"));
  EXPECT_FALSE(parse_command("tests motor 2.7 0.1"));
}

}  // namespace
}  // namespace rosflight::viewer
