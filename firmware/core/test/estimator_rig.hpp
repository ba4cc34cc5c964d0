// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <cmath>

#include "firmware/core/estimator.hpp"
#include "firmware/core/test/attitude_truth.hpp"
#include "firmware/core/test/test_values.hpp"

namespace rosflight::core {

using truth::Attitude;
using truth::Rates;

/// Feeds samples as the main loop does: equally spaced, dt from the stamps.
class Rig {
 public:
  explicit Rig(std::int64_t step_us, const Estimator::Config& config = {}) : step_us_{step_us} {
    estimator.configure(config);
  }
  const AttitudeEstimate& sample(const hal::Vec3& accel, const hal::Vec3& gyro) {
    return after(step_us_, accel, gyro);
  }
  const AttitudeEstimate& after(std::int64_t us, const hal::Vec3& accel, const hal::Vec3& gyro) {
    now_us += us;
    return estimator.step({hal::microseconds(now_us), accel, gyro, 298.15f},
                          hal::seconds(hal::microseconds(us)));
  }
  void rest(double seconds, const hal::Vec3& accel = kLevel, const hal::Vec3& gyro = {}) {
    const auto n = static_cast<int>(std::lround(seconds * 1e6 / static_cast<double>(step_us_)));
    for (int k = 0; k < n; ++k) sample(accel, gyro);
  }
  const Quaternion& q() const { return estimator.estimate().q_WB; }

  Estimator estimator;
  std::int64_t now_us{0};

 private:
  std::int64_t step_us_;
};

inline Estimator::Config gyro_only() {
  Estimator::Config c;
  c.use_acc = false;
  c.ki = 0.0f;
  c.gyro_xy_lpf = c.gyro_z_lpf = c.acc_lpf = 0.0f;
  c.quadratic_rates = false;
  c.init_time = Time{0};
  return c;
}

inline constexpr double kDegree = 0.017453292519943295;

/// Angle between the estimated and the true direction of gravity [deg].
inline double tilt_error_deg(const Quaternion& q, const Attitude& truth_q) {
  const hal::Vec3 a = truth_q.accel_at_rest();
  const Matrix3 R = rotation_matrix(q);
  const Vector3 p = -R.row(2).transpose();
  const double cosine{to_vector(a).normalized().dot(p)};
  return std::acos(std::min(1.0, cosine)) / kDegree;
}

inline Estimator::Config unboosted() {
  Estimator::Config config;
  config.init_time = Time{0};
  config.acc_lpf = 0.0f;
  config.gyro_xy_lpf = config.gyro_z_lpf = 0.0f;
  config.quadratic_rates = false;
  return config;
}

/// Turns the estimate to an attitude by the gyro, with an accelerometer that is not used.
inline void turn_to(Rig& rig, const Attitude& q) {
  const double w = std::min(1.0, std::abs(q.w));
  const double angle = 2 * std::acos(w);
  const double s = angle > 0 ? angle / std::sin(angle / 2) / 0.0025 * (q.w < 0 ? -1 : 1) : 0;
  rig.sample(
      {}, {static_cast<float>(q.x * s), static_cast<float>(q.y * s), static_cast<float>(q.z * s)});
  ASSERT_LT(q.angle_to(rig.q()), 1e-5);
}

}  // namespace rosflight::core
