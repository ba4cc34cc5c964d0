// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <variant>

#include "autonomy/common/state_estimate.hpp"
#include "autonomy/estimation/alignment.hpp"
#include "autonomy/estimation/estimator_config.hpp"
#include "autonomy/estimation/health.hpp"
#include "autonomy/estimation/imu_buffer.hpp"
#include "autonomy/estimation/measurements.hpp"

namespace rosflight::autonomy::estimation {

/// Where a vehicle is, from its sensors: the filter of error_state_ekf.hpp with the times, the
/// order and the doubts that real samples need.
///
/// Samples may come in any order and late by up to `lag_s`: each waits in a queue and is fused at
/// the very time it was taken, when the filter, which runs lag_s behind the newest IMU sample, gets
/// there; what comes later still is counted and dropped. estimate() carries the filter's state to
/// the newest IMU sample; when GNSS comes back, the move of the position is shown at
/// jump_speed_m_s, so that guidance is not given a step. N has its origin where the vehicle stood
/// at the start, as the first fixes have it, unless the configuration names another place.
///
/// Starts on the ground (set_at_rest(true), still: level by the accelerometer, gyro bias as
/// averaged) or in the air (position and velocity by GNSS, attitude by the hint or by the
/// accelerometer, coarse). Multirotor: kWind false. Fixed wing: kWind true, with pitot and
/// sideslip.
///
/// Fixed size, no heap, no clock; a function of the sequence of calls.
template <bool kWind>
class Estimator {
 public:
  using Filter = ErrorStateEkf<kWind>;

  explicit Estimator(const EstimatorConfig& config) : config_{config}, imu_{config.increment_s} {}

  void add(const ImuSample& sample);
  void add(const GnssSample& sample);
  void add(const BaroSample& sample);
  void add(const MagSample& sample);
  void add(const RangeSample& sample);
  void add(const PitotSample& sample);
  void add(const SideslipSample& sample);

  /// The vehicle stands and its motors are off: a zero of velocity, and a start on the ground.
  void set_at_rest(bool at_rest) { at_rest_ = at_rest; }
  /// Attitude by someone else, for a start in the air; good for half a second.
  void set_attitude_hint(double t_s, const Quaternion& q_NB);
  /// Forgets all but the origin and starts anew.
  void restart();
  /// Begins from what is known at t_s, which is the time of the next IMU sample.
  void start_at(double t_s, const NominalState& state,
                const typename Filter::Covariance& covariance, const Geodetic& origin,
                double pressure_Pa);

  bool initialised() const { return health_.initialised; }
  /// At the newest IMU sample. Zero and without trust before the start.
  StateEstimate estimate() const;
  const EstimatorHealth& health() const { return health_; }
  const std::optional<Geodetic>& origin() const { return origin_; }
  const EstimatorConfig& config() const { return config_; }

  /// The filter and the time it has got to, for those who judge it.
  const Filter& filter() const { return filter_; }
  double filter_time_s() const { return filter_s_; }

 private:
  using Sample =
      std::variant<GnssSample, BaroSample, MagSample, RangeSample, PitotSample, SideslipSample>;
  struct Pending {
    double t_s{};
    Sample sample;
  };
  static constexpr std::size_t kQueue = 96;

  static double time_of(const Sample& sample);
  void queue(const Sample& sample);
  void advance(double target_s);
  void predict(const ImuBuffer::Segment& segment);
  void fuse(const Sample& sample);
  void fuse(const GnssSample& sample);
  void fuse_gnss(const GnssSample& sample, const Vector3& p_N);
  void fuse(const BaroSample& sample);
  void fuse(const MagSample& sample);
  void fuse(const RangeSample& sample);
  void fuse(const PitotSample& sample);
  void fuse(const SideslipSample& sample);
  void fuse_rest();
  template <int kRows>
  bool weigh(Aid aid, const typename Filter::template Residual<kRows>& residual, double gate_sigma);
  void doubt_the_imu();
  Vector2 unshown_jump_N(double t_s) const;
  void reset_to_gnss(const Vector3& p_N, const Vector3& v_N);
  void try_start();
  void start(bool on_ground);
  double declination(const GnssSample& fix) const;
  double pressure_height_m(double pressure_Pa) const;
  Vector3 gnss_lever() const { return config_.gnss_position_B - config_.imu_position_B; }
  Trust aided(double age_s, double good_s) const;

  EstimatorConfig config_;
  Filter filter_;
  double filter_s_{};
  Vector3 w_raw_B_{Vector3::Zero()};  ///< Gyro over the last stretch the filter has done.
  ImuBuffer imu_;
  std::array<Pending, kQueue> queue_{};
  std::size_t queued_{0};
  std::array<double, 3> next_s_{-1e9, -1e9, -1e9};  ///< Of mag, baro, pitot: thinning.
  double next_rest_s_{};
  Alignment window_;
  std::optional<Geodetic> origin_;
  std::optional<double> declination_rad_;
  double density_kg_m3_{1.225};
  double origin_pressure_height_m_{};
  double ground_up_m_{};
  bool at_rest_{false};
  struct {
    double t_s{-1e9};
    Quaternion q_NB{Quaternion::Identity()};
  } hint_;
  /// What a late correction moved the position by, and since when it is being shown.
  struct {
    Vector2 moved_N{Vector2::Zero()};
    double t_s{};
    double until_s{-1e9};  ///< Corrections up to here belong to it.
  } jump_;
  EstimatorHealth health_;
};

extern template class Estimator<false>;
extern template class Estimator<true>;

using MultirotorEstimator = Estimator<false>;
using FixedwingEstimator = Estimator<true>;

}  // namespace rosflight::autonomy::estimation
