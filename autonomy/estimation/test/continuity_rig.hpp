// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>
#include <limits>
#include <type_traits>

#include "autonomy/estimation/estimator.hpp"
#include "autonomy/estimation/test/world.hpp"

/// Flights of the estimator whose samples are cut, moved in time or wrong.
namespace rosflight::autonomy::estimation::test {

/// Takes the samples while the link is cut.
struct Nobody {
  template <class Sample>
  void add(const Sample&) {}
};

/// Passes samples on under the clock of a far end that has restarted, without those of some sensors.
struct Restarted {
  Estimator& estimator;
  double earlier_s{};
  bool mag{true}, baro{true}, gnss{true};

  template <class Sample>
  void add(Sample sample) {
    if (std::is_same_v<Sample, MagSample> && !mag) return;
    if (std::is_same_v<Sample, BaroSample> && !baro) return;
    if (std::is_same_v<Sample, GnssSample> && !gnss) return;
    sample.t_s -= earlier_s;
    estimator.add(sample);
  }
};

inline constexpr double kRotorDrag_s_m = 0.05;
inline const Vector3 kWind_W(3.0, -2.0, 0.0);

/// The path of multirotor_at() with rotors that drag: the specific force along body x and y is
/// -drag thrust/mass times the velocity through the air.
inline Motion dragging_at(double t) {
  Motion m = multirotor_at(t, 0.4);
  const Vector3 force_W = m.a_W - Vector3(0.0, 0.0, kGravity);
  Vector3 z = -force_W.normalized();
  for (int k = 0; k < 12; ++k) {  // contracts by drag times airspeed, 0.3 at most
    z = -(force_W - kRotorDrag_s_m * force_W.dot(z) * (m.v_W - kWind_W)).normalized();
  }
  const double psi = multirotor_heading(t, 0.4);
  const Vector3 y = z.cross(Vector3(std::cos(psi), std::sin(psi), 0.0)).normalized();
  Matrix3 R;
  R << y.cross(z), y, z;
  m.q_WB = Quaternion(R);
  return m;
}

/// To and fro without drag, the tilt 0.5 rad to both sides and up to 1.5 rad/s.
inline Motion brisk_at(double t) {
  constexpr double kSize_m = 0.5, kRate_rad_s = 3.0;
  const double c = std::cos(kRate_rad_s * t), s = std::sin(kRate_rad_s * t);
  const Vector3 along_W(kSize_m, 0.3 * kSize_m, 0.0);
  Motion m;
  m.p_W = Vector3(0.0, 0.0, -5.0) + along_W * (1.0 - c);
  m.v_W = along_W * (kRate_rad_s * s);
  m.a_W = along_W * (kRate_rad_s * kRate_rad_s * c);
  m.q_WB = thrust_attitude(m.a_W, 0.3);
  return m;
}

struct Flight {
  /// `air_model`: what the estimator takes the drag of the rotors for, by their true one.
  explicit Flight(std::uint64_t seed = 1, double air_model = 0.0,
                  const Vector3& imu_position_B = Vector3::Zero(), const Path& path = dragging_at) {
    WorldConfig config;
    config.seed = seed;
    config.filter.air.rotor_drag_s_m = air_model * kRotorDrag_s_m;
    config.filter.declination_rad = field_declination();
    config.accel_bias_sigma = 0.03;
    config.gyro_bias_sigma = 0.005;
    config.range = false;
    config.filter.imu_position_B = imu_position_B;
    world = std::make_unique<World>(config, path);
    estimator = std::make_unique<Estimator>(config.filter, Airframe::kMultirotor);
    ErrorStateEkf start;
    start.covariance().setZero();
    start.reset_variance(ErrorStateEkf::kTheta, 3, 0.02);
    start.reset_variance(ErrorStateEkf::kVelocity, 3, 0.1);
    start.reset_variance(ErrorStateEkf::kPosition, 3, 0.05);
    start.reset_variance(ErrorStateEkf::kGyroBias, 3, 0.005);
    start.reset_variance(ErrorStateEkf::kAccelBias, 3, 0.03);
    start.reset_variance(ErrorStateEkf::kBaroBias, 1, 0.05);
    start.reset_variance(ErrorStateEkf::kWind, 2, 4.0);
    start.reset_variance(ErrorStateEkf::kGnssBias, 3, 0.05);
    start.reset_variance(ErrorStateEkf::kMagBias, 3, 0.6);
    start.reset_variance(ErrorStateEkf::kAirScale, 2, 0.4);
    NominalState guess;
    guess.q_WB = world->motion(0.0).q_WB;
    guess.p_W = world->motion(0.0).p_W + guess.q_WB * imu_position_B;
    estimator->start_at(0.0, guess, start.covariance(), World::origin(),
                        World::pressure_at(World::origin().altitude_m - guess.p_W.z()));
  }
  void run_until(double t_s) {
    while (world->time_s() < t_s) world->step(*estimator);
  }
  void silence_until(double t_s) {
    Nobody nobody;
    while (world->time_s() < t_s) world->step(nobody);
  }
  /// Largest error of the attitude until t_s [rad].
  double worst_attitude_until(double t_s) {
    double worst_rad = 0.0;
    while (world->time_s() < t_s) {
      world->step(*estimator);
      worst_rad = std::max(worst_rad, attitude_error_rad());
    }
    return worst_rad;
  }
  Motion truth() const { return world->motion(world->time_s() - kStep_s); }
  double position_error_m() const { return (estimator->estimate().p_W - truth().p_W).norm(); }
  double velocity_error_m_s() const { return (estimator->estimate().v_W - truth().v_W).norm(); }
  double attitude_error_rad() const {
    return estimator->estimate().q_WB.angularDistance(truth().q_WB);
  }

  std::unique_ptr<World> world;
  std::unique_ptr<Estimator> estimator;
};

}  // namespace rosflight::autonomy::estimation::test
