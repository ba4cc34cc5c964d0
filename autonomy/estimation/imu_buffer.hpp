// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "autonomy/estimation/error_state_ekf.hpp"
#include "autonomy/estimation/measurements.hpp"

namespace rosflight::autonomy::estimation {

/// Sums IMU samples into increments of some 10 ms and keeps those that the filter has not used yet.
///
/// Between samples k and k+1, T apart, with w and f the means of the two (trapezium):
///
///     dv    += C (f T + (w T) x (f T)/2),   C <- C exp(w T)         (1)
///     dtheta = log C                                                 (2)
///
/// so that turning during an increment (coning, sculling) is in it. P. G. Savage, "Strapdown
/// inertial navigation integration algorithm design", J. Guidance 21, 1998, parts 1 (19) and 2
/// (24), to first order in one sample. Fixed size, no heap.
class ImuBuffer {
 public:
  static constexpr std::size_t kCapacity = 128;
  /// Samples further apart than this leave a hole, which widens the covariance.
  static constexpr double kMaxStep_s = 0.05;
  /// Up to this the mean of the samples at both ends of a hole is taken for what was between.
  static constexpr double kMaxGuess_s = 0.2;
  /// Further apart is no hole but another clock.
  static constexpr double kMaxHole_s = 30.0;

  struct Segment {
    double start_s{};
    ImuIncrement u;
    bool hole{};     ///< Partly guessed: samples were missing.
    bool unknown{};  ///< Nothing but its length is known.
    double end_s() const { return start_s + u.dt_s; }
  };

  enum class Taken { kFirst, kSummed, kFull, kTooOld, kTooNew };

  /// @param increment_s  length to which samples are summed [s]; > 0.
  explicit ImuBuffer(double increment_s) : increment_s_{increment_s} {}

  /// kFull: the sample ended an increment. kTooOld, kTooNew: not before the last one, or more than
  /// kMaxHole_s after it; such a sample is dropped.
  Taken add(const ImuSample& sample, const Vector3& gyro_bias_B) {
    if (!started_) return restart(sample, Taken::kFirst);
    const double dt = sample.t_s - last_.t_s;
    if (dt <= 0.0) return Taken::kTooOld;
    if (dt > kMaxHole_s) return Taken::kTooNew;
    if (dt > kMaxGuess_s) {
      if (sum_.dt_s > 0.0) close();
      push({last_.t_s, {dt, Vector3::Zero(), Vector3::Zero()}, true, true});
      last_ = sample;
      return Taken::kFull;
    }
    const Vector3 dv = 0.5 * dt * (last_.accel_m_s2 + sample.accel_m_s2);
    const Vector3 turn = dt * (0.5 * (last_.gyro_rad_s + sample.gyro_rad_s) - gyro_bias_B);
    sum_.dv_B += C_ * (dv + 0.5 * turn.cross(dv));
    C_ = C_ * exp_rotation(turn);
    sum_.dt_s += dt;
    bias_turn_B_ += dt * gyro_bias_B;
    hole_ = hole_ || dt > kMaxStep_s;
    last_ = sample;
    if (sum_.dt_s < increment_s_ - 1e-6) return Taken::kSummed;
    close();
    return Taken::kFull;
  }

  std::size_t size() const { return count_; }
  bool full() const { return count_ == kCapacity; }
  /// The k-th increment that waits, from the oldest; k < size().
  const Segment& at(std::size_t k) const { return ring_[(head_ + k) % kCapacity]; }
  const Segment& front() const { return at(0); }
  /// Drops the oldest increment; only if size() > 0.
  void pop() {
    head_ = (head_ + 1) % kCapacity;
    --count_;
  }
  /// Cuts a part off the first segment and returns it.
  Segment take(double until_s) {
    Segment& whole = ring_[head_];
    Segment part = whole;
    const double share = std::clamp((until_s - whole.start_s) / whole.u.dt_s, 0.0, 1.0);
    part.u.dt_s *= share;
    part.u.dtheta_B *= share;
    part.u.dv_B *= share;
    // The rest starts in body axes that have turned.
    const Vector3 rest_dv = whole.u.dv_B - part.u.dv_B;
    whole.u.dv_B = exp_rotation(part.u.dtheta_B).conjugate() * rest_dv;
    whole.u.dtheta_B -= part.u.dtheta_B;
    whole.u.dt_s -= part.u.dt_s;
    whole.start_s = until_s;
    return part;
  }
  /// Drops all increments and the open sum; the last sample stays.
  void clear() {
    count_ = 0;
    sum_ = {};
    C_ = Quaternion::Identity();
    bias_turn_B_.setZero();
    hole_ = false;
  }
  /// Drops everything: the next sample is the first.
  void forget() {
    clear();
    started_ = false;
  }
  /// Adds to all times.
  void shift(double by_s) {
    last_.t_s += by_s;
    for (std::size_t k = 0; k < count_; ++k) ring_[(head_ + k) % kCapacity].start_s += by_s;
  }

  /// What was summed since the last whole increment.
  ImuIncrement open() const {
    ImuIncrement u = sum_;
    u.dtheta_B = log_rotation(C_) + bias_turn_B_;
    return u;
  }
  const ImuSample& last() const { return last_; }
  bool started() const { return started_; }

 private:
  Taken restart(const ImuSample& sample, Taken why) {
    clear();
    last_ = sample;
    started_ = true;
    return why;
  }
  void push(const Segment& segment) {
    if (full()) pop();
    ring_[(head_ + count_) % kCapacity] = segment;
    ++count_;
  }
  void close() {
    push({last_.t_s - sum_.dt_s, open(), hole_, false});
    sum_ = {};
    C_ = Quaternion::Identity();
    bias_turn_B_.setZero();
    hole_ = false;
  }

  double increment_s_;
  std::array<Segment, kCapacity> ring_{};
  std::size_t head_{0};
  std::size_t count_{0};
  ImuSample last_;
  bool started_{false};
  ImuIncrement sum_;
  Quaternion C_{Quaternion::Identity()};
  Vector3 bias_turn_B_{Vector3::Zero()};
  bool hole_{false};
};

}  // namespace rosflight::autonomy::estimation
