// SPDX-License-Identifier: BSD-3-Clause
#include "apps/viewer_commands.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "companion/test/rig.hpp"

namespace rosflight::apps {
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
      commands_.step(rig_.session, sim_time(),
                     [this](const flight::FlightNote& note) { notes_.push_back(note.text); });
    }
  }
  sim::Time sim_time() const { return std::chrono::duration_cast<sim::Time>(rig_.now); }
  /// The results of one command of viewer 2.
  std::vector<Desk::Result> ask(decltype(Desk::Command::what) what) {
    EXPECT_EQ(desk_.ask({2, "a", std::move(what)}), "");
    run(3s);
    const std::vector<Desk::Answer> answers = desk_.answers(2);
    EXPECT_EQ(answers.size(), 1U);
    return answers.empty() ? std::vector<Desk::Result>{} : answers[0].results;
  }

  companion::test::Rig rig_;
  Desk desk_;
  ViewerCommands commands_{desk_};
  std::vector<std::string> notes_;
};

TEST_F(ViewerCommandsTest, EachParameterSetHasAResultAndTheLogSaysWho) {
  const auto first = rig_.session.parameters().table()[0];
  const std::string name(companion::text_of(first.name));
  const auto results = ask(Desk::SetParameters{{{name, 7.0}, {"NO_SUCH", 1.0}}});
  ASSERT_EQ(results.size(), 2U);
  EXPECT_EQ(results[0].name, "NO_SUCH");
  EXPECT_FALSE(results[0].good);
  EXPECT_TRUE(results[1].good) << results[1].text;
  EXPECT_EQ(results[1].value, 7.0);
  EXPECT_EQ(rig_.session.parameters().get(name)->number(), 7.0);
  EXPECT_EQ(notes_, (std::vector<std::string>{"viewer 2 sets " + name + " 7 NO_SUCH 1"}));
  ASSERT_TRUE(desk_.parameters());
  EXPECT_TRUE(desk_.parameters()->unsaved);
}

TEST_F(ViewerCommandsTest, AValueThatTheLinkCannotCarryIsNotSent) {
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
  const std::string name(companion::text_of(rig_.session.parameters().table()[0].name));
  ask(Desk::SetParameters{{{name, 7.0}}});
  const auto results = ask(Desk::WriteParameters{});
  ASSERT_EQ(results.size(), 1U);
  EXPECT_TRUE(results[0].good) << results[0].text;
  EXPECT_FALSE(desk_.parameters()->unsaved);
}

TEST_F(ViewerCommandsTest, WhatWaitsAtTheEndIsAnswered) {
  EXPECT_EQ(desk_.ask({2, "a", Desk::WriteParameters{}}), "");
  commands_.step(rig_.session, sim_time(), [](const flight::FlightNote&) {});
  commands_.end();
  ASSERT_EQ(desk_.answers(2).size(), 1U);
  EXPECT_EQ(desk_.ask({2, "b", Desk::WriteParameters{}}), "the flight has ended");
}

}  // namespace
}  // namespace rosflight::apps
