// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/calibration.hpp"

#include <gtest/gtest.h>

namespace rosflight::core {
namespace {

using Result = PressureCalibration::Result;

TEST(ImuCalibration, TakesAThousandAndOneSamples) {
  ImuCalibration c;
  EXPECT_FALSE(c.running());
  c.start();
  int samples = 0;
  while (c.running()) {
    ASSERT_LT(samples, 2000);
    const bool last = c.add({1.0f, -2.0f, 0.5f});
    ++samples;
    EXPECT_EQ(last, !c.running());
  }
  EXPECT_EQ(samples, 1001);
  EXPECT_NEAR(c.mean().x(), 1.0f, 1e-6f);
  EXPECT_NEAR(c.mean().y(), -2.0f, 1e-6f);
  EXPECT_TRUE(c.spread().isZero(0.0f));
}

TEST(ImuCalibration, SpreadIsMaximumLessMinimumPerAxis) {
  ImuCalibration c;
  c.start();
  for (int k = 0; c.running(); ++k) {
    c.add({k == 500 ? 3.0f : 1.0f, k == 0 ? -4.0f : 0.0f, k == 1000 ? 0.25f : 0.5f});
  }
  EXPECT_EQ(c.spread().x(), 2.0f);
  EXPECT_EQ(c.spread().y(), 4.0f);
  EXPECT_EQ(c.spread().z(), 0.25f);
}

TEST(ImuCalibration, StartsAfreshEachTime) {
  ImuCalibration c;
  c.start();
  for (int k = 0; k < 900; ++k) c.add({5.0f, 5.0f, 5.0f});
  c.start();  // what came before must not count
  int samples = 0;
  while (c.running()) {
    c.add({1.0f, 1.0f, 1.0f});
    ++samples;
  }
  EXPECT_EQ(samples, 1001);
  EXPECT_NEAR(c.mean().x(), 1.0f, 1e-6f);
  EXPECT_TRUE(c.spread().isZero(0.0f));
}

/// Samples every `period_ms` until a result. @returns their number; the time of the last in `end`.
int run(PressureCalibration& c, int period_ms, float (*pressure)(int), Result& result, Time& end) {
  int samples = 0;
  result = Result::kRunning;
  while (result == Result::kRunning && samples < 100'000) {
    end = hal::milliseconds(1000 + samples * period_ms);
    result = c.add(end, pressure(samples));
    ++samples;
  }
  return samples;
}

TEST(PressureCalibration, Takes256StepsMoreThan20MsApart) {
  PressureCalibration c{25.0f};
  c.start();
  Result result{};
  Time end{};
  // At 1 kHz one sample in 21 makes a step: 255 * 21 ms = 5.355 s; ROSflight 2.x says 5.4 s.
  EXPECT_EQ(run(c, 1, [](int) { return 90'000.0f; }, result, end), 255 * 21 + 1);
  EXPECT_EQ(result, Result::kGood);
  EXPECT_EQ(end - hal::milliseconds(1000), hal::milliseconds(5355));
  EXPECT_FLOAT_EQ(c.mean_Pa(), 90'000.0f);
  EXPECT_FALSE(c.running());
}

TEST(PressureCalibration, ExactlyTwentyMillisecondsIsNotEnough) {
  PressureCalibration c{25.0f};
  c.start();
  Result result{};
  Time end{};
  EXPECT_EQ(run(c, 20, [](int) { return 100.0f; }, result, end), 255 * 2 + 1);
}

TEST(PressureCalibration, SlowSensorsStepWithEachSample) {
  PressureCalibration c{25.0f};
  c.start();
  Result result{};
  Time end{};
  EXPECT_EQ(run(c, 50, [](int) { return 100.0f; }, result, end), 256);
}

TEST(PressureCalibration, IgnoresTheFirst128StepsAndTheLast) {
  PressureCalibration c{25.0f};
  c.start();
  Result result{};
  Time end{};
  // 50 ms apart: step k + 1 is sample k.
  run(c, 50, [](int k) { return k < 128 || k == 255 ? 5000.0f : 1000.0f; }, result, end);
  EXPECT_EQ(result, Result::kGood);
  EXPECT_FLOAT_EQ(c.mean_Pa(), 1000.0f);
}

TEST(PressureCalibration, AveragesTheOther127) {
  PressureCalibration c{1e9f};
  c.start();
  Result result{};
  Time end{};
  run(c, 50, [](int k) { return static_cast<float>(k - 128); }, result, end);
  EXPECT_NEAR(c.mean_Pa(), 63.0f, 1e-4f);  // of 0..126
}

TEST(PressureCalibration, JudgesByTheSampleVariance) {
  // +-a in turn, 64 times one and 63 times the other: sum of squares about the mean is
  // a^2 (127 - 1/127), divided by 126: a^2 * 1.00787.
  const auto judge = [](float largest) {
    PressureCalibration c{largest};
    c.start();
    Result result{};
    Time end{};
    run(c, 50, [](int k) { return k % 2 == 0 ? 105.0f : 95.0f; }, result, end);
    return result;
  };
  EXPECT_EQ(judge(25.0f * 1.0079f), Result::kGood);
  EXPECT_EQ(judge(25.0f * 1.0078f), Result::kUnsteady);
}

TEST(PressureCalibration, StartsOverIfUnsteady) {
  PressureCalibration c{25.0f};
  c.start();
  Result result{};
  Time end{};
  run(c, 50, [](int k) { return static_cast<float>(k); }, result, end);
  EXPECT_EQ(result, Result::kUnsteady);
  EXPECT_TRUE(c.running());
  int samples = 0;
  do {
    end += hal::milliseconds(50);
    result = c.add(end, 700.0f);
    ++samples;
  } while (result == Result::kRunning);
  EXPECT_EQ(samples, 256);
  EXPECT_EQ(result, Result::kGood);
  EXPECT_FLOAT_EQ(c.mean_Pa(), 700.0f);
}

}  // namespace
}  // namespace rosflight::core
