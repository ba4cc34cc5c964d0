// SPDX-License-Identifier: BSD-3-Clause
#include "sim/faults.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "config/strict_yaml.hpp"
#include "sim/faulty_modules.hpp"
#include "sim/types.hpp"

namespace rosflight::sim {
namespace {

Time ms(std::int64_t value) {
  return Time{value * 1000};
}

std::string message_of(std::string_view text) {
  try {
    static_cast<void>(parse_fault(text));
  } catch (const config::Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Fault, EveryNameIsRead) {
  const std::pair<const char*, FaultKind> names[]{{"imu", FaultKind::kImu},
                                                  {"mag", FaultKind::kMag},
                                                  {"baro", FaultKind::kBaro},
                                                  {"gnss", FaultKind::kGnss},
                                                  {"diff_pressure", FaultKind::kDiffPressure},
                                                  {"range", FaultKind::kRange},
                                                  {"battery", FaultKind::kBattery},
                                                  {"imu_nan", FaultKind::kImuNan},
                                                  {"imu_stuck", FaultKind::kImuStuck},
                                                  {"rc_silence", FaultKind::kRcSilence},
                                                  {"rc_frame_loss", FaultKind::kRcFrameLoss},
                                                  {"link_cut", FaultKind::kLinkCut},
                                                  {"pitot_blocked", FaultKind::kPitotBlocked},
                                                  {"crash", FaultKind::kCrash},
                                                  {"hang", FaultKind::kHang},
                                                  {"companion_stall", FaultKind::kCompanionStall},
                                                  {"battery_low", FaultKind::kBatteryLow},
                                                  {"motion_capture", FaultKind::kMotionCapture},
                                                  {"motor0_dead", FaultKind::kMotor}};
  for (const auto& [name, kind] : names) {
    EXPECT_EQ(parse_fault(std::string(name) + "@1").kind, kind) << name;
    if (kind == FaultKind::kMotor) continue;
    EXPECT_NE(fault_help().find(std::string("  ") + name + " "), std::string::npos);
  }
  EXPECT_NE(fault_help().find("motorN_partial=FACTOR"), std::string::npos);
  EXPECT_NE(fault_help().find("motorN_dead"), std::string::npos);
}

TEST(Fault, TimesAreSecondsToTheMicrosecond) {
  const Fault fault = parse_fault("gnss@12.5:0.000001");
  EXPECT_EQ(fault.start, Time{12'500'000});
  EXPECT_EQ(fault.end, Time{12'500'001});
  EXPECT_EQ(parse_fault("gnss@0").start, Time{0});
  EXPECT_EQ(parse_fault("gnss@0").end, Time::max());
}

TEST(Fault, MotorsHaveNumberAndFactor) {
  const Fault partial = parse_fault("motor2_partial=0.6@10:5");
  EXPECT_EQ(partial.kind, FaultKind::kMotor);
  EXPECT_EQ(partial.motor, 2U);
  EXPECT_EQ(partial.factor, 0.6);
  EXPECT_EQ(partial.end, Time{15'000'000});
  EXPECT_EQ(parse_fault("motor9=1@0").factor, 1.0);
  EXPECT_EQ(parse_fault("motor9=1@0").motor, 9U);
  EXPECT_EQ(parse_fault("motor3_dead@1").factor, 0.0);
}

TEST(Fault, StepsHaveAValueInTheUnitOfTheirName) {
  EXPECT_EQ(parse_fault("baro_step=-5@10").kind, FaultKind::kBaroStep);
  EXPECT_EQ(parse_fault("baro_step=-5@10").value, -5.0);
  EXPECT_NEAR(parse_fault("mag_turned=30@10").value, 0.5235987755982988, 1e-15);
  EXPECT_EQ(parse_fault("accel_step_z=0.3@10:5").axis, 2U);
  EXPECT_EQ(parse_fault("gyro_step_y=0.02@1").axis, 1U);
  EXPECT_NE(fault_help().find("  gyro_step_x=VALUE "), std::string::npos);
  EXPECT_EQ(
      message_of("baro_step@1"),
      "--fault baro_step@1: found the value nothing, allowed baro_step=VALUE with at most 1000 "
      "either way");
  EXPECT_EQ(message_of("gyro_step_x=11@1"),
            "--fault gyro_step_x=11@1: found the value \"11\", allowed gyro_step_x=VALUE with at "
            "most 10 either way");
  EXPECT_NE(message_of("mag_turned=nan@1").find("allowed mag_turned=VALUE"), std::string::npos);
}

TEST(Fault, SizesThatHaveNoSignRefuseOne) {
  EXPECT_EQ(parse_fault("gnss_step=-30@10").value, -30.0);
  EXPECT_EQ(parse_fault("gnss_delay=0.5@10").kind, FaultKind::kGnssDelay);
  EXPECT_EQ(parse_fault("link_noise=0.01@10:3").value, 0.01);
  EXPECT_EQ(message_of("link_noise=-0.1@1"),
            "--fault link_noise=-0.1@1: found the value \"-0.1\", allowed link_noise=VALUE with 0 "
            "to 1");
  EXPECT_EQ(message_of("gnss_delay=11@1"),
            "--fault gnss_delay=11@1: found the value \"11\", allowed gnss_delay=VALUE with 0 to "
            "10");
}

TEST(Fault, SurfacesHaveANumber) {
  const Fault stuck = parse_fault("servo2_stuck@10:5");
  EXPECT_EQ(stuck.kind, FaultKind::kServo);
  EXPECT_EQ(stuck.motor, 2U);
  const FaultSchedule faults({stuck, parse_fault("motor1_dead@10")});
  EXPECT_TRUE(faults.servo_stuck(2, ms(10'000)));
  EXPECT_FALSE(faults.servo_stuck(2, ms(15'000)));
  EXPECT_FALSE(faults.servo_stuck(1, ms(12'000))) << "that is the motor's";
  EXPECT_EQ(faults.thrust_factor(2, ms(12'000)), 1.0) << "that is the surface's";
  EXPECT_TRUE(faults.has(FaultKind::kServo));
  EXPECT_FALSE(faults.has(FaultKind::kGnss));
}

TEST(Fault, BadTextIsOneLineWithWhatIsAllowed) {
  EXPECT_EQ(message_of("imu@"), "--fault imu@: found the time nothing, allowed seconds >= 0");
  EXPECT_EQ(message_of("imu@-1"), "--fault imu@-1: found the time \"-1\", allowed seconds >= 0");
  EXPECT_EQ(message_of("imu@5:0"),
            "--fault imu@5:0: found the duration \"0\", allowed seconds > 0");
  EXPECT_EQ(message_of("imu@5:"),
            "--fault imu@5:: found the duration nothing, allowed seconds > 0");
  EXPECT_EQ(message_of("imu@1e99"),
            "--fault imu@1e99: found the time \"1e99\", allowed seconds >= 0");
  EXPECT_EQ(message_of("imu"), "--fault imu: found no time, allowed WHAT@TIME[:DURATION]");
  EXPECT_EQ(message_of("motor1=1.5@2"),
            "--fault motor1=1.5@2: found the factor \"1.5\", allowed a number from 0 to 1");
  EXPECT_EQ(message_of("motor1=nan@2"),
            "--fault motor1=nan@2: found the factor \"nan\", allowed a number from 0 to 1");
  EXPECT_EQ(
      message_of("gyro@3"),
      "--fault gyro@3: found \"gyro\", allowed imu, mag, baro, gnss, diff_pressure, range, "
      "battery, "
      "imu_nan, imu_stuck, rc_silence, rc_frame_loss, link_cut, crash, hang, pitot_blocked, "
      "companion_stall, battery_low, motion_capture, baro_step=VALUE, "
      "mag_turned=VALUE, accel_step_x=VALUE, accel_step_y=VALUE, accel_step_z=VALUE, "
      "gyro_step_x=VALUE, gyro_step_y=VALUE, gyro_step_z=VALUE, gnss_step=VALUE, gnss_delay=VALUE, "
      "link_noise=VALUE, servoN_stuck, motorN_dead, motorN_partial=FACTOR "
      "(or motorN=FACTOR), N from 0 to 9");
  for (const char* text : {"", "@", "@1", "motor@1", "motor_dead@1", "motor12_dead@1", "motor1@1",
                           "IMU@1", "motor1_half=0.5@1", "motorX_dead@1", "servo@1", "servo1@1",
                           "servo1_dead@1", "servoX_stuck@1", "servo12_stuck@1"}) {
    EXPECT_NE(message_of(text).find("allowed imu, mag"), std::string::npos) << text;
    EXPECT_EQ(message_of(text).find('\n'), std::string::npos);
  }
}

TEST(FaultSchedule, FaultsHoldFromTheirStartUpToTheirEnd) {
  const FaultSchedule faults(
      {parse_fault("baro@1:0.5"), parse_fault("baro@3"), parse_fault("mag@2:1")});
  EXPECT_FALSE(faults.active(FaultKind::kBaro, ms(999)));
  EXPECT_TRUE(faults.active(FaultKind::kBaro, ms(1000)));
  EXPECT_TRUE(faults.active(FaultKind::kBaro, ms(1499)));
  EXPECT_FALSE(faults.active(FaultKind::kBaro, ms(1500)));
  EXPECT_TRUE(faults.active(FaultKind::kBaro, ms(1'000'000)));
  EXPECT_FALSE(faults.active(FaultKind::kMag, ms(1000)));
  EXPECT_TRUE(faults.active(FaultKind::kMag, ms(2000)));
  EXPECT_FALSE(faults.active(FaultKind::kGnss, ms(2000)));
  EXPECT_FALSE(FaultSchedule().active(FaultKind::kImu, ms(0)));
}

TEST(FaultSchedule, MotorFactorsMultiply) {
  const FaultSchedule faults(
      {parse_fault("motor1=0.5@1:2"), parse_fault("motor1=0.5@2"), parse_fault("motor2_dead@2:1")});
  EXPECT_EQ(faults.thrust_factor(1, ms(500)), 1.0);
  EXPECT_EQ(faults.thrust_factor(1, ms(1000)), 0.5);
  EXPECT_EQ(faults.thrust_factor(1, ms(2000)), 0.25);
  EXPECT_EQ(faults.thrust_factor(1, ms(3000)), 0.5);
  EXPECT_EQ(faults.thrust_factor(2, ms(2500)), 0.0);
  EXPECT_EQ(faults.thrust_factor(0, ms(2500)), 1.0);
  EXPECT_EQ(FaultSchedule().thrust_factor(0, ms(0)), 1.0);
}

/// Everything new at every step; the IMU counts.
class EagerSensors : public SensorsModule {
 public:
  void step(const Truth& truth, SensorSamples& s) override {
    s.has_imu = s.has_mag = s.has_baro = s.has_diff_pressure = s.has_range = s.has_gnss =
        s.has_battery = true;
    ++count_;
    s.imu.stamp = truth.time;
    s.imu.gyro_rad_s = {count_, count_, count_};
    s.imu.accel_m_s2 = {-count_, -count_, -count_};
  }

 private:
  float count_{0.0F};
};

struct Sensing {
  explicit Sensing(const char* fault) : faults{{parse_fault(fault)}} {}

  const SensorSamples& at(std::int64_t t_ms) {
    Truth truth;
    truth.time = ms(t_ms);
    faulty.step(truth, samples);
    return samples;
  }

  FaultSchedule faults;
  EagerSensors healthy;
  FaultySensors faulty{healthy, faults};
  SensorSamples samples;
};

TEST(FaultySensors, OnlyTheSensorNamedStopsAndComesBack) {
  using Flag = bool SensorSamples::*;
  const std::pair<const char*, Flag> sensors[]{
      {"imu@1:1", &SensorSamples::has_imu},
      {"mag@1:1", &SensorSamples::has_mag},
      {"baro@1:1", &SensorSamples::has_baro},
      {"gnss@1:1", &SensorSamples::has_gnss},
      {"diff_pressure@1:1", &SensorSamples::has_diff_pressure},
      {"range@1:1", &SensorSamples::has_range},
      {"battery@1:1", &SensorSamples::has_battery}};
  for (const auto& [fault, broken] : sensors) {
    Sensing sensing(fault);
    EXPECT_TRUE(sensing.at(0).*broken) << fault;
    const SensorSamples during = sensing.at(1500);
    for (const auto& [name, flag] : sensors)
      EXPECT_EQ(during.*flag, flag != broken) << fault << name;
    EXPECT_TRUE(sensing.at(2000).*broken) << fault;
  }
}

TEST(FaultySensors, StepsAndTurnsAreAsLargeAsAskedAndPass) {
  Sensing accel("accel_step_y=0.5@1:1");
  EXPECT_EQ(accel.at(0).imu.accel_m_s2[1], -1.0F);
  EXPECT_EQ(accel.at(1000).imu.accel_m_s2[1], -2.0F + 0.5F);
  EXPECT_EQ(accel.samples.imu.accel_m_s2[0], -2.0F);
  EXPECT_EQ(accel.samples.imu.gyro_rad_s[1], 2.0F);
  EXPECT_EQ(accel.at(2000).imu.accel_m_s2[1], -3.0F);
  Sensing gyro("gyro_step_z=-0.25@1");
  EXPECT_EQ(gyro.at(1000).imu.gyro_rad_s[2], 1.0F - 0.25F);

  Sensing mag("mag_turned=90@1");
  mag.samples.mag.field_T = {2e-5F, 1e-5F, 4e-5F};
  mag.at(1000);  // turned right by 90 degrees: x now reads what y did, y the opposite of x
  EXPECT_NEAR(mag.samples.mag.field_T[0], 1e-5, 1e-10);
  EXPECT_NEAR(mag.samples.mag.field_T[1], -2e-5, 1e-10);
  EXPECT_EQ(mag.samples.mag.field_T[2], 4e-5F);

  // US Standard Atmosphere 1976, table I: 898.76 hPa at 1000 m, 954.61 hPa at 500 m (geopotential).
  Sensing baro("baro_step=500@1");
  baro.samples.baro.pressure_Pa = 95461.0F;
  baro.at(1000);
  EXPECT_NEAR(baro.samples.baro.pressure_Pa, 89876.0, 3.0);

  Sensing pitot("pitot_blocked@1");
  pitot.samples.diff_pressure.pressure_Pa = 120.0F;
  EXPECT_EQ(pitot.at(0).diff_pressure.pressure_Pa, 120.0F);
  EXPECT_EQ(pitot.at(1000).diff_pressure.pressure_Pa, 0.0F);
}

TEST(FaultySensors, AStuckImuRepeatsItsLastGoodValuesUnderNewStamps) {
  Sensing sensing("imu_stuck@1:1");
  sensing.at(900);
  const hal::ImuSample stuck = sensing.at(1000).imu;
  EXPECT_EQ(stuck.gyro_rad_s[0], 1.0F);
  EXPECT_EQ(stuck.accel_m_s2[2], -1.0F);
  EXPECT_EQ(stuck.stamp, ms(1000));
  EXPECT_EQ(sensing.at(1999).imu.gyro_rad_s[1], 1.0F);
  EXPECT_EQ(sensing.at(2000).imu.gyro_rad_s[1], 4.0F);
}

TEST(FaultySensors, ANanImuIsNanAndNothingElse) {
  Sensing sensing("imu_nan@1:1");
  EXPECT_EQ(sensing.at(0).imu.gyro_rad_s[0], 1.0F);
  const SensorSamples& during = sensing.at(1000);
  EXPECT_TRUE(during.has_imu);
  for (const float value : during.imu.gyro_rad_s) EXPECT_TRUE(std::isnan(value));
  for (const float value : during.imu.accel_m_s2) EXPECT_TRUE(std::isnan(value));
  EXPECT_EQ(during.imu.stamp, ms(1000));
  EXPECT_EQ(sensing.at(2000).imu.gyro_rad_s[0], 3.0F);
}

TEST(FaultySensors, ASatelliteStepMovesThePositionNorthAndNothingElse) {
  Sensing sensing("gnss_step=111.1949@1:1");
  sensing.samples.gnss.latitude_deg = 40.0;
  sensing.samples.gnss.longitude_deg = -111.0;
  sensing.samples.gnss.velocity_ned_m_s = {1.0F, 2.0F, 3.0F};
  sensing.at(0);
  EXPECT_EQ(sensing.samples.gnss.latitude_deg, 40.0);
  sensing.at(1000);
  // A minute of arc is a sea mile, 1852 m, within the half per cent of the sphere.
  EXPECT_NEAR(sensing.samples.gnss.latitude_deg, 40.0 + 111.1949 / 1852.0 / 60.0, 5e-6);
  EXPECT_EQ(sensing.samples.gnss.longitude_deg, -111.0);
  EXPECT_EQ(sensing.samples.gnss.velocity_ned_m_s[0], 1.0F);
}

TEST(FaultySensors, LateFixesComeInOrderUnderTheStampOfTheirArrival) {
  Sensing sensing("gnss_delay=0.5@1:2");
  for (std::int64_t t = 0; t <= 4000; t += 100) {
    sensing.samples.gnss = {};
    sensing.samples.gnss.stamp = ms(t);
    sensing.samples.gnss.unix_s = t;
    const SensorSamples& now = sensing.at(t);
    if (t < 1000 || t >= 3000) {
      ASSERT_TRUE(now.has_gnss);
      ASSERT_EQ(now.gnss.unix_s, t);
    } else if (t < 1500) {
      ASSERT_FALSE(now.has_gnss) << t;
    } else {
      ASSERT_TRUE(now.has_gnss) << t;
      ASSERT_EQ(now.gnss.unix_s, t - 500);
      ASSERT_EQ(now.gnss.stamp, ms(t));
    }
  }
}

class EagerRc : public RcModule {
 public:
  bool step(Time t, hal::RcFrame& frame) override {
    frame = {};
    frame.stamp = t;
    return true;
  }
};

TEST(FaultyRc, SilenceAndFrameLoss) {
  const FaultSchedule faults({parse_fault("rc_silence@1:1"), parse_fault("rc_frame_loss@2:1")});
  EagerRc healthy;
  FaultyRc rc(healthy, faults);
  hal::RcFrame frame;
  EXPECT_TRUE(rc.step(ms(0), frame));
  EXPECT_FALSE(frame.frame_lost);
  EXPECT_FALSE(rc.step(ms(1500), frame));
  EXPECT_TRUE(rc.step(ms(2000), frame));
  EXPECT_TRUE(frame.frame_lost);
  EXPECT_TRUE(rc.step(ms(3000), frame));
  EXPECT_FALSE(frame.frame_lost);
}

}  // namespace
}  // namespace rosflight::sim
