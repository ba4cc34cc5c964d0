// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <limits>

#include "sim/faults.hpp"
#include "sim/modules.hpp"

/// Modules that break on schedule. They wrap healthy ones, which go on as if nothing happened, so
/// that everything is as it would have been once the fault is over.
namespace rosflight::sim {

class FaultySensors : public SensorsModule {
 public:
  /// Both must outlive this.
  FaultySensors(SensorsModule& sensors, const FaultSchedule& faults)
      : sensors_{sensors}, faults_{faults} {}

  void step(const Truth& truth, SensorSamples& s) override {
    sensors_.step(truth, s);
    const Time t = truth.time;
    const auto off = [this, t](FaultKind kind, bool& has) {
      if (faults_.active(kind, t)) has = false;
    };
    off(FaultKind::kImu, s.has_imu);
    off(FaultKind::kMag, s.has_mag);
    off(FaultKind::kBaro, s.has_baro);
    off(FaultKind::kGnss, s.has_gnss);
    off(FaultKind::kDiffPressure, s.has_diff_pressure);
    off(FaultKind::kRange, s.has_range);
    off(FaultKind::kBattery, s.has_battery);
    if (s.has_imu) spoil(t, s.imu);
  }

 private:
  void spoil(Time t, hal::ImuSample& imu) {
    if (faults_.active(FaultKind::kImuStuck, t)) {
      imu.accel_m_s2 = good_imu_.accel_m_s2;
      imu.gyro_rad_s = good_imu_.gyro_rad_s;
    } else {
      good_imu_ = imu;
    }
    if (faults_.active(FaultKind::kImuNan, t)) {
      imu.accel_m_s2.fill(std::numeric_limits<float>::quiet_NaN());
      imu.gyro_rad_s.fill(std::numeric_limits<float>::quiet_NaN());
    }
  }

  SensorsModule& sensors_;
  const FaultSchedule& faults_;
  hal::ImuSample good_imu_;
};

class FaultyRc : public RcModule {
 public:
  /// Both must outlive this.
  FaultyRc(RcModule& rc, const FaultSchedule& faults) : rc_{rc}, faults_{faults} {}

  bool step(Time t, hal::RcFrame& frame) override {
    if (!rc_.step(t, frame)) return false;
    if (faults_.active(FaultKind::kRcFrameLoss, t)) frame.frame_lost = true;
    return !faults_.active(FaultKind::kRcSilence, t);
  }

 private:
  RcModule& rc_;
  const FaultSchedule& faults_;
};

}  // namespace rosflight::sim
