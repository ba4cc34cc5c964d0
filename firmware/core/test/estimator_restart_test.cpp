// SPDX-License-Identifier: BSD-3-Clause
// What the estimate goes on from after a restart in flight.
#include <vector>

#include "firmware/core/test/estimator_rig.hpp"

namespace rosflight::core {
namespace {

/// What was estimated 50 ms before the clock of the next life began.
Motion motion_before() {
  const auto q = Attitude::from_euler(0.4, -0.2, 1.0).floats();
  return {-hal::milliseconds(50), {q[0], q[1], q[2], q[3]}, {1.0f, 0.0f, 0.0f}, {0.1f, 0.0f, 0.0f}};
}
constexpr hal::Vec3 kFalling{0.0f, 0.3f, -0.5f};  // motors off: nothing but drag

TEST(EstimatorRestart, InFlightGoesOnFromTheMotionBefore) {
  Rig rig(2500);
  rig.now_us = 27'500;
  rig.estimator.resume_in_flight(motion_before());
  // 80 ms: from 1 rad/s to 2 rad/s, of which 0.1 are bias.
  const AttitudeEstimate& e = rig.sample(kFalling, {2.1f, 0.0f, 0.0f});
  EXPECT_NEAR(e.roll_rad, 0.4f + 0.08f * 1.5f, 1e-4f);
  EXPECT_NEAR(e.pitch_rad, -0.2f, 1e-4f);
  EXPECT_NEAR(yaw_of(e.q_WB), 1.0f, 1e-4f);
  EXPECT_NEAR(e.rates_rad_s.x(), 2.0f, 1e-5f);
  EXPECT_EQ(rig.estimator.bias_rad_s().x(), 0.1f);
  EXPECT_EQ(e.stamp, hal::microseconds(30'000));
  const float roll_rad = e.roll_rad;
  rig.rest(0.5, kLevel, {0.1f, 0.0f, 0.0f});  // thrust again, the vehicle still tilted: no boost
  EXPECT_GT(rig.estimator.estimate().roll_rad, 0.75f * roll_rad);
}

TEST(EstimatorRestart, ASecondFaultBeforeTheFirstSampleLosesNothing) {
  Rig rig(2500);
  rig.estimator.resume_in_flight(motion_before());
  const Motion again = rig.estimator.motion();
  EXPECT_EQ(again.stamp, motion_before().stamp);
  EXPECT_NEAR(roll_of(again.q_WB), 0.4f, 1e-5f);
}

TEST(EstimatorRestart, AMotionThatIsOldOrCannotBeIsNotUsed) {
  std::vector<Motion> unusable(5, motion_before());
  unusable[0].stamp = -hal::milliseconds(1'100);
  unusable[1].q_WB.w = kNan;
  unusable[2].q_WB.w += 0.5f;
  unusable[3].rates_rad_s.y() = 36.0f;
  unusable[4].bias_rad_s.z() = -0.4f;
  for (std::size_t k = 0; k < unusable.size(); ++k) {
    Rig rig(2500);
    rig.estimator.resume_in_flight(unusable[k]);
    rig.sample(Attitude::from_euler(0.1, 0.3, 0).accel_at_rest(), {});
    EXPECT_NEAR(rig.estimator.estimate().roll_rad, 0.1f, 1e-5f) << k;
    EXPECT_NEAR(rig.estimator.estimate().pitch_rad, 0.3f, 1e-5f) << k;
  }
}

}  // namespace
}  // namespace rosflight::core
