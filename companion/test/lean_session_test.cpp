// SPDX-License-Identifier: BSD-3-Clause
// A companion that has no setting of the protocol of its FCU.
#include <gtest/gtest.h>

#include "companion/test/rig.hpp"
#include "link/lean/lean_codec.hpp"

namespace rosflight::companion::test {
namespace {

constexpr std::uint32_t kOtherSchema = 0x12345678;

class LeanSession : public ::testing::Test {
 protected:
  LeanSession() { speak_lean(); }
  void speak_lean(std::uint32_t schema = 0) {
    rig.fcu.codec = std::make_shared<link::LeanCodec>(schema);
  }
  /// Everything a session starts with has come.
  bool ready() const {
    return rig.session.connected() && rig.session.parameters().complete() &&
           rig.session.version_match() == VersionMatch::kSame &&
           rig.session.time_sync().synchronised();
  }

  Rig rig;
};

TEST_F(LeanSession, FindsAnFcuThatSpeaksLean) {
  EXPECT_TRUE(rig.run_until([&] { return ready(); }, 3s));
  EXPECT_EQ(rig.codec.protocol(), link::DetectingCodec::Protocol::kLean);
  EXPECT_EQ(rig.session.statistics().frames.frames_dropped, 0U);
  EXPECT_EQ(rig.session.statistics().frames.sequence_gaps, 0U);
  EXPECT_TRUE(rig.log.of<SchemaEvent>().empty());
  const auto job = rig.session.parameters().set("P001", 3.0);
  ASSERT_TRUE(rig.run_job(job, 1s));
  EXPECT_TRUE(job.done()) << job.text();
  EXPECT_EQ(rig.fcu.find("P001")->value.as_float(), 3.0f);
}

TEST_F(LeanSession, SaysOnceThatTheMessagesDifferAndRefuses) {
  speak_lean(kOtherSchema);
  rig.run_for(10s);
  const auto events = rig.log.of<SchemaEvent>();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].theirs, kOtherSchema);
  const std::string text = schema_text(events[0]);
  EXPECT_EQ(text.find("lean link refused: the FCU's messages are schema 12345678, ours "), 0U)
      << text;
  EXPECT_EQ(text.find('\n'), std::string::npos);
  EXPECT_TRUE(rig.session.refused());
  EXPECT_FALSE(rig.session.connected());
  EXPECT_EQ(rig.session.streams().imu.count, 0U);
  EXPECT_FALSE(rig.session.send(link::ParamRequestList{}));
  const auto sent = rig.codec.counters().frames_sent;
  rig.run_for(5s);
  EXPECT_NEAR(static_cast<double>(rig.codec.counters().frames_sent - sent), 5.0,
              1.0);  // heartbeats
}

TEST_F(LeanSession, TakesTheFcuBackOnceItWasBuiltRight) {
  rig.run_until([&] { return ready(); }, 3s);
  speak_lean(kOtherSchema);
  rig.run_for(4s);
  EXPECT_TRUE(rig.session.refused());
  EXPECT_FALSE(rig.session.connected());
  speak_lean();
  EXPECT_TRUE(rig.run_until([&] { return rig.session.connected(); }, 3s));
  EXPECT_FALSE(rig.session.refused());
  EXPECT_EQ(rig.log.of<SchemaEvent>().size(), 1U);
}

TEST_F(LeanSession, FollowsAnFcuThatNowSpeaksMavlink) {
  rig.run_until([&] { return ready(); }, 3s);
  rig.fcu.codec = std::make_shared<link::MavlinkCodec>(
      link::MavlinkCodec::Identity{1, link::MavlinkCodec::kFcuComponent});
  rig.run_for(2s);
  EXPECT_TRUE(rig.session.connected());
  EXPECT_EQ(rig.codec.protocol(), link::DetectingCodec::Protocol::kMavlink);
}

}  // namespace
}  // namespace rosflight::companion::test
