// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <vector>

#include "sim/portable_math.hpp"
#include "sim/random.hpp"
#include "sim/types.hpp"

/// Errors of instruments, one law each, in the units of what they disturb. T is the sample period,
/// N an independent standard normal draw. Every law is written for the passage of time, not per
/// sample, so changing the rate of a sensor does not change how it drifts.
///
/// Names, units and slopes after IEEE Std 952-1997 (R2008), annex C; the discrete forms (1), (3)
/// and (4) are exact for samples T apart, not approximations for small T. Each uses a stream of its
/// own and draws nothing while it is off (sigma 0), so no error changes the numbers of another.
namespace rosflight::sim {

/// White noise:
///
///     e_k = sigma N_k,   sigma = density / sqrt(T)                                        (1)
///
/// Allan deviation density / sqrt(tau): slope -1/2, equal to the density at tau = 1 s. A density is
/// in units/sqrt(Hz) over a bandwidth of 1/T, the reading under which a data sheet's rate noise
/// density is also its angle random walk in units/sqrt(s).
class WhiteNoise {
 public:
  /// Noise with a standard deviation per sample.
  static WhiteNoise per_sample(double sigma, RandomStream stream) { return {sigma, stream}; }
  /// Noise with a density [unit/sqrt(Hz)] at the sample period.
  static WhiteNoise from_density(double density, Time period, RandomStream stream) {
    return {density / std::sqrt(to_seconds(period)), stream};
  }

  /// The next error.
  double sample() { return sigma_ == 0.0 ? 0.0 : sigma_ * stream_.normal(); }
  /// The same draw with another sigma (vibration grows with rotor speed).
  double sample(double sigma) { return sigma == 0.0 ? 0.0 : sigma * stream_.normal(); }
  double sigma() const { return sigma_; }

 private:
  WhiteNoise(double sigma, RandomStream stream) : sigma_{sigma}, stream_{stream} {}

  double sigma_;
  RandomStream stream_;
};

/// Random walk of a bias:
///
///     b_0 = 0,   b_k+1 = b_k + rate sqrt(T) N_k                                           (2)
///
/// `rate` in units/sqrt(s): the standard deviation after t seconds is rate sqrt(t) whatever T is.
/// Allan deviation rate sqrt(tau / 3): slope +1/2, equal to the rate at tau = 3 s.
class RandomWalk {
 public:
  /// @param rate  [unit/sqrt(s)].
  RandomWalk(double rate, Time period, RandomStream stream)
      : step_{rate * std::sqrt(to_seconds(period))}, stream_{stream} {}

  /// The bias at the next sample.
  double sample() {
    if (step_ != 0.0) value_ += step_ * stream_.normal();
    return value_;
  }

 private:
  double step_;
  double value_{0.0};
  RandomStream stream_;
};

/// First-order Gauss-Markov process, an error that wanders but stays bounded:
///
///     x_0 = sigma N,   x_k+1 = phi x_k + sigma sqrt(1 - phi^2) N_k,   phi = exp(-T / tau)  (3)
///
/// Stationary from the first sample: standard deviation sigma, autocorrelation exp(-|t| / tau).
class GaussMarkov {
 public:
  /// @param tau_s  correlation time, > 0 unless sigma is 0.
  GaussMarkov(double sigma, double tau_s, Time period, RandomStream stream)
      : phi_{sigma == 0.0 ? 0.0 : portable::exp(-to_seconds(period) / tau_s)},
        drive_{sigma * std::sqrt(1.0 - phi_ * phi_)},
        stream_{stream} {
    if (sigma != 0.0) value_ = sigma * stream_.normal();
  }

  /// The value now; the process then moves on by one period.
  double sample() {
    if (drive_ == 0.0) return value_;
    const double now = value_;
    value_ = phi_ * value_ + drive_ * stream_.normal();
    return now;
  }

 private:
  double phi_;
  double drive_;
  double value_{0.0};
  RandomStream stream_;
};

/// (4): turn-on bias, constant for one run, uniform in +-range, different for every seed.
inline double turn_on_bias(double range, RandomStream stream) {
  return range == 0.0 ? 0.0 : stream.uniform(-range, range);
}

/// (5): a converter limits a value to +-limit, then rounds it to a multiple of `step`, halves to even.
/// Zero switches either off.
class Quantiser {
 public:
  /// @param step, limit  in the unit of the value; 0 switches each off.
  Quantiser(double step, double limit) : step_{step}, limit_{limit} {}

  /// (5) of one value.
  double apply(double value) const {
    if (limit_ > 0.0) value = std::clamp(value, -limit_, limit_);
    if (step_ <= 0.0) return value;
    // Adding 1.5 * 2^52 leaves no bits below one; exact for up to 2^51 steps, and far quicker than
    // rint.
    constexpr double kNoFraction = 6755399441055744.0;
    return ((value / step_ + kNoFraction) - kNoFraction) * step_;
  }

 private:
  double step_;
  double limit_;
};

/// Parameters of the errors of one scalar; all zero: a perfect instrument. `unit` is that of the
/// scalar.
struct ErrorParameters {
  double fixed_bias{};     ///< The same in every run [unit].
  double turn_on_bias{};   ///< Half width of (4) [unit].
  double noise_density{};  ///< (1) [unit/sqrt(Hz)]; adds to noise_sigma in power.
  double noise_sigma{};    ///< White noise per sample, independent of the rate [unit].
  double bias_walk{};      ///< (2) [unit/sqrt(s)].
  double drift_sigma{};    ///< (3) [unit].
  double drift_time_s{};   ///< (3) > 0 where drift_sigma > 0.
  double resolution{};     ///< (5) [unit].
  double limit{};          ///< (5) [unit].
};

/// The errors of one scalar together:
///
///     y = quantise( x + fixed + turn_on + walk + drift + white )                                   (6)
class ErrorModel {
 public:
  /// @param name  prefix of the streams' names, such as "sensors/imu/gyro/x".
  ErrorModel(const ErrorParameters& parameters, Time period, const RandomSource& source,
             std::string_view name);

  /// Disturbs one true value; call once per sample. `extra_sigma` is white noise that depends on
  /// the moment, such as vibration; it adds in power.
  double apply(double truth, double extra_sigma = 0.0) {
    double sigma = white_.sigma();
    if (extra_sigma != 0.0) sigma = std::sqrt(sigma * sigma + extra_sigma * extra_sigma);
    bias_ = constant_ + walk_.sample() + drift_.sample();
    return quantiser_.apply(truth + bias_ + white_.sample(sigma));
  }
  /// Like apply, without the white noise.
  double apply_quietly(double truth) {
    bias_ = constant_ + walk_.sample() + drift_.sample();
    return quantiser_.apply(truth + bias_);
  }
  /// The last error without white noise and rounding.
  double bias() const { return bias_; }

 private:
  double constant_;
  double bias_{};
  WhiteNoise white_;
  RandomWalk walk_;
  GaussMarkov drift_;
  Quantiser quantiser_;
};

/// Delays values by a fixed time: a value stored at t is returned at t + delay, in order. Memory for
/// all values in the line is allocated at construction.
template <class Value>
class DelayLine {
 public:
  /// @param period  mean time between two values; each may be late by up to a period.
  DelayLine(Time delay, Time period)
      : delay_{delay}, ring_(static_cast<std::size_t>(delay / period) + 3) {}

  /// Stores a value; if there is no room the oldest one is lost.
  void push(Time now, const Value& value) {
    if (count_ == ring_.size()) drop_oldest();
    const std::size_t end = head_ + count_;
    ring_[end < ring_.size() ? end : end - ring_.size()] = {now + delay_, value};
    ++count_;
  }
  /// @returns true and the oldest value if one is due; at most one a call.
  bool pop(Time now, Value& value) {
    if (count_ == 0 || ring_[head_].due > now) return false;
    value = ring_[head_].value;
    drop_oldest();
    return true;
  }

 private:
  struct Entry {
    Time due{};
    Value value{};
  };
  void drop_oldest() {
    if (++head_ == ring_.size()) head_ = 0;
    --count_;
  }

  Time delay_;
  std::size_t head_{0};
  std::size_t count_{0};
  std::vector<Entry> ring_;
};

}  // namespace rosflight::sim
