// SPDX-License-Identifier: BSD-3-Clause
// A fixed wing without GNSS: what holds its attitude, in still air and in gusts, with a gyro that is well and with one
// that is suddenly wrong. Lift, pitot tube and gusts are in closed form.
#include <gtest/gtest.h>

#include <array>

#include "autonomy/estimation/estimator.hpp"
#include "autonomy/estimation/test/world.hpp"

namespace rosflight::autonomy::estimation::test {
namespace {

/// Gusts as a sum of waves with the spectrum of a first-order process, 0.02 to 2 Hz.
class Gusts {
 public:
  Gusts(double sigma_m_s, double time_s, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> phase(0.0, 2.0 * base::kPi);
    constexpr double kLowest_rad_s = 0.13;
    const double ratio = std::pow(100.0, 1.0 / kWaves);
    double w = kLowest_rad_s;
    for (Wave& wave : waves_) {
      const double density =
          2.0 * sigma_m_s * sigma_m_s * time_s / (base::kPi * (1.0 + w * w * time_s * time_s));
      wave = {std::sqrt(2.0 * density * w * (std::sqrt(ratio) - 1.0 / std::sqrt(ratio))), w,
              phase(random)};
      w *= ratio;
    }
  }
  double at(double t_s) const {
    double sum = 0.0;
    for (const Wave& wave : waves_) sum += wave.size * std::sin(wave.rate_rad_s * t_s + wave.phase);
    return sum;
  }

 private:
  static constexpr int kWaves = 24;
  struct Wave {
    double size{}, rate_rad_s{}, phase{};
  };
  std::array<Wave, kWaves> waves_{};
};

constexpr LiftModel kLift{0.1156, 0.506, 5.61};
constexpr double kSideArea_m2_kg = 0.113;
const Vector3 kSteadyWind_W(4.0, -3.0, 0.0);

/// Circles in air that drifts, at 15 m/s, without sideslip, at the angle of attack that carries it.
Motion circling_at(double t, double radius_m, double gust_down_m_s) {
  constexpr double kSpeed_m_s = 15.0, kClimb_rad_s = 0.25;
  constexpr double kPhase_rad =
      0.18;  // along the field at first, where a wrong pitch does not move the heading
  const double w = kSpeed_m_s / radius_m;
  const double c = std::cos(w * t + kPhase_rad), s = std::sin(w * t + kPhase_rad);
  const double cc = std::cos(kClimb_rad_s * t), cs = std::sin(kClimb_rad_s * t);
  Motion m;
  m.p_W = kSteadyWind_W * t + Vector3(radius_m * s, -radius_m * c, -60.0 + 4.0 * cc);
  m.v_W = kSteadyWind_W + Vector3(kSpeed_m_s * c, kSpeed_m_s * s, -4.0 * kClimb_rad_s * cs);
  m.a_W = {-kSpeed_m_s * w * s, kSpeed_m_s * w * c, -4.0 * kClimb_rad_s * kClimb_rad_s * cc};
  const Vector3 f = m.a_W - Vector3(0.0, 0.0, kGravity);
  const Vector3 air_W = m.v_W - kSteadyWind_W - Vector3(0.0, 0.0, gust_down_m_s);
  const Vector3 ahead = air_W.normalized();
  const double along = f.dot(ahead);
  const Vector3 lift_W = f - along * ahead;
  const Vector3 up = lift_W.normalized();
  const double pressure_Pa = World::pressure_at(World::origin().altitude_m - m.p_W.z());
  const double density = 1.225 * std::pow(pressure_Pa / 101325.0, 0.809737);
  const double pressure = 0.5 * density * kLift.area_m2_kg * air_W.squaredNorm();
  double alpha = 0.0;
  for (int k = 0; k < 6; ++k) {  // contracts by the share of gravity along the path
    const double coefficient =
        (lift_W.norm() * std::cos(alpha) - along * std::sin(alpha)) / pressure;
    alpha = (coefficient - kLift.zero) / kLift.slope_1_rad;
  }
  Matrix3 R;
  R.col(0) = ahead * std::cos(alpha) + up * std::sin(alpha);
  R.col(2) = ahead * std::sin(alpha) - up * std::cos(alpha);
  R.col(1) = R.col(2).cross(R.col(0));
  m.q_WB = Quaternion(R);
  return m;
}

struct Wing {
  static constexpr double kCircle_m = 80.0;
  static constexpr double kStraight_m = 5000.0;  ///< As good as straight on.

  /// @param gusts  by those of 6 m/s at 6 m height: vertical 0.6 m/s, along the nose 0.95 m/s.
  Wing(double gusts, std::uint64_t seed, double radius_m = kCircle_m, bool lift_known = true)
      : down{0.6 * gusts, 2.2, seed}, nose{0.95 * gusts, 13.0, seed + 100} {
    config.filter.declination_rad = field_declination();
    config.filter.use_sideslip = false;
    config.filter.sideslip_sigma_m_s = 30.0;  // no vane
    config.filter.air.side_area_m2_kg = kSideArea_m2_kg;
    // The side force shows no gusts here, so that they are not learned from it: sigma sqrt(2/T) is known.
    config.filter.noise.wind_m_s_rts = std::max(0.05, 0.95 * gusts * std::sqrt(2.0 / 13.0));
    if (lift_known) config.filter.air.lift = kLift;
    config.fixedwing = true;
    config.range = false;
    config.seed = seed;
    config.gyro_bias_sigma = 0.002;
    config.accel_bias_sigma = 0.03;
    config.wind_W = kSteadyWind_W;
    world = std::make_unique<World>(
        config, [this, radius_m](double t) { return circling_at(t, radius_m, down.at(t)); });
    estimator = std::make_unique<Estimator>(config.filter, Airframe::kFixedWing);
  }
  void run_until(double t_s) {
    while (world->time_s() < t_s) {
      const double now_s = world->time_s();
      if (!estimator->initialised()) {
        estimator->set_attitude_hint(now_s, world->motion(now_s).q_WB);
      }
      world->extra_airspeed_m_s = nose.at(now_s);
      world->step(*estimator);
      worst_rad = std::max(worst_rad, tilt_error_rad());
    }
  }
  /// A minute with GNSS, then without; the gyro steps 3 s later.
  void lose_gnss(const Vector3& gyro_step_rad_s) {
    run_until(60.0);
    world->gnss_on = false;
    run_until(63.0);
    world->extra_gyro = gyro_step_rad_s;
    worst_rad = 0.0;
  }
  /// Error of the vertical: the heading without GNSS is the magnetometer's affair.
  double tilt_error_rad() const {
    const StateEstimate e = estimator->estimate();
    const Vector3 down_B = world->motion(e.t_s).q_WB.conjugate() * Vector3::UnitZ();
    return std::acos(std::clamp((e.q_WB * down_B).z(), -1.0, 1.0));
  }
  Vector3 gyro_bias_error() const {
    return estimator->estimate().gyro_bias_B -
           world->truth_at(estimator->filter_time_s()).gyro_bias_B - world->extra_gyro;
  }

  Gusts down, nose;
  WorldConfig config;
  std::unique_ptr<World> world;
  std::unique_ptr<Estimator> estimator;
  double worst_rad{};
};

TEST(WingWithoutGnss, AGyroStepIsLearnedBeforeTheAttitudeIsLost) {
  for (const double gusts : {0.0, 0.7, 1.0}) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double step : {0.1, -0.1, 0.05, -0.02}) {
        Wing wing(gusts, static_cast<std::uint64_t>(1 + axis),
                  step > 0.0 ? Wing::kStraight_m : Wing::kCircle_m);
        wing.lose_gnss(step * Vector3::Unit(axis));
        wing.run_until(83.0);
        std::printf("gusts %.1f, step %5.2f about %d: worst %.3f rad, then %.3f rad, bias %.3f\n",
                    gusts, step, axis, wing.worst_rad, wing.tilt_error_rad(),
                    wing.gyro_bias_error().norm());
        EXPECT_LT(wing.worst_rad, gusts > 0.0 ? 0.25 : 0.12)
            << gusts << ", " << step << " about " << axis;
        EXPECT_LT(wing.tilt_error_rad(), gusts > 0.0 ? 0.15 : 0.03)
            << gusts << ", " << step << " about " << axis;
        EXPECT_LT(wing.gyro_bias_error().norm(), 0.03)
            << gusts << ", " << step << " about " << axis;
      }
    }
  }
}

TEST(WingWithoutGnss, WithoutTheLiftAPitchStepIsNotFound) {
  double worst_rad = 0.0;
  for (const double gusts : {0.0, 0.4, 1.0}) {
    for (const double step : {0.1, -0.1, 0.05}) {
      Wing wing(gusts, 1, Wing::kStraight_m, false);
      wing.lose_gnss({0.0, step, 0.0});
      wing.run_until(83.0);
      std::printf("gusts %.1f, step %5.2f: worst %.3f rad\n", gusts, step, wing.worst_rad);
      worst_rad = std::max(worst_rad, wing.worst_rad);
    }
  }
  EXPECT_GT(worst_rad, 0.3);
}

TEST(WingWithoutGnss, AGyroThatIsWellIsLeftAlone) {
  for (const double gusts : {0.0, 0.7, 1.0}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      Wing wing(gusts, seed);
      wing.lose_gnss(Vector3::Zero());
      wing.run_until(180.0);
      std::printf("gusts %.1f, seed %d: worst %.3f rad, %d + %d widenings\n", gusts,
                  static_cast<int>(seed), wing.worst_rad,
                  static_cast<int>(wing.estimator->health().imu_widenings),
                  static_cast<int>(wing.estimator->health().heading_widenings));
      EXPECT_LT(wing.worst_rad, gusts > 0.0 ? 0.2 : 0.01) << gusts << ", " << seed;
      if (gusts > 0.0) continue;
      EXPECT_EQ(wing.estimator->health().imu_widenings, 0U) << seed;
    }
  }
}

TEST(WingWithoutGnss, WithGnssTheLiftTeachesTheGustsAndItsErrorAlone) {
  constexpr double kOffset_rad = 0.02;  // by which the estimator's lift is off
  for (const double gusts : {0.0, 1.0}) {
    Wing with(gusts, 5), without(gusts, 5, Wing::kCircle_m, false);
    LiftModel& lift = with.config.filter.air.lift;
    lift.zero -= lift.slope_1_rad * kOffset_rad;
    with.estimator = std::make_unique<Estimator>(with.config.filter, Airframe::kFixedWing);
    for (Wing* wing : {&with, &without}) wing->run_until(60.0);
    const NominalState& x = with.estimator->filter().state();
    const NominalState& y = without.estimator->filter().state();
    const ErrorStateEkf::Error difference = ErrorStateEkf::difference(x, y);
    EXPECT_LT(difference.head<ErrorStateEkf::kGust>().cwiseAbs().maxCoeff(), 1e-8) << gusts;
    EXPECT_NEAR(x.lift_offset_rad, kOffset_rad, gusts > 0.0 ? 0.01 : 0.004) << gusts;
  }
}

}  // namespace
}  // namespace rosflight::autonomy::estimation::test
