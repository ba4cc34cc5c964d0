// SPDX-License-Identifier: BSD-3-Clause
// Whatever arrives on the link, a pass takes no more than it can, loses none of the messages and keeps its streams.
#include <algorithm>

#include "firmware/core/test/firmware_rig.hpp"

namespace rosflight::core {
namespace {

class FirmwareStorms : public testing::Test {
 protected:
  void start() {
    rig_.store_quadrotor();
    rig_.start();
  }

  FirmwareRig rig_;
};

TEST_F(FirmwareStorms, AStormOfBytesNeitherHoldsAPassNorStopsTheStreams) {
  start();
  rig_.run_for(100);
  rig_.inbox.clear();
  std::vector<std::uint8_t> noise(1'000'000);
  std::uint32_t x = 12345;
  for (auto& byte : noise) {
    x = x * 1664525u + 1013904223u;
    byte = static_cast<std::uint8_t>(x >> 24);
  }
  rig_.serial.put(noise.data(), noise.size());
  for (int k = 0; k < 400; ++k) rig_.pass();
  EXPECT_EQ(rig_.got<link::Imu>().size(), 400u);
  std::vector<std::uint8_t> rest(noise.size());
  // 1 kB per pass; the rest is still in the port, but for what the firmware's buffer holds.
  EXPECT_GE(rig_.serial.read(rest.data(), rest.size()),
            noise.size() - 400 * Firmware::kBytesPerPass - 128);
}

TEST_F(FirmwareStorms, APassTakesEightMessagesAndTheRestWaitsInItsOrder) {
  start();
  rig_.run_for(100);
  rig_.inbox.clear();
  constexpr int kSent = 50;
  for (int n = 0; n < kSent; ++n) rig_.send(link::TimeSync{0, n + 1});
  std::size_t answered = 0;
  for (int pass = 1; answered < kSent; ++pass) {
    rig_.pass();
    const auto answers = rig_.got<link::TimeSync>();
    ASSERT_LE(answers.size() - answered, 8u);
    answered = answers.size();
    ASSERT_EQ(answered, static_cast<std::size_t>(std::min(8 * pass, kSent)));
  }
  const auto answers = rig_.got<link::TimeSync>();
  for (std::size_t n = 0; n < answers.size(); ++n) {
    EXPECT_EQ(answers[n].ts1_ns, static_cast<std::int64_t>(n) + 1);
  }
}

TEST_F(FirmwareStorms, AStormOfParametersChangesTheModulesOnceAPassAndLosesNone) {
  start();
  rig_.run_for(100);
  rig_.inbox.clear();
  // The last of several values for one parameter wins, and is in force in the next control step.
  for (int n = 1; n <= 8; ++n) rig_.set_param("RC_MAX_ROLL", 0.1f * static_cast<float>(n));
  rig_.pass();
  EXPECT_EQ(rig_.values_of("RC_MAX_ROLL").size(), 4u) << "a request counts as two messages";
  rig_.pass();
  EXPECT_EQ(rig_.values_of("RC_MAX_ROLL").size(), 8u);
  EXPECT_EQ(rig_.firmware().parameters().get_float(Param::kRcMaxRoll), 0.8f);
  EXPECT_FALSE(rig_.firmware().parameters().has_changes());
  const std::size_t sent = 88;  // 2 kB
  for (std::size_t n = 0; n < sent; ++n) {
    rig_.set_param("PRI_MIXER_0_0", 0.01f * static_cast<float>(n + 1));
  }
  rig_.inbox.clear();
  rig_.run_for(100);
  EXPECT_EQ(rig_.values_of("PRI_MIXER_0_0").size(), sent);
}

TEST_F(FirmwareStorms, AStormOfGoodMessagesIsSurvived) {
  start();
  rig_.arm();
  for (int k = 0; k < 400; ++k) {
    for (int n = 0; n < 5; ++n) {
      rig_.send(link::ParamRequestList{});
      rig_.set_param("NO_SUCH_NAME", 1);
      rig_.set_param("RC_MAX_THR", n % 2 == 0 ? 0.7f : 0.6f);
      rig_.send(link::CommandRequest{static_cast<std::uint8_t>(n)});
      rig_.send(link::ParamRequestRead{1, static_cast<std::int16_t>(-n * 1000), {}});
    }
    rig_.pass();
  }
  EXPECT_TRUE(rig_.armed());
  EXPECT_EQ(rig_.errors(), 0);
  EXPECT_EQ(rig_.got<link::Imu>().size(), 400u);
}

}  // namespace
}  // namespace rosflight::core
