// SPDX-License-Identifier: BSD-3-Clause
#include "web/server/conversation.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>
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
  Conversation talk(live_, open_, session_);
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
  Conversation talk(live_, closed_, session_);
  EXPECT_FALSE(talk.next());
  const std::string token = closed_.address().substr(closed_.address().find('#') + 1);
  EXPECT_TRUE(talk.on_message(R"({"op":"token","token":")" + token + "\"}", true));
  EXPECT_EQ(all(talk).size(), 2U);
  Conversation stranger(live_, closed_, session_);
  EXPECT_FALSE(stranger.on_message(R"({"op":"token","token":""})", true));
  EXPECT_FALSE(stranger.next());
}

TEST_F(ConversationTest, WhatIsUnsubscribedMeanwhileIsNotSent) {
  Conversation talk(live_, open_, session_);
  all(talk);
  ASSERT_TRUE(
      talk.on_message(R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":2}]})", true));
  for (std::uint64_t t = 0; t < 3; ++t) live_.put(1, t, kCdr);
  EXPECT_TRUE(talk.next());
  ASSERT_TRUE(talk.on_message(R"({"op":"unsubscribe","subscriptionIds":[7]})", true));
  EXPECT_FALSE(talk.next());
}

TEST_F(ConversationTest, UnreadComplaintsEndIt) {
  Conversation talk(live_, open_, session_);
  all(talk);
  for (std::size_t k = 0; k < Conversation::kMostUnreadTexts; ++k)
    ASSERT_TRUE(talk.on_message("nonsense", true)) << k;
  EXPECT_FALSE(talk.on_message("nonsense", false));
}

}  // namespace
}  // namespace rosflight::web::server
