// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <deque>
#include <limits>

#include "base/atmosphere.hpp"
#include "sim/faults.hpp"
#include "sim/modules.hpp"
#include "sim/portable_math.hpp"

/// Modules that break on schedule. They wrap healthy ones, which go on as if nothing happened, so
/// that everything is as it would have been once the fault is over.
namespace rosflight::sim {

class FaultySensors : public SensorsModule {
 public:
  /// Both must outlive this.
  FaultySensors(SensorsModule& sensors, const FaultSchedule& faults)
      : sensors_{sensors}, faults_{faults} {}

  /// A cover keeps the wind out of the pitot tube, as people put one on before a flight: the
  /// firmware takes the pressure it finds at its start for none.
  void set_pitot_covered(bool covered) { pitot_covered_ = covered; }

  void step(const Truth& truth, SensorSamples& s) override {
    if (pitot_covered_) {
      still_ = truth;
      still_.air.wind_W = truth.body.q_WB * truth.body.v_B;
      sensors_.step(still_, s);
    } else {
      sensors_.step(truth, s);
    }
    if (faults_.empty()) {
      if (s.has_imu) good_imu_ = s.imu;
      return;
    }
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
    if (faults_.has(FaultKind::kGnssDelay)) delay(t, s);
    if (s.has_gnss) spoil(t, s.gnss);
    if (s.has_imu) spoil(t, s.imu);
    if (s.has_baro) spoil(t, s.baro);
    if (s.has_mag) spoil(t, s.mag);
    if (s.has_diff_pressure && faults_.active(FaultKind::kPitotBlocked, t)) {
      s.diff_pressure.pressure_Pa = 0.0F;
    }
  }

 private:
  /// Fixes wait their time and arrive in order. What waits at the end of the fault is lost.
  void delay(Time t, SensorSamples& s) {
    const double delay_s = faults_.value(FaultKind::kGnssDelay, t);
    if (delay_s == 0.0) {
      late_.clear();
      return;
    }
    const Time late{static_cast<Time::rep>(delay_s * 1e6)};
    if (s.has_gnss) late_.push_back(s.gnss);
    s.has_gnss = !late_.empty() && late_.front().stamp + late <= t;
    if (!s.has_gnss) return;
    s.gnss = late_.front();
    s.gnss.stamp += late;  // a receiver stamps what it sends; only its own clock shows the age
    late_.pop_front();
  }
  void spoil(Time t, hal::GnssSample& gnss) const {
    constexpr double kMetersPerDegree = 111194.9;  // of latitude, on a sphere of 6371 km
    gnss.latitude_deg += faults_.value(FaultKind::kGnssStep, t) / kMetersPerDegree;
  }
  void spoil(Time t, hal::BaroSample& baro) const {
    const double step_m = faults_.value(FaultKind::kBaroStep, t);
    if (step_m == 0.0) return;
    // Standard atmosphere: p = p0 (1 - h/(T0/L))^(g/(R L)).
    constexpr double kSea_Pa = base::kSeaLevelPressure_Pa;
    constexpr double kScale_m = base::kTroposphere.scale_m;
    constexpr double kPower = base::kTroposphere.pressure_exponent;
    const double level = portable::log(static_cast<double>(baro.pressure_Pa) / kSea_Pa) / kPower;
    const double share = portable::exp(level) - step_m / kScale_m;
    baro.pressure_Pa = static_cast<float>(kSea_Pa * portable::exp(kPower * portable::log(share)));
  }
  void spoil(Time t, hal::MagSample& mag) const {
    const double turn_rad = faults_.value(FaultKind::kMagTurned, t);
    if (turn_rad == 0.0) return;
    const auto [sine, cosine] = portable::sin_cos(turn_rad);
    const auto c = static_cast<float>(cosine);
    const auto s = static_cast<float>(sine);
    const hal::Vec3 m = mag.field_T;  // an instrument turned by +psi reads the field turned by -psi
    mag.field_T = {c * m[0] + s * m[1], -s * m[0] + c * m[1], m[2]};
  }
  void spoil(Time t, hal::ImuSample& imu) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      imu.accel_m_s2[axis] += static_cast<float>(faults_.value(FaultKind::kAccelStep, t, axis));
      imu.gyro_rad_s[axis] += static_cast<float>(faults_.value(FaultKind::kGyroStep, t, axis));
    }
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
  std::deque<hal::GnssSample> late_;
  Truth still_;
  bool pitot_covered_{false};
};

/// Passes the faults of motors, surfaces and battery on. Once per step.
inline void apply_actuator_faults(const FaultSchedule& faults, Time t, ForcesAndMoments& forces) {
  if (faults.empty()) return;
  for (std::size_t k = 0; k < kMaxRotors; ++k) {
    if (faults.has(FaultKind::kMotor)) forces.set_thrust_factor(k, faults.thrust_factor(k, t));
    if (faults.has(FaultKind::kServo)) forces.set_surface_stuck(k, faults.servo_stuck(k, t));
  }
  if (faults.has(FaultKind::kBatteryLow)) {
    forces.set_charge_limit(faults.active(FaultKind::kBatteryLow, t) ? kLowCharge : 1.0);
  }
}

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
