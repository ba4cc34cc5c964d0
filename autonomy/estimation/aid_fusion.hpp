// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "autonomy/common/angles.hpp"
#include "autonomy/estimation/error_state_ekf.hpp"
#include "autonomy/estimation/estimator_config.hpp"
#include "autonomy/estimation/health.hpp"
#include "autonomy/estimation/imu_buffer.hpp"
#include "autonomy/estimation/measurements.hpp"
#include "autonomy/estimation/step_watch.hpp"
#include "base/atmosphere.hpp"

namespace rosflight::autonomy::estimation {

/// Mean square of normalised innovations of one aid, exponential over 1/share samples.
class InnovationMonitor {
 public:
  /// @param share  weight of a sample, 0..1. @param limit  of the mean; 1 is expected.
  /// @param cap  a single innovation counts for no more than this.
  InnovationMonitor(double share, double limit, double cap)
      : share_{share}, limit_{limit}, cap_{cap} {}
  /// @returns whether the mean exceeds its limit; it then starts again.
  bool exceeded(double nis) {
    mean_ += share_ * (std::min(nis, cap_) - mean_);
    if (mean_ <= limit_) return false;
    mean_ = 1.0;
    return true;
  }
  void reset() { mean_ = 1.0; }

 private:
  double share_, limit_, cap_;
  double mean_{1.0};
};

/// Mean of normalised innovations with their sign, exponential over 1/share samples: a bias shows in
/// it long before it shows in their squares.
class InnovationMean {
 public:
  /// @param share  weight of a sample, 0..1. @param sigmas  limit of the mean in its own standard
  /// deviations, sqrt(share/(2 - share)) where the innovations are white.
  InnovationMean(double share, double sigmas)
      : share_{share}, limit_{sigmas * std::sqrt(share / (2.0 - share))} {}
  /// @param innovation  by its standard deviation. @returns whether the mean exceeds its limit; it
  /// then starts again.
  bool exceeded(double innovation) {
    constexpr double kCap = 3.0;
    mean_ += share_ * (std::clamp(innovation, -kCap, kCap) - mean_);
    if (std::abs(mean_) <= limit_) return false;
    mean_ = 0.0;
    return true;
  }
  void reset() { mean_ = 0.0; }

 private:
  double share_, limit_;
  double mean_{};
};

/// What positions and headings refer to; unknown until the first fix.
struct Reference {
  std::optional<Geodetic> origin;         ///< Position of the origin of W.
  std::optional<double> declination_rad;  ///< Magnetic north, east of true north.
};

/// The place a little way off another one [m].
inline Geodetic moved(const Geodetic& from, const Vector3& by_W) {
  constexpr double kMetresPerDegree = 111.2e3;
  const double east_per_degree = kMetresPerDegree * std::cos(from.latitude_deg * kRadPerDeg);
  return {from.latitude_deg + by_W.x() / kMetresPerDegree,
          from.longitude_deg + by_W.y() / east_per_degree, from.altitude_m - by_W.z()};
}

/// Standard deviation below which ground speed and wind give the airspeed: a sixth of the
/// 11.5 m/s that an anaconda flies at least.
inline constexpr double kAirspeedKnown_m_s = 2.0;

/// Fuses each aid with the filter: noise, lever, innovation gate, and recovery after a timeout of
/// rejections.
///
/// | aid | rejected for | recovery |
/// |---|---|---|
/// | GNSS velocity | gnss_rejected_s | biases of the IMU and what they have led to are widened |
/// | GNSS position, velocity | gnss_reset_s | horizontal position and velocity are reset to GNSS |
/// | GNSS position alone | gnss_jump_s | its slow error is set so that the residual is zero; back where disagreement_W() has it from: the position moves there |
/// | barometer | baro_relearn_s | its bias is set so that the residual is zero |
/// | barometer without GNSS, no jump | at once | the accelerometer's bias and its effect are widened |
/// | pose | pose_reset_s | the position is set to the pose |
/// | pitot | pitot_relearn_s | the wind is widened by the residual, unless the tube is blocked, which it stays until it agrees |
/// | range | range_relearn_s | the altitude of the ground is set so that the residual is zero |
///
/// Before a gate closes, the innovations show a fault: where their mean square over some samples
/// or their mean in their sign exceeds what the covariance allows, a bias of the IMU has jumped and
/// its variance is widened. Velocity of GNSS, specific force of the air (without GNSS) and heading
/// are watched. A heading that moves as no gyro does is the magnetometer's fault.
///
/// Everything is fused at time_s(), which predict() moves on; the Estimator around it
/// (estimator.hpp) brings the samples into order of time. Fixed size, no heap, no clock.
class AidFusion {
 public:
  using Filter = ErrorStateEkf;
  using Covariance = Filter::Covariance;

  /// Takes a copy of the configuration.
  AidFusion(const EstimatorConfig& config, Airframe airframe)
      : config_{config},
        airframe_{airframe},
        step_watch_{StepWatch::Sizes{}, airframe == Airframe::kFixedWing} {}

  /// Discards the state, and the record but for the count of restarts. Origin, declination stay.
  void reset();
  /// Starts from a state at t_s [s].
  /// @param pressure_Pa  static pressure at that position; must be > 0.
  void start(double t_s, const NominalState& state, const Covariance& covariance,
             double pressure_Pa);
  /// The position of the start is that of fixes at rest: a receiver that moves away from it now has
  /// jumped, as after a flight with it.
  void trust_fixes_at_rest();
  /// Moves the time without prediction: the first IMU sample after start().
  void set_time(double t_s) { t_s_ = t_s; }

  /// Predicts to the end of an IMU segment, which begins at time_s(). A hole in it widens the
  /// covariance by what a vehicle may have done meanwhile (0.5 rad and 5 m/s after a second, growing
  /// with the root of time); through one of which nothing is known it flies straight on. Fuses the
  /// specific force of the air if the vehicle is off the ground.
  void predict(const ImuBuffer::Segment& segment);
  /// Corrects by a measurement taken at time_s().
  /// @param newest_s  time of the newest IMU sample, at which the output is shown [s].
  void fuse(const AidSample& sample, double newest_s);
  /// Corrects by a velocity of zero: the vehicle stands.
  void fuse_rest();

  /// Turns the attitude by an error in body axes: after a long hole, from another source.
  void correct_attitude(const Vector3& error_B, double tilt_sigma_rad, double heading_sigma_rad);
  /// Heading from the magnetic field at a start; its variance must still be large.
  void start_heading(const Vector3& field_B);
  /// Restores the last good state if this one is not finite. Call it now and then.
  void guard();
  /// Adds to all times: the clock of the samples has jumped.
  void shift(double by_s);

  /// The part of a late correction of the position that the output does not show yet at t_s [m].
  Vector2 unshown_jump_W(double t_s) const;
  /// How far GNSS, back from a pause, was from the prediction though its velocity was not: either may be wrong.
  /// The position has followed GNSS, and its reported sigma has as much in it until the receiver jumps back.
  const Vector2& disagreement_W() const { return disagreement_W_; }

  /// Time of the newest fix or pose that was used [s].
  double aided_s() const;
  double time_s() const { return t_s_; }  ///< Time of the filter's state.
  const Filter& filter() const { return filter_; }
  const EstimatorConfig& config() const { return config_; }
  bool fixed_wing() const { return airframe_ == Airframe::kFixedWing; }
  Reference& reference() { return reference_; }
  const Reference& reference() const { return reference_; }
  /// The record of all aids; the Estimator adds its own counts.
  EstimatorHealth& health() { return health_; }
  const EstimatorHealth& health() const { return health_; }

 private:
  void fuse(const GnssSample& sample);
  void fuse_gnss(const GnssSample& sample, const Vector3& p_W, bool was_away);
  void fuse(const BaroSample& sample);
  void fuse(const MagSample& sample);
  void fuse(const RangeSample& sample);
  void fuse(const PitotSample& sample);
  void fuse(const SideslipSample& sample);
  void fuse(const PoseSample& sample);
  bool fuse_position(const Vector3& p_W);
  void fuse_heading(const Quaternion& q_WB);
  Vector2 shown_W() const;
  void show_gradually(const Vector2& before_W, bool returned);
  template <int kRows>
  bool weigh(Aid aid, const Filter::Residual<kRows>& residual, double gate_sigma) {
    const Filter::Verdict verdict = filter_.correct(residual, gate_sigma);
    if constexpr (kRows == 1) step_watch_.observe(residual, verdict);
    return note(aid, verdict, kRows);
  }
  bool note(Aid aid, const Filter::Verdict& verdict, int rows);
  void fuse_air_force(const ImuBuffer::Segment& segment);
  void consider_air_scale(Filter::Residual<1>& residual) const;
  void learn_gusts(double nis);
  void widen_wind(double gust_m_s);
  void fuse_hovering(const PitotSample& sample, double forward_m_s);
  bool pitot_is_blocked(double measured_m_s, double forward_m_s);
  double max_wind_noise_m_s_rts() const {
    return std::max(config_.noise.wind_m_s_rts, config_.max_wind_noise_m_s_rts);
  }
  Vector3 force_at_origin() const;
  bool off_the_ground() const;
  bool dead_reckoning() const;
  bool silent(Aid aid) const;
  bool watches_steps() const;
  void watch_steps(const ImuIncrement& u, const ProcessNoise& noise);
  double wind_walk_m_s_rts() const;
  double gust_down_m_s() const;
  double gust_down_time_s() const;
  double height_above_ground_m() const;
  void fuse_lift(double force_m_s2);
  void fuse_lift_for_airspeed(double force_m_s2);
  bool waits_for_gnss() const;
  double vertical_field_T(const Vector3& field_B) const;
  void learn_vertical_field(const Vector3& field_B);
  bool field_fits(const Vector3& field_B) const;
  double heading_gate(const Filter::Residual<1>& residual, bool fits);
  bool heading_drifts(const Filter::Residual<1>& residual, bool fits);
  /// A fault of gyro or accelerometer that began some time ago: what is assumed of it.
  struct ImuFault {
    double gyro_rad_s{}, accel_m_s2{};  ///< Standard deviation of its size, each axis.
    double age_s{};
  };
  /// Found by the size of innovations, by their mean, and by the force of the air alone.
  static constexpr ImuFault kLargeFault{0.15, 0.3, 0.3};
  static constexpr ImuFault kSmallFault{0.05, 0.3, 1.0};
  static constexpr ImuFault kDeadReckonedFault{0.05, 0.3, 1.5};
  void widen_imu_errors(const ImuFault& fault);
  Vector3 suspect_velocity(const Vector3& residual) const;
  bool velocity_is_off(const Vector3& suspect);
  void widen_heading();
  bool height_drifts(const Filter::Residual<1>& residual);
  void widen_vertical();
  void reset_to_gnss(const Vector3& p_W, const Vector3& v_W);
  void restart_gnss_bias(int first, int size, const Vector3& p_W);
  double gnss_velocity_variance(double sigmas) const;
  Vector3 gnss_lever() const { return config_.gnss_position_B - config_.imu_position_B; }

  EstimatorConfig config_;
  Airframe airframe_;
  Filter filter_;
  double t_s_{};
  double newest_s_{};
  Vector3 w_raw_B_{Vector3::Zero()};  ///< Gyro over the last segment.
  Vector3 f_raw_B_{Vector3::Zero()};  ///< Accelerometer over the last segment.
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
  Vector2 disagreement_W_{Vector2::Zero()};
  /// Sum of the specific force that is not fused yet, and the gyro at its start.
  struct {
    Vector3 dv_B{Vector3::Zero()};
    double dt_s{};
    Vector3 w_start_B{Vector3::Zero()};
  } force_;
  /// The magnetometer, and whether it or the gyro is wrong where they disagree.
  struct {
    double residual_rad{};  ///< Residual of the last heading that was used.
    double t_s{-1e9};
    bool jumped{};                 ///< The heading moved as no gyro does: it is the magnetometer.
    double fitting_s{};            ///< For so long all samples have fitted, while none is used.
    double seen_s{-1e9};           ///< Time of the last sample.
    std::optional<double> down_T;  ///< Vertical part of the field, of the samples that were used.
    int widened{};                 ///< Times in a row without a pause, and the last time.
    double widened_s{-1e9};
  } heading_;
  /// The barometer, and whether it or the accelerometer is wrong where they disagree.
  struct {
    double residual_m{};  ///< Residual of the last altitude that was used.
    double t_s{-1e9};
    bool jumped{};  ///< The altitude moved as no accelerometer does: it is the barometer.
    double widened_s{-1e9};
  } height_;
  InnovationMonitor velocity_monitor_{0.3, 3.0, 6.0};
  InnovationMonitor heading_monitor_{0.25, 4.5, 9.0};
  std::array<InnovationMean, 3> velocity_means_{InnovationMean{0.1, 5.0}, InnovationMean{0.1, 5.0},
                                                InnovationMean{0.1, 5.0}};
  std::array<InnovationMean, 2> air_means_{InnovationMean{0.1, 4.0}, InnovationMean{0.1, 4.0}};
  StepWatch step_watch_;  ///< A fixed wing's, while it has no GNSS.
  int lift_rejected_{};   ///< Samples in a row.
  bool pitot_blocked_{};  ///< It read too little to be a gust, and has not agreed since.
  double wind_noise_m_s_rts_{max_wind_noise_m_s_rts()};  ///< Gusts are assumed, calm is learned.
  double gusts_learned_at_m_{};                          ///< Height above ground.
  double widened_s_{-1e9};
  double long_hole_end_s_{-1e9};
  double settled_since_s_{1e9};  ///< GNSS position accepted without a gap.
  double started_on_fixes_s_{-1e9};
  struct {
    double t_s{-1e9};
    NominalState state;
    Filter::LowerTriangle covariance;
  } good_;
  EstimatorHealth health_;
};

}  // namespace rosflight::autonomy::estimation
