// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <random>
#include <vector>

#include "autonomy/estimation/estimator.hpp"

/// A world to judge estimators in: motion in closed form, so that truth has no integration error,
/// and sensors whose noise is exactly what the filter assumes. Knows nothing of the simulator.
namespace rosflight::autonomy::estimation::test {

inline constexpr double kGravity = 9.80665;
inline constexpr double kStep_s = 0.0025;
/// Provo, by WMM2025 (NOAA's calculator agrees to 10 nT): about the field the vehicles fly in.
inline const Vector3 kField_W_T(2.0722e-5, 3.7735e-6, 4.5549e-5);

struct Motion {
  Vector3 p_W{Vector3::Zero()}, v_W{Vector3::Zero()}, a_W{Vector3::Zero()};
  Quaternion q_WB{Quaternion::Identity()};
};

/// Where something is at any time.
using Path = std::function<Motion(double)>;

/// Body z along the thrust, as a multirotor flies.
inline Quaternion thrust_attitude(const Vector3& a_W, double psi_rad) {
  const Vector3 z = -(a_W - Vector3(0.0, 0.0, kGravity)).normalized();
  const Vector3 y = z.cross(Vector3(std::cos(psi_rad), std::sin(psi_rad), 0.0)).normalized();
  Matrix3 R;
  R.col(0) = y.cross(z);
  R.col(1) = y;
  R.col(2) = z;
  return Quaternion(R);
}

inline double multirotor_heading(double t, double phase) {
  return 0.3 + phase + 0.8 * std::sin(0.4 * t);
}

inline Motion multirotor_at(double t, double phase) {
  Motion m;
  const double a = 4.0 + phase;
  const double w = 0.55;
  const double c = std::cos(w * t), s = std::sin(w * t);
  const double c2 = std::cos(2.0 * w * t), s2 = std::sin(2.0 * w * t);
  // Starts at rest: a (1 - cos) has no speed at t = 0.
  m.p_W = {a * (1.0 - c), 3.0 * (1.0 - c2), -5.0 - 1.5 * (1.0 - c)};
  m.v_W = {a * w * s, 6.0 * w * s2, -1.5 * w * s};
  m.a_W = {a * w * w * c, 12.0 * w * w * c2, -1.5 * w * w * c};
  m.q_WB = thrust_attitude(m.a_W, multirotor_heading(t, phase));
  return m;
}

/// Attitude with body x along the velocity through the air and no lateral force: a coordinated
/// flight without sideslip.
inline Motion fixedwing_at(double t, double phase, const Vector3& wind_W) {
  Motion m;
  const double radius = 90.0, speed = 15.0;
  const double w = speed / radius;
  // An eight: turns both ways, with climbs.
  const double c = std::cos(w * t + phase), s = std::sin(w * t + phase);
  const double c2 = std::cos(2.0 * w * t), s2 = std::sin(2.0 * w * t);
  const double drift = 12.0;
  m.p_W = {radius * s + drift * t, 60.0 * c, -60.0 - 8.0 * (1.0 - c2)};
  m.v_W = {speed * c + drift, -60.0 * w * s, -16.0 * w * s2};
  m.a_W = {-speed * w * s, -60.0 * w * w * c, -32.0 * w * w * c2};
  const Vector3 f = m.a_W - Vector3(0.0, 0.0, kGravity);
  const Vector3 x = (m.v_W - wind_W).normalized();
  const Vector3 z = -(f - f.dot(x) * x).normalized();
  Matrix3 R;
  R.col(0) = x;
  R.col(1) = z.cross(x);
  R.col(2) = z;
  m.q_WB = Quaternion(R);
  return m;
}

/// Standard deviations and rates of the world's sensors; what matters to the filter is copied from
/// an EstimatorConfig so that both agree.
struct WorldConfig {
  EstimatorConfig filter;  ///< Whose noise is simulated.
  std::uint64_t seed{1};
  double gnss_delay_s{0.03};
  double baro_delay_s{0.004};
  double mag_delay_s{0.003};
  double gyro_bias_sigma{0.01};
  double accel_bias_sigma{0.1};
  double mag_bias_sigma_T{6e-7};
  bool range{true};
  bool fixedwing{false};
  Vector3 wind_W{Vector3::Zero()};
};

/// Runs sensors along a path. Samples reach the estimator in the order in which they arrive.
class World {
 public:
  World(const WorldConfig& config, Path path)
      : config_{config}, path_{std::move(path)}, generator_{config.seed} {
    gyro_bias_ = config.gyro_bias_sigma * normal3();
    accel_bias_ = config.accel_bias_sigma * normal3();
    wind_W_ = config.wind_W.head<2>();
    mag_bias_ = config.mag_bias_sigma_T * normal3();
  }

  double time_s() const { return static_cast<double>(tick_) * kStep_s; }
  Motion motion(double t) const { return path_(t); }
  double normal() { return normal_(generator_); }
  Vector3 normal3() {
    const double x = normal(), y = normal();
    return {x, y, normal()};
  }

  /// Everything of the filter's state at time 0.
  NominalState initial_truth() const {
    const Motion m = path_(0.0);
    return {m.q_WB,       m.v_W,   m.p_W,      gyro_bias_, accel_bias_,
            baro_bias_m_, wind_W_, gnss_bias_, mag_bias_};
  }
  /// Everything of the filter's state as it was at a time not long ago.
  NominalState truth_at(double t_s) const {
    const Motion m = path_(t_s);
    const auto ago = static_cast<std::size_t>(std::lround((time_s() - t_s) / kStep_s));
    const Slow& slow = history_[history_.size() - 1 - std::min(ago, history_.size() - 1)];
    NominalState x;
    x.q_WB = m.q_WB;
    x.v_W = m.v_W;
    x.p_W = m.p_W;
    x.gyro_bias_B = slow.gyro_bias;
    x.accel_bias_B = slow.accel_bias;
    x.baro_bias_m = slow.baro_bias_m;
    x.wind_W = slow.wind_W;
    x.gnss_bias_W = slow.gnss_bias;
    x.mag_bias_B = mag_bias_;
    return x;
  }

  /// One IMU period: samples what is due and hands over what arrives.
  template <class Sink>
  void step(Sink& sink) {
    walk();
    const double t = time_s();
    const Motion m = path_(t);
    const auto due = [this](int every, int phase) { return tick_ % every == phase; };
    if (gnss_on && due(40, 8)) arrive(config_.gnss_delay_s, gnss(t, m));
    if (due(8, 2)) arrive(config_.baro_delay_s, baro(t, m));
    if (due(20, 1)) arrive(config_.mag_delay_s, mag(t, m));
    if (config_.range && due(20, 4)) arrive(0.002, range(t, m));
    if (config_.fixedwing && due(20, 3)) {
      arrive(0.002, pitot(t, m));
      arrive(0.002, sideslip(t, m));
    }
    sink.add(imu(t, m));
    std::stable_sort(on_the_way_.begin(), on_the_way_.end(),
                     [](const Delivery& a, const Delivery& b) { return a.at_s < b.at_s; });
    while (!on_the_way_.empty() && on_the_way_.front().at_s <= t + 1e-9) {
      std::visit([&sink](const auto& s) { sink.add(s); }, on_the_way_.front().sample);
      on_the_way_.pop_front();
    }
    ++tick_;
  }

  static Geodetic origin() { return {40.2463724, -111.6474138, 1387.0}; }
  /// Inverse of the filter's standard atmosphere, written out from the standard's own numbers.
  static double pressure_at(double altitude_m) {
    constexpr double kL = 0.0065, kT0 = 288.15, kG = 9.80665, kR = 287.05287;
    return 101325.0 * std::pow(1.0 - kL / kT0 * altitude_m, kG / (kR * kL));
  }

  bool gnss_on{true};
  Vector3 extra_gyro{Vector3::Zero()};
  Vector3 extra_gnss{Vector3::Zero()};
  Vector3 gnss_beside_m{Vector3::Zero()};  ///< From where the estimator takes the antenna to be.
  Vector3 extra_accel{Vector3::Zero()};
  double extra_baro_m{};
  double extra_airspeed_m_s{};  ///< A gust along the nose.
  bool pitot_blocked{};         ///< It reads no pressure.
  double pitot_share{1.0};      ///< The part of the airspeed that it reads.
  double extra_heading_rad{};
  double turned_mag_rad{};  ///< About body z.

 private:
  struct Slow {
    Vector3 gyro_bias, accel_bias;
    double baro_bias_m;
    Vector2 wind_W;
    Vector3 gnss_bias;
  };
  using Sample =
      std::variant<GnssSample, BaroSample, MagSample, RangeSample, PitotSample, SideslipSample>;
  struct Delivery {
    double at_s;
    Sample sample;
  };

  template <class S>
  void arrive(double delay_s, const S& sample) {
    on_the_way_.push_back({sample.t_s + delay_s, sample});
  }

  void walk() {
    const ProcessNoise& q = config_.filter.noise;
    const double root = std::sqrt(kStep_s);
    if (tick_ > 0) {
      gyro_bias_ += q.gyro_bias_rad_s_rts * root * normal3();
      accel_bias_ += q.accel_bias_m_s2_rts * root * normal3();
      baro_bias_m_ += q.baro_bias_m_rts * root * normal();
      const double kept = std::exp(-kStep_s / q.gnss_slow_time_s);
      const double new_share = std::sqrt(1.0 - kept * kept);
      const Vector3 slow_m(q.gnss_slow_horizontal_m, q.gnss_slow_horizontal_m,
                           q.gnss_slow_altitude_m);
      gnss_bias_ = kept * gnss_bias_ + new_share * slow_m.cwiseProduct(normal3());
    }
    history_.push_back({gyro_bias_, accel_bias_, baro_bias_m_, wind_W_, gnss_bias_});
    if (history_.size() > 400) history_.pop_front();
  }

  ImuSample imu(double t, const Motion& m) {
    constexpr double kTiny_s = 1e-4;
    const Quaternion ahead = path_(t + kTiny_s).q_WB;
    const Quaternion behind = path_(t - kTiny_s).q_WB;
    const Vector3 w_B = log_rotation(behind.conjugate() * ahead) / (2.0 * kTiny_s);
    Vector3 f_B = m.q_WB.conjugate() * (m.a_W - Vector3(0.0, 0.0, kGravity));
    const Vector3& r_B = config_.filter.imu_position_B;
    if (!r_B.isZero()) {
      const Vector3 later_B = log_rotation(m.q_WB.conjugate() * ahead) / kTiny_s;
      const Vector3 earlier_B = log_rotation(behind.conjugate() * m.q_WB) / kTiny_s;
      f_B += ((later_B - earlier_B) / kTiny_s).cross(r_B) + w_B.cross(w_B.cross(r_B));
    }
    const double rate = 1.0 / std::sqrt(kStep_s);
    const ProcessNoise& q = config_.filter.noise;
    return {t, w_B + gyro_bias_ + extra_gyro + q.gyro_rad_s_rtHz * rate * normal3(),
            f_B + accel_bias_ + extra_accel + q.accel_m_s2_rtHz * rate * normal3()};
  }

  GnssSample gnss(double t, const Motion& m) {
    const EstimatorConfig& f = config_.filter;
    const Vector3 p =
        m.p_W + m.q_WB * gnss_beside_m + gnss_bias_ + extra_gnss +
        Vector3(f.gnss_horizontal_sigma_m * normal(), f.gnss_horizontal_sigma_m * normal(),
                f.gnss_altitude_sigma_m * normal());
    GnssSample s;
    s.t_s = t;
    s.fix_3d = true;
    constexpr double kHalf_s = 1e-4;  // of a central difference
    const auto antenna_W = [this](double at_s) { return motion(at_s).q_WB * gnss_beside_m; };
    const Vector3 by_turning_W =
        (antenna_W(t + kHalf_s) - antenna_W(t - kHalf_s)) / (2.0 * kHalf_s);
    s.v_W_m_s = m.v_W + by_turning_W + f.gnss_velocity_sigma_m_s * normal3();
    s.position = place_of(p);
    return s;
  }

  /// Newton on ned_of: a place whose local coordinates are p.
  static Geodetic place_of(const Vector3& p_W) {
    Geodetic g = origin();
    for (int k = 0; k < 4; ++k) {
      const Vector3 e = p_W - ned_of(g, origin());
      g.latitude_deg += e.x() / 111.0e3;
      g.longitude_deg += e.y() / (111.3e3 * std::cos(g.latitude_deg * kRadPerDeg));
      g.altitude_m -= e.z();
    }
    return g;
  }

  BaroSample baro(double t, const Motion& m) {
    const double height =
        -m.p_W.z() + baro_bias_m_ + extra_baro_m + config_.filter.baro_sigma_m * normal();
    return {t, pressure_at(origin().altitude_m + height)};
  }
  MagSample mag(double t, const Motion& m) {
    // The filter's noise of the heading is two parts; the second is a turn about the vertical.
    const double turn = config_.filter.heading_sigma_rad * normal() + extra_heading_rad;
    const Vector3 field_W = exp_rotation({0.0, 0.0, turn}) * kField_W_T;
    const Quaternion turned = exp_rotation({0.0, 0.0, turned_mag_rad});
    return {t, turned * (m.q_WB.conjugate() * field_W) + mag_bias_ +
                   config_.filter.mag_sigma_T * normal3()};
  }
  RangeSample range(double t, const Motion& m) {
    const double cosine = (m.q_WB * Vector3::UnitZ()).z();
    const double r = -m.p_W.z() / cosine + config_.filter.range_sigma_m * normal();
    return {t, r, 0.2, 12.0};
  }
  Vector3 air_B(const Motion& m) const {
    return m.q_WB.conjugate() * (m.v_W - Vector3(wind_W_.x(), wind_W_.y(), 0.0));
  }
  PitotSample pitot(double t, const Motion& m) {
    const double u = pitot_blocked ? 0.0 : pitot_share * air_B(m).x() + extra_airspeed_m_s;
    const double p = pressure_at(origin().altitude_m - m.p_W.z());
    const double density = 1.225 * std::pow(p / 101325.0, 0.809737);
    return {t, 0.5 * density * u * u + config_.filter.pitot_sigma_Pa * normal()};
  }
  SideslipSample sideslip(double t, const Motion& m) {
    return {t, air_B(m).y() + config_.filter.sideslip_sigma_m_s * normal()};
  }

  WorldConfig config_;
  Path path_;
  std::mt19937_64 generator_;
  std::normal_distribution<double> normal_{0.0, 1.0};
  std::int64_t tick_{0};
  Vector3 gyro_bias_, accel_bias_, mag_bias_;
  Vector3 gnss_bias_{Vector3::Zero()};  ///< Counted from the start.
  double baro_bias_m_{};
  Vector2 wind_W_;
  std::deque<Slow> history_;
  std::deque<Delivery> on_the_way_;
};

inline double field_declination() {
  return std::atan2(kField_W_T.y(), kField_W_T.x());
}

}  // namespace rosflight::autonomy::estimation::test
