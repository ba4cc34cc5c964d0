// SPDX-License-Identifier: BSD-3-Clause
// Contents are compared field by field in test_log_reads_back.py.
#include "log/flight_log.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "log/flight_log_topics.hpp"

namespace rosflight::log {
namespace {

namespace fs = std::filesystem;

class FlightLogTest : public testing::Test {
 protected:
  void SetUp() override {
    path_ = fs::path(testing::TempDir()) /
            (std::string("flight_log_") +
             testing::UnitTest::GetInstance()->current_test_info()->name());
  }
  void TearDown() override { fs::remove(path_); }

  LogSummary fly(const FlightLog::Options& options, double north_m,
                 std::int64_t steps = 100) const {
    FlightLog log(path_, options, {{"seed", "1"}});
    sim::Truth truth;
    truth.body.p_W.x() = north_m;
    for (std::int64_t k = 0; k < steps; ++k) {
      truth.time = hal::microseconds(2500 * k);
      log.write_truth(truth, {});
    }
    return log.close();
  }

  fs::path path_;
};

TEST_F(FlightLogTest, SameFlightSameFingerprintAndAnotherFlightAnother) {
  const LogSummary first = fly({}, 1.0);
  EXPECT_EQ(first.sha256, fly({}, 1.0).sha256);
  EXPECT_NE(first.sha256, fly({}, std::nextafter(1.0, 2.0)).sha256);
}

TEST_F(FlightLogTest, AnObserverSeesEveryMessageAndChangesNone) {
  struct Count final : LogObserver {
    void on_logged(Topic topic, std::uint64_t time_ns, Bytes cdr) override {
      ++messages;
      topics.insert(topic);
      EXPECT_GE(time_ns, FlightLog::kDefaultEpoch_ns);
      EXPECT_GT(cdr.size(), 4U);  // more than the encapsulation
    }
    std::uint64_t messages{0};
    std::set<Topic> topics;
  } count;
  FlightLog::Options options;
  options.observers = {&count};
  const LogSummary observed = fly(options, 1.0);
  EXPECT_EQ(observed.sha256, fly({}, 1.0).sha256);
  EXPECT_EQ(count.messages, observed.messages);
  EXPECT_EQ(count.topics.size(), 8U);
}

TEST_F(FlightLogTest, APlotHasTruthAtOneHundredHertzAndAFullLogEveryStep) {
  FlightLog::Options options;
  // Three topics of every step, and wind, pulses, transform, pose and odometry.
  EXPECT_EQ(fly(options, 0.0, 1).messages, 8U);
  // Steps 0, 4, ..., 100 of 2.5 ms; wind, pulses and transform every 50 ms, pose 100, odometry 200.
  constexpr std::uint64_t kRare = 6U * 3U + 3U + 2U;
  EXPECT_EQ(fly(options, 0.0, 101).messages, 26U * 3U + kRare);
  options.detail = Detail::kFull;
  EXPECT_EQ(fly(options, 0.0, 101).messages, 101U * 3U + kRare);
}

TEST_F(FlightLogTest, APlotThinsAttitudeAndOutputsButNoSensorAndNoBytes) {
  // `message` crosses the link every 2 ms for one second.
  const auto messages = [this](Detail detail, const link::Message& message, bool bytes) {
    FlightLog::Options options;
    options.detail = detail;
    FlightLog log(path_, options, {});
    constexpr std::array<std::uint8_t, 3> kFrame{1, 2, 3};
    for (int k = 0; k < 500; ++k) {
      log.write_link(Direction::kFcuToCompanion, hal::milliseconds(2 * k), message,
                     bytes ? Bytes(kFrame) : Bytes{});
    }
    return log.close().messages;
  };
  EXPECT_EQ(messages(Detail::kPlot, link::Attitude{}, false), 120U);  // And its Euler angles.
  EXPECT_EQ(messages(Detail::kFull, link::Attitude{}, false), 520U);
  EXPECT_EQ(messages(Detail::kPlot, link::OutputRaw{}, false), 100U);
  EXPECT_EQ(messages(Detail::kFull, link::OutputRaw{}, false), 500U);
  EXPECT_EQ(messages(Detail::kPlot, link::Attitude{}, true), 140U);  // The frames of 50 ms in one.
  EXPECT_EQ(messages(Detail::kPlot, link::OffboardControl{}, false), 50U);
  EXPECT_EQ(messages(Detail::kFull, link::OffboardControl{}, false), 500U);
  EXPECT_EQ(messages(Detail::kPlot, link::Imu{}, false), 520U);  // And its temperature.
  EXPECT_EQ(messages(Detail::kFull, link::Imu{}, false), 520U);
  EXPECT_EQ(messages(Detail::kPlot, link::Baro{}, false), 500U);
}

TEST_F(FlightLogTest, BytesWithoutAMessageAreLogged) {
  FlightLog log(path_, {}, {});
  constexpr std::array<std::uint8_t, 3> kNoise{1, 2, 3};
  log.write_link(Direction::kFcuToCompanion, {}, {}, kNoise);
  EXPECT_EQ(log.close().messages, 1U);
}

TEST_F(FlightLogTest, AMessageWithoutBytesHasNoFrame) {
  FlightLog log(path_, {}, {});
  log.write_link(Direction::kFcuToCompanion, {}, link::Heartbeat{}, {});
  EXPECT_EQ(log.close().messages, 1U);
}

TEST_F(FlightLogTest, UnwritablePathIsOneLine) {
  try {
    FlightLog log("/nowhere/at/all/log.mcap", {}, {});
    FAIL();
  } catch (const LogError& error) {
    EXPECT_STREQ(error.what(),
                 "/nowhere/at/all/log.mcap.part: cannot create: No such file or directory");
  }
}

TEST(FlightLogTopics, EveryTopicHasItsOwnName) {
  std::set<std::string_view> names;
  for (const TopicType& topic : kTopics) {
    EXPECT_TRUE(names.insert(topic.name).second) << topic.name;
    EXPECT_EQ(topic.name.front(), '/');
  }
}

}  // namespace
}  // namespace rosflight::log
