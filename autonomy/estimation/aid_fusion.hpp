// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "autonomy/estimation/error_state_ekf.hpp"
#include "autonomy/estimation/estimator_config.hpp"
#include "autonomy/estimation/health.hpp"
#include "autonomy/estimation/imu_buffer.hpp"
#include "autonomy/estimation/measurements.hpp"
#include "base/atmosphere.hpp"

namespace rosflight::autonomy::estimation {

/// What positions and headings refer to; unknown until the first fix.
struct Reference {
  std::optional<Geodetic> origin;         ///< Of W.
  std::optional<double> declination_rad;  ///< Magnetic north, east of true north.
};

/// Fuses each aid with the filter: noise, lever, innovation gate, and recovery after a timeout of
/// rejections.
///
/// | aid | rejected for | recovery |
/// |---|---|---|
/// | GNSS velocity | gnss_doubt_s | the variances of tilt, velocity and IMU biases are widened |
/// | GNSS position, velocity | gnss_reset_s | horizontal position and velocity are reset to GNSS |
/// | barometer | baro_relearn_s | its bias is set so that the residual is zero |
/// | range | range_relearn_s | the altitude of the ground is set so that the residual is zero |
///
/// Everything is fused at time_s(), which predict() moves on; the Estimator around it
/// (estimator.hpp) brings the samples into order of time. Fixed size, no heap, no clock.
template <bool kWind>
class AidFusion {
 public:
  using Filter = ErrorStateEkf<kWind>;
  using Covariance = typename Filter::Covariance;

  /// Takes a copy of the configuration.
  explicit AidFusion(const EstimatorConfig& config) : config_{config} {}

  /// Discards the state, and the record but for the count of restarts. ROSflight 2.x stays.
  void reset();
  /// Starts from a state at t_s [s].
  /// @param pressure_Pa  static pressure at that position; must be > 0.
  void start(double t_s, const NominalState& state, const Covariance& covariance,
             double pressure_Pa);
  /// Moves the time without prediction: the first IMU sample after start().
  void set_time(double t_s) { t_s_ = t_s; }

  /// Predicts to the end of an IMU segment, which begins at time_s(). A hole in it widens the
  /// covariance by what a vehicle may have done meanwhile (0.5 rad/s, 5 m/s^2).
  void predict(const ImuBuffer::Segment& segment);
  /// Corrects by a measurement taken at time_s().
  /// @param newest_s  time of the newest IMU sample, at which the output is shown [s].
  void fuse(const AidSample& sample, double newest_s);
  /// Corrects by a velocity of zero: the vehicle stands.
  void fuse_rest();

  /// The part of a late correction of the position that the output does not show yet at t_s [m].
  Vector2 unshown_jump_W(double t_s) const;

  double time_s() const { return t_s_; }  ///< Of the filter's state.
  const Filter& filter() const { return filter_; }
  const EstimatorConfig& config() const { return config_; }
  Reference& reference() { return reference_; }
  const Reference& reference() const { return reference_; }
  /// The record of all aids; the Estimator adds its own counts.
  EstimatorHealth& health() { return health_; }
  const EstimatorHealth& health() const { return health_; }

 private:
  void fuse(const GnssSample& sample);
  void fuse_gnss(const GnssSample& sample, const Vector3& p_W);
  void fuse(const BaroSample& sample);
  void fuse(const MagSample& sample);
  void fuse(const RangeSample& sample);
  void fuse(const PitotSample& sample);
  void fuse(const SideslipSample& sample);
  template <int kRows>
  bool weigh(Aid aid, const typename Filter::template Residual<kRows>& residual, double gate_sigma);
  void widen_imu_errors();
  void reset_to_gnss(const Vector3& p_W, const Vector3& v_W);
  Vector3 gnss_lever() const { return config_.gnss_position_B - config_.imu_position_B; }

  EstimatorConfig config_;
  Filter filter_;
  double t_s_{};
  double newest_s_{};
  Vector3 w_raw_B_{Vector3::Zero()};  ///< Gyro over the last segment.
  Reference reference_;
  double density_kg_m3_{base::kSeaLevelDensity_kg_m3};
  double origin_pressure_height_m_{};
  double ground_up_m_{};
  /// What a late correction moved the position by, and since when it is being shown.
  struct {
    Vector2 moved_W{Vector2::Zero()};
    double t_s{};
    double until_s{-1e9};  ///< Corrections up to here belong to it.
  } jump_;
  EstimatorHealth health_;
};

extern template class AidFusion<false>;
extern template class AidFusion<true>;

}  // namespace rosflight::autonomy::estimation
