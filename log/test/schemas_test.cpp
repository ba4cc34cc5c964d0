// SPDX-License-Identifier: BSD-3-Clause
#include "log/schemas.hpp"

#include <gtest/gtest.h>

#include <set>

#include "log/flight_log_topics.hpp"
#include "log/output_file.hpp"

namespace rosflight::log {
namespace {

TEST(Schemas, InnerTypesFollowBehindTheirSeparator) {
  const std::string line(80, '=');
  EXPECT_EQ(schema_text("geometry_msgs/msg/Vector3Stamped"),
            "std_msgs/Header header\ngeometry_msgs/Vector3 vector\n" + line +
                "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" + line +
                "\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n" + line +
                "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n");
}

TEST(Schemas, ATypeUsedTwiceIsDefinedOnce) {
  const std::string text = schema_text("rosflight_msgs/msg/SimState");
  const std::string wanted = "MSG: geometry_msgs/Vector3\n";
  const std::size_t first = text.find(wanted);
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(text.find(wanted, first + 1), std::string::npos);
}

TEST(Schemas, EveryTopicHasItsOwnNameAndAKnownType) {
  std::set<std::string_view> names;
  for (const TopicType& topic : kTopics) {
    EXPECT_TRUE(names.insert(topic.name).second) << topic.name;
    EXPECT_EQ(topic.name.front(), '/');
    EXPECT_FALSE(schema_text(topic.type).empty()) << topic.type;
  }
}

TEST(Schemas, AnUnknownTypeIsRefusedByName) {
  try {
    schema_text("foo_msgs/msg/Bar");
    FAIL();
  } catch (const LogError& error) {
    EXPECT_STREQ(error.what(), "no message definition for foo_msgs/msg/Bar");
  }
}

}  // namespace
}  // namespace rosflight::log
