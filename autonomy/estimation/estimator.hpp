// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>

#include "autonomy/common/state_estimate.hpp"
#include "autonomy/estimation/aid_fusion.hpp"
#include "autonomy/estimation/alignment.hpp"

namespace rosflight::autonomy::estimation {

/// Estimates the state of a vehicle from its sensors: time alignment and initialisation around the
/// fusion of aid_fusion.hpp, whose filter is that of error_state_ekf.hpp.
///
/// Samples may come in any order and late by up to `lag_s`: each waits in a queue and is fused at
/// the very time it was taken, when the filter, which runs lag_s behind the newest IMU sample, gets
/// there; what comes later still is counted and dropped. Fixes of GNSS and poses that keep coming later, by up
/// to `max_lag_s`, raise the lag. estimate() carries the filter's state to
/// the newest IMU sample; when GNSS comes back, the move of the position is shown at
/// jump_speed_m_s, so that guidance receives no step. The origin of W is the position of the start
/// by the first fixes, unless the configuration gives another one. p_W is the position from there;
/// the slow error of the satellites is a state of its own, so p_W does not wander with it.
///
/// Once started it goes on. Holes in the IMU stream of up to 30 s (a link that was cut) are carried
/// over in a straight line with a covariance that grows; after more than 0.5 s the next attitude
/// hint sets the attitude. If the clock of the samples jumps (the far end restarted), all times are
/// shifted by as much, and the break counts as a hole of 0.1 s; or of 30 s if the time is later.
///
/// Without GNSS a pose from outside gives the start: its position, and its heading to the magnetic field.
///
/// Starts on the ground (set_at_rest(true), still: level by the accelerometer, gyro bias as
/// averaged) or in the air (position and velocity by GNSS, attitude by the hint or by the
/// accelerometer, coarse).
///
/// Fixed size, no heap, no clock; a function of the sequence of calls.
class Estimator {
 public:
  using Filter = ErrorStateEkf;

  /// Takes a copy of the configuration. Starts by itself once it has samples enough.
  Estimator(const EstimatorConfig& config, Airframe airframe)
      : fusion_{config, airframe}, imu_{config.increment_s} {}

  /// Takes one sample. IMU samples drive the estimator: the others wait in the queue until the
  /// filter reaches their time. Rejected, and counted in health(): values that are not finite or
  /// that no sensor on earth measures (`unusable`), samples older than the filter, more than 1 s
  /// ahead of the IMU or beyond 96 waiting ones (`late`). IMU samples with times not after the last
  /// or more than 30 s ahead are rejected; five of them in a row, in order, are another clock.
  void add(const ImuSample& sample);
  void add(const GnssSample& sample);
  void add(const BaroSample& sample);
  void add(const MagSample& sample);
  void add(const RangeSample& sample);
  void add(const PitotSample& sample);
  void add(const SideslipSample& sample);
  void add(const PoseSample& sample);

  /// The vehicle stands and its motors are off: zero velocity is fused, and a start is on the
  /// ground.
  void set_at_rest(bool at_rest) { at_rest_ = at_rest; }
  /// Attitude from another source, for a start in the air and after a hole; used for half a second
  /// after t_s [s].
  /// @param with_heading  false: only its roll and pitch count, as that source has started again.
  void set_attitude_hint(double t_s, const Quaternion& q_WB, bool with_heading = true);
  /// A hint would be used now.
  bool wants_attitude_hint() const { return !initialised() || attitude_lost_s_.has_value(); }
  /// Discards everything but the origin and initialises again.
  void restart();
  /// Starts from a given state at t_s [s], which is the time of the next IMU sample.
  void start_at(double t_s, const NominalState& state, const Filter::Covariance& covariance,
                const Geodetic& origin, double pressure_Pa);

  bool initialised() const { return health().initialised; }
  /// At the newest IMU sample. Before the start: zero, of quality kNone.
  StateEstimate estimate() const;
  const EstimatorHealth& health() const { return fusion_.health(); }
  const std::optional<Geodetic>& origin() const { return fusion_.reference().origin; }
  const EstimatorConfig& config() const { return fusion_.config(); }

  /// The filter and the time of its state [s], for tests and benchmarks.
  const Filter& filter() const { return fusion_.filter(); }
  double filter_time_s() const { return fusion_.time_s(); }

 private:
  bool fixed_wing() const { return fusion_.fixed_wing(); }

  struct Pending {
    double t_s{};
    AidSample sample;
  };
  static constexpr std::size_t kQueue = 96;

  void queue(const AidSample& sample);
  void allow_for_delay(double t_s);
  void take_other_clock(const ImuSample& sample);
  void reject_unusable() { ++fusion_.health().unusable; }
  void advance(double target_s);
  void take_direction_of_pose();
  void try_start();
  void start(bool on_ground);
  NominalState initial_state(bool on_ground, bool hinted);
  Filter::Covariance initial_covariance(bool on_ground, bool hinted, bool new_origin) const;
  double declination(const GnssSample& fix) const;
  Quality aided(double age_s, double good_s) const;

  AidFusion fusion_;
  ImuBuffer imu_;
  std::array<Pending, kQueue> queue_{};
  std::size_t queued_{0};
  double lag_s_{config().lag_s};
  int delayed_{0};                                  ///< Fixes or poses in a row that came too late.
  std::array<double, 3> next_s_{-1e9, -1e9, -1e9};  ///< Due times of mag, baro and pitot.
  double next_rest_s_{};
  Alignment window_;
  bool at_rest_{false};
  std::optional<double> attitude_lost_s_;  ///< End of a long hole.
  /// IMU samples in a row that do not fit the clock.
  struct {
    int count{};
    double t_s{};
  } misfits_;
  struct {
    double t_s{-1e9};
    Quaternion q_WB{Quaternion::Identity()};
  } hint_;
};

}  // namespace rosflight::autonomy::estimation
