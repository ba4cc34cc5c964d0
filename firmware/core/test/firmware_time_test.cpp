// SPDX-License-Identifier: BSD-3-Clause
// Clocks that run long, and firmwares that never meet.
#include <cmath>

#include "firmware/core/test/firmware_rig.hpp"

namespace rosflight::core {
namespace {

// Weak points 14 and 68: ROSflight 2.x's clock wrapped after 71.6 minutes.
class FirmwareAfter : public testing::TestWithParam<std::int64_t> {};

TEST_P(FirmwareAfter, NothingHappensWhenASmallerCounterWouldWrap) {
  const Time wrap = hal::microseconds(GetParam());
  FirmwareRig rig;
  rig.store_quadrotor();
  rig.set_time(wrap - hal::milliseconds(5000));
  rig.rc.channels[FirmwareRig::kThrottle] = 0.0f;
  rig.start();
  rig.arm();
  rig.rc.channels[FirmwareRig::kThrottle] = 0.8f;
  rig.offboard = link::OffboardControl{2, 0, {0, 0, 0.5f, 0, 0, 0, 0, 0, 0, 0}};
  rig.run_for(100);
  ASSERT_LT(rig.now(), wrap);
  rig.inbox.clear();
  std::uint64_t last_us = 0;
  while (rig.now() < wrap + hal::milliseconds(2000)) {
    rig.pass();
    ASSERT_EQ(rig.errors(), 0) << rig.now().count();
    ASSERT_TRUE(rig.armed());
    ASSERT_EQ(rig.firmware().command().override_word(), 0) << rig.now().count();
    for (std::size_t k = 0; k < 4; ++k) ASSERT_NEAR(rig.outputs()[k], 0.35f, 1e-3f);
    const auto imu = rig.got<link::Imu>();
    ASSERT_EQ(imu.size(), 1u);
    ASSERT_GT(imu[0].time_boot_us, last_us);
    last_us = imu[0].time_boot_us;
    rig.inbox.clear();
  }
  // Holds and timeouts still end.
  rig.offboard.reset();
  rig.run_for(200);
  EXPECT_EQ(rig.firmware().command().override_word(), 0x3C0);
}

INSTANTIATE_TEST_SUITE_P(Wrap, FirmwareAfter,
                         testing::Values(std::int64_t{1} << 31, std::int64_t{1} << 32,
                                         (std::int64_t{1} << 31) * 1000,
                                         (std::int64_t{1} << 32) * 1000));

// Weak point 76: function statics of one instance were seen by the other.
TEST(TwoFirmwares, InOneProcessNeverMeet) {
  const auto fly = [](FirmwareRig& rig, int k) {
    rig.gyro_rad_s = {0.1f * std::sin(0.01f * static_cast<float>(k)), 0.05f, 1e-6f};
    if (k == 100) rig.hold_arming_corner();
    if (k == 600) rig.release();
    if (k == 700) rig.rc.channels[FirmwareRig::kThrottle] = 0.6f;
    if (k == 900) rig.set_param("PID_ROLL_ANG_P", 0.3f);
    rig.pass();
  };
  FirmwareRig alone;
  alone.store_quadrotor();
  alone.start();
  for (int k = 0; k < 1500; ++k) fly(alone, k);
  ASSERT_TRUE(alone.armed());

  // The same flight, interleaved with another one that does everything differently.
  FirmwareRig one, other;
  one.store_quadrotor();
  other.store_airplane();
  one.start();
  other.start();
  for (int k = 0; k < 1500; ++k) {
    fly(one, k);
    other.gyro_rad_s = {0.0f, 0.5f, -0.5f};
    other.accel_m_s2 = {1.0f, 0.0f, -9.7f};
    other.rc.channels[FirmwareRig::kRoll] = k % 200 < 100 ? 0.2f : 0.9f;
    other.rc.failsafe = k % 500 > 400;
    other.pass();
    if (k % 3 == 0) other.pass();
  }
  EXPECT_EQ(one.outputs(), alone.outputs());
  ASSERT_EQ(one.inbox.size(), alone.inbox.size());
  const auto a = one.got<link::Attitude>();
  const auto b = alone.got<link::Attitude>();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    ASSERT_EQ(a[k].q_WB, b[k].q_WB) << k;
    ASSERT_EQ(a[k].rates_rad_s, b[k].rates_rad_s) << k;
  }
}

}  // namespace
}  // namespace rosflight::core
