// SPDX-License-Identifier: BSD-3-Clause
#include "web/server/conversation.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace rosflight::web::server {
namespace {

constexpr std::array<std::uint8_t, 2> kCdr{1, 2};

class ConversationTest : public testing::Test {
 protected:
  ConversationTest() {
    live_.add_channel({"/state", "std_msgs/msg/Bool", "bool data", LiveData::Kind::kState});
    live_.add_channel({"/text", "std_msgs/msg/Bool", "bool data", LiveData::Kind::kEvent});
  }
  std::string token(Right right) const {
    return closed_.address(right).substr(closed_.address(right).find('#') + 1);
  }
  /// All that is to be sent now.
  static std::vector<std::string> all(Conversation& talk) {
    std::vector<std::string> heads;
    while (const auto frame = talk.next()) heads.push_back(frame->head);
    return heads;
  }

  LiveData live_;
  Admission open_{"", 1};
  Admission closed_{"127.0.0.2", 1};
  std::string session_{"s"};
};

TEST_F(ConversationTest, GreetsThenNamesChannelsThenSendsWhatIsWanted) {
  Conversation talk(live_, nullptr, open_, session_, 1);
  const std::vector<std::string> first = all(talk);
  ASSERT_EQ(first.size(), 2U);
  EXPECT_NE(first[0].find("serverInfo"), std::string::npos);
  EXPECT_NE(first[1].find("/text"), std::string::npos);
  live_.put(0, 5, kCdr);
  EXPECT_FALSE(talk.next());
  ASSERT_TRUE(
      talk.on_message(R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":1}]})", true));
  const auto frame = talk.next();
  ASSERT_TRUE(frame);
  EXPECT_FALSE(frame->is_text);
  EXPECT_EQ(frame->head.substr(0, 6), std::string("\x01\x07\0\0\0\x05", 6));
  EXPECT_EQ(frame->message->cdr.size(), kCdr.size());
}

TEST_F(ConversationTest, SaysNothingBeforeTheToken) {
  Conversation talk(live_, nullptr, closed_, session_, 1);
  EXPECT_FALSE(talk.next());
  const std::string shown = token(Right::kLook);
  EXPECT_TRUE(talk.on_message(R"({"op":"token","token":")" + shown + "\"}", true));
  EXPECT_EQ(all(talk).size(), 2U);
  Conversation stranger(live_, nullptr, closed_, session_, 1);
  EXPECT_FALSE(stranger.on_message(R"({"op":"token","token":""})", true));
  EXPECT_FALSE(stranger.next());
}

TEST_F(ConversationTest, WhatIsUnsubscribedMeanwhileIsNotSent) {
  Conversation talk(live_, nullptr, open_, session_, 1);
  all(talk);
  ASSERT_TRUE(
      talk.on_message(R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":2}]})", true));
  for (std::uint64_t t = 0; t < 3; ++t) live_.put(1, t, kCdr);
  EXPECT_TRUE(talk.next());
  ASSERT_TRUE(talk.on_message(R"({"op":"unsubscribe","subscriptionIds":[7]})", true));
  EXPECT_FALSE(talk.next());
}

TEST_F(ConversationTest, UnreadComplaintsEndIt) {
  Conversation talk(live_, nullptr, open_, session_, 1);
  all(talk);
  for (std::size_t k = 0; k < Conversation::kMaxUnreadTexts; ++k)
    ASSERT_TRUE(talk.on_message("nonsense", true)) << k;
  EXPECT_FALSE(talk.on_message("nonsense", false));
}

constexpr const char* kSet =
    R"({"op":"setParameters","id":"a","parameters":[{"name":"RC_F_CHN","value":5}]})";

TEST_F(ConversationTest, ACommandGoesToTheVehicleAndItsResultComesBack) {
  CommandDesk desk;
  Conversation talk(live_, &desk, open_, session_, 3);
  EXPECT_NE(all(talk)[0].find(R"("commands":"yes")"), std::string::npos);
  ASSERT_TRUE(talk.on_message(kSet, true));
  const auto commands = desk.commands();
  ASSERT_EQ(commands.size(), 1U);
  EXPECT_EQ(commands[0].viewer, 3U);
  const auto& set = std::get<CommandDesk::SetParameters>(commands[0].what);
  EXPECT_EQ(set.values, (decltype(set.values){{"RC_F_CHN", 5.0}}));
  desk.answer({3, "a", {{"RC_F_CHN", 4.0, false, "refused"}}});
  desk.answer({4, "a", {}});
  const std::vector<std::string> said = all(talk);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0],
            R"({"id":"a","op":"parameterValues","parameters":[{"name":"RC_F_CHN","type":"float64",)"
            R"("value":4.0}],"results":[{"good":false,"name":"RC_F_CHN","text":"refused"}]})");
}

TEST_F(ConversationTest, AnAnswerComesAfterTheMessagesBeforeIt) {
  CommandDesk desk;
  Conversation talk(live_, &desk, open_, session_, 1);
  all(talk);
  ASSERT_TRUE(
      talk.on_message(R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":2}]})", true));
  live_.put(1, 1, kCdr);
  live_.put(1, 2, kCdr);
  desk.answer({1, "a", {}});
  const std::vector<std::string> said = all(talk);
  ASSERT_EQ(said.size(), 3U);
  EXPECT_NE(said[2].find("parameterValues"), std::string::npos);
}

TEST_F(ConversationTest, WhoMayLookMayNotCommand) {
  for (const auto& [right, commands] : {std::pair{Right::kLook, 0U}, {Right::kCommand, 1U}}) {
    CommandDesk desk;
    Conversation talk(live_, &desk, closed_, session_, 1);
    ASSERT_TRUE(talk.on_message(R"({"op":"token","token":")" + token(right) + "\"}", true));
    all(talk);
    ASSERT_TRUE(talk.on_message(kSet, true));
    EXPECT_EQ(desk.commands().size(), commands);
    const std::vector<std::string> said = all(talk);
    EXPECT_EQ(said.size(), 1U - commands);
    if (!said.empty()) {
      EXPECT_NE(said[0].find("one to look"), std::string::npos);
    }
  }
}

TEST_F(ConversationTest, APageOfAnotherOriginMayLookNotCommand) {
  for (const Admission* admission : {&open_, &closed_}) {
    CommandDesk desk;
    desk.set_parameters({{{"RC_F_CHN", 4.0, false}}, false});
    Conversation talk(live_, &desk, *admission, session_, 1, Right::kLook);
    if (admission->wants_token()) {
      ASSERT_TRUE(
          talk.on_message(R"({"op":"token","token":")" + token(Right::kCommand) + "\"}", true));
    }
    EXPECT_NE(all(talk)[0].find(R"("commands":"no")"), std::string::npos);
    for (const char* command :
         {kSet, R"({"op":"writeParameters","id":"a"})", R"({"op":"takeControl","id":"a"})",
          R"({"op":"steer","text":"switch arm on","id":"a"})"}) {
      ASSERT_TRUE(talk.on_message(command, true));
      EXPECT_TRUE(desk.commands().empty()) << command;
      const std::vector<std::string> said = all(talk);
      ASSERT_EQ(said.size(), 1U) << command;
      EXPECT_NE(said[0].find("may look, not command"), std::string::npos) << command;
    }
    ASSERT_TRUE(talk.on_message(R"({"op":"getParameters","parameterNames":[],"id":"b"})", true));
    EXPECT_NE(all(talk).at(0).find("RC_F_CHN"), std::string::npos);
  }
}

TEST_F(ConversationTest, WhoHasControlIsToldAndThatAViewerIsGone) {
  CommandDesk desk;
  {
    Conversation talk(live_, &desk, open_, session_, 3);
    EXPECT_NE(all(talk)[2].find(R"("viewer":0,"you":3)"), std::string::npos);
    desk.set_control({7, true, true, 2.0});
    EXPECT_EQ(all(talk)[0],
              R"({"control":{"paused":true,"simulated":true,"speed":2.0,"viewer":7,"you":3},)"
              R"("op":"parameterValues","parameters":[]})");
    ASSERT_TRUE(talk.on_message(R"({"op":"steer","text":"wind 5,0","id":"s"})", true));
    const auto commands = desk.commands();
    ASSERT_EQ(commands.size(), 1U);
    EXPECT_EQ(std::get<CommandDesk::Steer>(commands[0].what).text, "wind 5,0");
    for (const char* text : {R"("")", R"("a\nb")", "7"}) {
      ASSERT_TRUE(talk.on_message(R"({"op":"steer","text":)" + std::string(text) + "}", true));
    }
    EXPECT_TRUE(desk.commands().empty());
  }
  const auto gone = desk.commands();
  ASSERT_EQ(gone.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<CommandDesk::Gone>(gone[0].what));
}

TEST_F(ConversationTest, AfterARestartTheViewerBeginsAnew) {
  Conversation talk(live_, nullptr, open_, session_, 1);
  all(talk);
  EXPECT_FALSE(talk.is_over());
  live_.restart();
  EXPECT_FALSE(talk.next());
  EXPECT_TRUE(talk.is_over());
  CommandDesk desk;
  Conversation waits(live_, &desk, open_, session_, 3);
  all(waits);
  desk.answer({3, "reset", {{{}, {}, true, "reset"}}});
  live_.restart();
  EXPECT_NE(all(waits)[0].find("reset"), std::string::npos) << "the answer comes before the end";
  EXPECT_TRUE(waits.is_over());
  Conversation next(live_, nullptr, open_, session_, 2);
  EXPECT_EQ(all(next).size(), 1U) << "a greeting, and no channels yet";
  EXPECT_FALSE(next.is_over());
}

TEST_F(ConversationTest, ParametersAreToldAsTheyAreKnown) {
  CommandDesk desk;
  Conversation talk(live_, &desk, open_, session_, 1);
  all(talk);
  ASSERT_TRUE(talk.on_message(R"({"op":"getParameters","parameterNames":[]})", true));
  EXPECT_NE(all(talk)[0].find("none are known"), std::string::npos);
  desk.set_parameters({{{"A", 1.0, true}, {"B", 2.0, false}}, true});
  EXPECT_EQ(all(talk)[0], R"({"op":"parameterValues","parameters":[],"unsaved":true})");
  ASSERT_TRUE(talk.on_message(R"({"op":"getParameters","parameterNames":["B"],"id":"x"})", true));
  EXPECT_EQ(all(talk)[0],
            R"({"id":"x","op":"parameterValues","parameters":[{"name":"B","value":2}]})");
}

TEST_F(ConversationTest, AfterTheEndCommandsAreRefused) {
  CommandDesk desk;
  Conversation talk(live_, &desk, open_, session_, 1);
  all(talk);
  ASSERT_TRUE(talk.on_message(kSet, true));
  desk.close("the flight has ended");
  ASSERT_TRUE(talk.on_message(R"({"op":"writeParameters","id":"b"})", true));
  const std::vector<std::string> said = all(talk);
  ASSERT_EQ(said.size(), 2U);
  for (const std::string& text : said)
    EXPECT_NE(text.find("the flight has ended"), std::string::npos);
}

TEST_F(ConversationTest, WhatIsNoParameterIsNoCommand) {
  CommandDesk desk;
  Conversation talk(live_, &desk, open_, session_, 1);
  for (const char* parameter :
       {R"({"name":"A\nB","value":1})", R"({"name":"","value":1})",
        R"({"name":"SEVENTEEN_LETTERS","value":1})", R"({"name":"A","value":"1"})",
        R"({"name":"A","value":true})", R"({"name":"A"})"}) {
    const std::string text =
        R"({"op":"setParameters","parameters":[)" + std::string(parameter) + "]}";
    ASSERT_TRUE(talk.on_message(text, true));
    EXPECT_TRUE(desk.commands().empty()) << parameter;
  }
}

TEST_F(ConversationTest, NoMoreCommandsWaitThanTheirLimit) {
  CommandDesk desk;
  const CommandDesk::Command one{1, "", CommandDesk::WriteParameters{}};
  for (std::size_t k = 0; k < CommandDesk::kMaxWaiting; ++k) ASSERT_EQ(desk.ask(one), "");
  EXPECT_NE(desk.ask(one), "");
  EXPECT_EQ(desk.commands().size(), CommandDesk::kMaxWaiting);
  EXPECT_EQ(desk.ask(one), "");
}

TEST_F(ConversationTest, AnswersThatNobodyTakesMakeRoomForNewOnes) {
  CommandDesk desk;
  for (std::uint64_t gone = 1; gone <= CommandDesk::kMaxWaiting; ++gone)
    desk.answer({gone, "", {}});
  desk.answer({5000, "a", {}});
  ASSERT_EQ(desk.answers(5000).size(), 1U);
  EXPECT_TRUE(desk.answers(1).empty());
  EXPECT_EQ(desk.answers(2).size(), 1U);
}

}  // namespace
}  // namespace rosflight::web::server
