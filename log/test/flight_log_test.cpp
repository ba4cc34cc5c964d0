// SPDX-License-Identifier: BSD-3-Clause
// Contents are compared field by field in test_log_reads_back.py.
#include "log/flight_log.hpp"

#include <gtest/gtest.h>

#include <cmath>

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
    truth.body.p_N.x() = north_m;
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

TEST_F(FlightLogTest, TruthIsDecimated) {
  FlightLog::Options options;
  const std::uint64_t per_step = fly(options, 0.0, 1).messages;
  options.truth_every = 8;
  EXPECT_EQ(fly(options, 0.0, 100).messages, 13 * per_step);  // Steps 0, 8, ..., 96.
  options.truth_every = 0;
  EXPECT_EQ(fly(options, 0.0, 100).messages, 0U);
}

TEST_F(FlightLogTest, BytesWithoutAMessageAreOneRawFrame) {
  FlightLog log(path_, {}, {});
  constexpr std::array<std::uint8_t, 3> kNoise{1, 2, 3};
  log.write_link(Direction::kFcuToCompanion, {}, {}, kNoise);
  EXPECT_EQ(log.close().messages, 1U);
}

TEST_F(FlightLogTest, AMessageWithoutBytesHasNoRawFrame) {
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

TEST(EulerAngles, QuarterTurnsAndTheLimitOfPitch) {
  const float h = std::sqrt(0.5F);
  const auto expect = [](const std::array<double, 3>& angles, double roll, double pitch,
                         double yaw) {
    EXPECT_NEAR(angles[0], roll, 1e-6);  // Single precision in.
    EXPECT_NEAR(angles[1], pitch, 1e-6);
    EXPECT_NEAR(angles[2], yaw, 1e-6);
  };
  expect(euler_angles({h, h, 0, 0}), M_PI_2, 0, 0);
  expect(euler_angles({h, 0, 0, h}), 0, 0, M_PI_2);
  expect(euler_angles({std::cos(0.25F), 0, std::sin(0.25F), 0}), 0, 0.5, 0);
  // Slightly more than a unit quaternion must not give a NaN at pitch 90 degrees.
  EXPECT_NEAR(euler_angles({h * 1.001F, 0, h * 1.001F, 0})[1], M_PI_2, 1e-6);
}

}  // namespace
}  // namespace rosflight::log
