// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/test/firmware_rig.hpp"

namespace rosflight::core {
namespace {

class FirmwareLeds : public testing::Test {
 protected:
  FirmwareRig rig_;
};

TEST_F(FirmwareLeds, ShowOverrideErrorsArmingAndFailsafe) {
  rig_.store_quadrotor();
  rig_.start();
  const auto status_led = [this] { return rig_.board.leds.on(hal::Led::kStatus); };
  const auto toggles_in_one_second = [&] {
    int toggles = 0;
    bool last = status_led();
    for (int k = 0; k < 400; ++k) {
      rig_.pass();
      if (status_led() != last) ++toggles;
      last = status_led();
    }
    return toggles;
  };
  rig_.run_for(100);
  EXPECT_EQ(toggles_in_one_second(), 0);
  EXPECT_FALSE(status_led()) << "disarmed: off";
  EXPECT_TRUE(rig_.board.leds.on(hal::Led::kOverride)) << "no companion: the pilot has control";
  rig_.arm();
  EXPECT_EQ(toggles_in_one_second(), 0);
  EXPECT_TRUE(status_led()) << "armed: on";
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.6f;
  rig_.offboard = link::OffboardControl{2, 0, {0, 0, 0.5f, 0, 0, 0, 0, 0, 0, 0}};
  rig_.run_for(50);
  EXPECT_FALSE(rig_.board.leds.on(hal::Led::kOverride));
  rig_.imu_on = false;
  rig_.run_for(200);
  EXPECT_EQ(toggles_in_one_second(), 2) << "error: every 500 ms";
  rig_.rc.failsafe = true;
  rig_.run_for(50);
  EXPECT_EQ(toggles_in_one_second(), 10) << "failsafe: every 100 ms";
}

TEST_F(FirmwareLeds, AreOffAfterStart) {
  rig_.board.leds.set(hal::Led::kStatus, true);
  rig_.board.leds.set(hal::Led::kOverride, true);
  rig_.start();
  EXPECT_FALSE(rig_.board.leds.on(hal::Led::kStatus));
  EXPECT_FALSE(rig_.board.leds.on(hal::Led::kOverride));
}

}  // namespace
}  // namespace rosflight::core
