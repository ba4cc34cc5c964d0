// SPDX-License-Identifier: BSD-3-Clause
#include "web/server/foxglove.hpp"

#include <gtest/gtest.h>

#include <random>
#include <tuple>

namespace rosflight::web::server::foxglove {
namespace {

TEST(Foxglove, TheFirstKnownProtocolIsChosen) {
  EXPECT_EQ(chosen_protocol("foxglove.websocket.v1"), "foxglove.websocket.v1");
  EXPECT_EQ(chosen_protocol("other, foxglove.sdk.v1 ,foxglove.websocket.v1"), "foxglove.sdk.v1");
  EXPECT_EQ(chosen_protocol("foxglove.websocket.v2"), std::nullopt);
  EXPECT_EQ(chosen_protocol(""), std::nullopt);
  EXPECT_EQ(chosen_protocol(",,"), std::nullopt);
}

TEST(Foxglove, AMessageHeadIsLittleEndian) {
  EXPECT_EQ(message_head(0x01020304, 0x1112131415161718),
            "\x01\x04\x03\x02\x01\x18\x17\x16\x15\x14\x13\x12\x11");
}

TEST(Foxglove, ChannelsAreAdvertisedFromOne) {
  const std::vector<LiveData::Channel> channels{
      {"/a\"b", "std_msgs/msg/String", "string data", {}}};
  EXPECT_EQ(advertise(4, channels),
            R"({"channels":[{"encoding":"cdr","id":5,"schema":"string data","schemaEncoding":)"
            R"("ros2msg","schemaName":"std_msgs/msg/String","topic":"/a\"b"}],"op":"advertise"})");
}

TEST(Foxglove, SubscriptionsAreRead) {
  const Request request = parse_request(
      R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":1},{"id":0,"channelId":3}]})");
  EXPECT_EQ(request.complaint, "");
  EXPECT_EQ(request.subscribe, (decltype(request.subscribe){{7, 0}, {0, 2}}));
  EXPECT_EQ(parse_request(R"({"op":"unsubscribe","subscriptionIds":[7,8]})").unsubscribe,
            (std::vector<std::uint32_t>{7, 8}));
}

TEST(Foxglove, WhatIsNotUnderstoodIsAComplaint) {
  for (const char* text :
       {"",
        "{",
        "[]",
        "7",
        "{}",
        R"({"op":7})",
        R"({"op":"fly"})",
        R"({"op":"subscribe"})",
        R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":0}]})",
        R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":"1","channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":true,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":1.5,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":7})",
        R"({"op":"testMotor","motor":256,"value":0.1})",
        R"({"op":"testMotor","motor":259,"value":0.1})",
        R"({"op":"testMotor","motor":-1,"value":0.1})",
        R"({"op":"testMotor","motor":2.7,"value":0.1})",
        R"({"op":"testMotor","motor":true,"value":0.1})",
        R"({"op":"testMotor","motor":1e300,"value":0.1})",
        R"({"op":"testMotor","motor":"2","value":0.1})",
        R"({"op":"testMotor","motor":2})",
        R"({"op":"testMotor","motor":2,"value":1.01})",
        R"({"op":"testMotor","motor":2,"value":-0.1})",
        R"({"op":"testMotor","motor":2,"value":true})",
        R"({"op":"testMotor","motor":2,"value":null})",
        R"({"op":"testMotor","value":0.1})"}) {
    const Request request = parse_request(text);
    EXPECT_NE(request.complaint, "") << text;
    EXPECT_TRUE(request.subscribe.empty()) << text;
    EXPECT_FALSE(request.command) << text;
  }
}

TEST(Foxglove, AMotorTestHasAnOutputAndAShare) {
  for (const auto& [text, motor, value] :
       {std::tuple(R"({"op":"testMotor","motor":0,"value":0,"id":"a"})", 0, 0.0),
        std::tuple(R"({"op":"testMotor","motor":255,"value":1,"id":"a"})", 255, 1.0),
        std::tuple(R"({"op":"testMotor","motor":13,"value":0.25,"id":"a"})", 13, 0.25)}) {
    const Request request = parse_request(text);
    EXPECT_EQ(request.complaint, "") << text;
    EXPECT_EQ(request.id, "a");
    const auto& test = std::get<CommandDesk::TestMotor>(*request.command);
    EXPECT_EQ(test.motor, motor);
    EXPECT_EQ(test.value, value);
  }
}

TEST(Foxglove, AnyTextEndsInARequestOrAComplaint) {
  std::mt19937 random(5);
  const std::string good = R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":1}]})";
  for (int run = 0; run < 20'000; ++run) {
    std::string text = good.substr(0, random() % (good.size() + 1));
    for (unsigned k = random() % 4; k > 0 && !text.empty(); --k)
      text[random() % text.size()] = static_cast<char>(random());
    const Request request = parse_request(text);
    EXPECT_LE(request.subscribe.size(), 1U);
  }
}

}  // namespace
}  // namespace rosflight::web::server::foxglove
