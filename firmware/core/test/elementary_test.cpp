// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/elementary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

namespace rosflight::core {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
const float kNan = std::nanf("");

TEST(Elementary, Atan2FollowsTheCLibraryInDoublePrecision) {
  for (int k = 0; k < 20'000; ++k) {
    const double angle = -3.14159 + 6.28318 * k / 20'000.0;
    const double length = std::pow(10.0, k % 13 - 6);
    const auto y = static_cast<float>(length * std::sin(angle));
    const auto x = static_cast<float>(length * std::cos(angle));
    const double exact = std::atan2(double{y}, double{x});
    ASSERT_NEAR(double{atan2(y, x)}, exact, 2.4e-7 * std::abs(exact) + 1e-12) << y << ' ' << x;
  }
}

TEST(Elementary, Atan2OnTheAxes) {
  EXPECT_EQ(atan2(0.0f, 0.0f), 0.0f);
  EXPECT_EQ(atan2(0.0f, 2.0f), 0.0f);
  EXPECT_FLOAT_EQ(atan2(2.0f, 0.0f), 1.57079633f);
  EXPECT_FLOAT_EQ(atan2(-2.0f, 0.0f), -1.57079633f);
  EXPECT_FLOAT_EQ(atan2(0.0f, -2.0f), 3.14159265f);
  EXPECT_FLOAT_EQ(atan2(1.0f, 1.0f), 0.78539816f);
  EXPECT_TRUE(std::isnan(atan2(kNan, 1.0f)));
  EXPECT_TRUE(std::isnan(atan2(1.0f, kNan)));
}

TEST(Elementary, AsinFollowsTheCLibrary) {
  for (int k = -1000; k <= 1000; ++k) {
    const float s = static_cast<float>(k) / 1000.0f;
    const double exact = std::asin(double{s});
    ASSERT_NEAR(double{asin(s)}, exact, 3e-7 * std::abs(exact) + 1e-12) << s;
  }
  EXPECT_TRUE(std::isnan(asin(1.001f)));
  EXPECT_TRUE(std::isnan(asin(kNan)));
}

TEST(Elementary, SineAndCosineFollowTheCLibrary) {
  for (int k = -100'000; k <= 100'000; k += 7) {
    const float x = static_cast<float>(k) * 0.01f;
    const SinCos found = sin_cos(x);
    ASSERT_NEAR(double{found.sin}, std::sin(double{x}), 1.2e-7) << x;
    ASSERT_NEAR(double{found.cos}, std::cos(double{x}), 1.2e-7) << x;
  }
  EXPECT_EQ(sin_cos(0.0f).sin, 0.0f);
  EXPECT_EQ(sin_cos(0.0f).cos, 1.0f);
  EXPECT_TRUE(std::isnan(sin_cos(kInf).sin));
  EXPECT_TRUE(std::isnan(sin_cos(kNan).cos));
}

TEST(Elementary, PowFollowsTheCLibrary) {
  for (const float y : {0.190326730f, 0.809736895f, -1.5f, 2.0f, 0.0f}) {
    for (int k = 1; k < 3000; ++k) {
      const float x = 0.001f * static_cast<float>(k);
      const double exact = std::pow(double{x}, double{y});
      ASSERT_NEAR(double{pow(x, y)}, exact, 1.5e-7 * exact) << x << ' ' << y;
    }
  }
  EXPECT_EQ(pow(0.0f, 0.5f), 0.0f);
  EXPECT_EQ(pow(kInf, 0.5f), kInf);
  EXPECT_EQ(pow(10.0f, 50.0f), kInf);
  EXPECT_EQ(pow(10.0f, -50.0f), 0.0f);
  EXPECT_TRUE(std::isnan(pow(-1.0f, 0.5f)));
  EXPECT_TRUE(std::isnan(pow(kNan, 0.5f)));
  EXPECT_TRUE(std::isnan(pow(2.0f, kNan)));
}

}  // namespace
}  // namespace rosflight::core
