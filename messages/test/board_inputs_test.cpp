// SPDX-License-Identifier: BSD-3-Clause
#include "messages/board_inputs.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "messages/cdr_reader.hpp"

namespace rosflight::messages {
namespace {

using rosflight_log_msgs::BoardInputs;

constexpr hal::Time kStep = hal::microseconds(2500);

/// Two steps with everything a board can receive; values that rounding would change.
BoardInputs two_steps() {
  BoardInputs out;
  sim::SensorSamples first;
  first.has_imu = first.has_gnss = true;
  first.imu = {hal::Time{-7}, {0.1F, std::nanf(""), -0.0F}, {1e-38F, 2.0F, 3.0F}, 300.0F};
  first.gnss.stamp = hal::Time{-150'000};
  first.gnss.latitude_deg = 40.1;
  first.gnss.unix_s = 1'767'225'612;
  first.gnss.unix_ns = 999'999'999;
  first.gnss.fix = hal::GnssFix::k3d;
  append(first, nullptr, hal::Time{0}, 0, out);
  constexpr std::array<std::uint8_t, 4> kBytes{1, 2, 3, 4};
  append(std::span(kBytes).first(3), 0, out);
  hal::RcFrame frame;
  frame.stamp = kStep;
  frame.channel_count = 18;
  frame.channels[17] = 0.3F;
  frame.frame_lost = true;
  append(sim::SensorSamples{}, &frame, kStep, 2500, out);
  append(std::span(kBytes).last(1), 0, out);
  return out;
}

TEST(BoardInputs, ComeBackToTheBit) {
  std::vector<StepInputs> steps;
  const hal::Time start = hal::microseconds(5000);
  ASSERT_TRUE(append_to(steps, start, two_steps()));
  ASSERT_EQ(steps.size(), 2U);
  const StepInputs& first = steps[0];
  EXPECT_EQ(first.time, start);
  EXPECT_TRUE(first.samples.has_imu && first.samples.has_gnss && !first.samples.has_mag);
  EXPECT_EQ(first.samples.imu.stamp, start - hal::Time{7});
  EXPECT_EQ(std::bit_cast<std::uint32_t>(first.samples.imu.accel_m_s2[2]), 0x80000000U);
  EXPECT_TRUE(std::isnan(first.samples.imu.accel_m_s2[1]));
  EXPECT_EQ(first.samples.imu.gyro_rad_s[0], 1e-38F);
  EXPECT_EQ(first.samples.gnss.latitude_deg, 40.1);
  EXPECT_EQ(first.samples.gnss.unix_s, 1'767'225'612);
  EXPECT_EQ(first.samples.gnss.unix_ns, 999'999'999);
  EXPECT_EQ(first.samples.gnss.fix, hal::GnssFix::k3d);
  EXPECT_EQ(first.samples.gnss.stamp, start - hal::Time{150'000});
  EXPECT_EQ(first.bytes, (std::vector<std::uint8_t>{1, 2, 3}));
  EXPECT_FALSE(first.receiver);
  const StepInputs& second = steps[1];
  EXPECT_EQ(second.time, start + kStep);
  ASSERT_TRUE(second.receiver);
  EXPECT_EQ(second.receiver->stamp, start + kStep);
  EXPECT_EQ(second.receiver->channel_count, 18);
  EXPECT_EQ(second.receiver->channels[17], 0.3F);
  EXPECT_TRUE(second.receiver->frame_lost && !second.receiver->failsafe);
  EXPECT_EQ(second.bytes, (std::vector<std::uint8_t>{4}));
}

TEST(BoardInputs, PartsThatDoNotFitAreRefused) {
  const auto refused = [](const auto& spoil) {
    BoardInputs in = two_steps();
    spoil(in);
    std::vector<StepInputs> steps;
    return !append_to(steps, {}, in);
  };
  EXPECT_FALSE(refused([](BoardInputs& /*in*/) {}));
  EXPECT_TRUE(refused([](BoardInputs& in) { in.age_us.pop_back(); }));
  EXPECT_TRUE(refused([](BoardInputs& in) { in.values.pop_back(); }));
  EXPECT_TRUE(refused([](BoardInputs& in) { in.doubles.clear(); }));
  EXPECT_TRUE(refused([](BoardInputs& in) { in.bytes.pop_back(); }));
  EXPECT_TRUE(refused([](BoardInputs& in) { in.kind.back() = BoardInputs::LINK + 1; }));
  for (const float nonsense : {-1.0F, 1e9F, std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_TRUE(refused([&](BoardInputs& in) { in.values.assign(in.values.size(), nonsense); }));
  }
}

TEST(CdrReader, TakesWhatTheWriterPut) {
  BoardInputs in = two_steps();
  in.header.frame_id = "body";
  CdrWriter writer;
  writer.begin();
  serialize(writer, in);
  CdrReader reader(writer.bytes());
  std::int32_t sec{};
  std::uint32_t nanosec{};
  std::string frame;
  BoardInputs out;
  reader.take(sec);
  reader.take(nanosec);
  reader.take(frame);
  reader.take(out.kind);
  reader.take(out.delay_us);
  reader.take(out.age_us);
  reader.take(out.values);
  reader.take(out.doubles);
  reader.take(out.bytes);
  EXPECT_EQ(frame, "body");
  EXPECT_EQ(out.kind, in.kind);
  EXPECT_EQ(out.age_us, in.age_us);
  EXPECT_EQ(out.doubles, in.doubles);
  EXPECT_EQ(out.bytes, in.bytes);
  EXPECT_THROW(reader.take(sec), std::runtime_error);
}

}  // namespace
}  // namespace rosflight::messages
