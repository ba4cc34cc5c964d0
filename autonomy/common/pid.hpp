// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>

#include "autonomy/common/types.hpp"

namespace rosflight::autonomy {

struct PidGains {
  double kp{};
  double ki{};
  double kd{};

  bool operator==(const PidGains&) const = default;
};

/// One control loop with derivative on the measurement and an integral that cannot wind up.
///
///     e = desired - current,   u = kp e + I - kd x_dot                                    (1)
///     I <- I + ki dt/2 (e + e_prev)                                 trapezoid             (2)
///     x_dot <- (2 tau - dt)/(2 tau + dt) x_dot + 2/(2 tau + dt) (x - x_prev)              (3)
///
/// (3) is the bilinear form of s/(tau s + 1), used when no rate is given; Beard & McLain, Small
/// Unmanned Aircraft, 2012, sec. 6.4. The output is clipped to the limits; then (2) may still move
/// I back and up to the limit, not beyond it (conditional integration, Astrom & Hagglund, Advanced
/// PID Control, sec. 3.5): a saturated loop holds its integral. I is stored as an output, so a
/// change of ki does not jump. Gains of either sign act; zero switches a term off.
///
/// dt <= 0 or a number that is not finite: the last output is repeated and nothing changes. A gap
/// of more than kMaxGap_s restarts derivative and trapezoid, I is kept.
class Pid {
 public:
  static constexpr double kMaxGap_s = 1.0;
  enum class Integrate : bool { kNo, kYes };
  struct Limits {
    double lower{-kInfinity};
    double upper{kInfinity};
  };

  Pid() = default;
  /// Without limits; derivative filter of 0.05 s.
  explicit Pid(const PidGains& gains) : gains_(gains) {}
  /// @param limits            of the output, in its unit; lower <= upper.
  /// @param derivative_tau_s  time constant of the derivative in (3).
  Pid(const PidGains& gains, const Limits& limits, double derivative_tau_s)
      : gains_(gains), limits_(limits), tau_s_(derivative_tau_s) {}

  /// Derivative by (3).
  double step(double desired, double current, double dt_s, Integrate integrate = Integrate::kYes);
  /// Derivative given: the rate of `current`, or of -e where the desired value moves too.
  double step_with_rate(double desired, double current, double rate, double dt_s,
                        Integrate integrate = Integrate::kYes);

  /// ki = 0 also drops the integral: nothing could ever take it back.
  void set_gains(const PidGains& gains);
  /// Limits of the output from the next step on; the integral stays until a step moves it.
  void set_limits(const Limits& limits) { limits_ = limits; }
  /// Time constant of the derivative in (3) [s].
  void set_derivative_tau(double tau_s) { tau_s_ = tau_s; }
  const PidGains& gains() const { return gains_; }

  /// Share of the integral in the output, in the unit of the output.
  double integral() const { return integral_; }
  /// Takes over a trim from another loop; no effect without an integral gain.
  void set_integral(double value) { integral_ = gains_.ki != 0.0 ? value : 0.0; }
  /// Sets the integral to zero; derivative and history stay.
  void clear_integral() { integral_ = 0.0; }
  /// As new: integral, derivative and history forgotten.
  void reset();

 private:
  double finish(double error, double rate, double dt_s, bool restarted, Integrate integrate);

  PidGains gains_{};
  Limits limits_{};
  double tau_s_{0.05};
  double integral_{};
  double previous_error_{};
  double previous_value_{};
  double derivative_{};
  double output_{};
  bool fresh_{true};
};

// Inline: a flight runs these some thousand times per simulated second.

inline double Pid::step_with_rate(double desired, double current, double rate, double dt_s,
                                  Integrate integrate) {
  const double error = desired - current;
  if (!(dt_s > 0.0) || !std::isfinite(error) || !std::isfinite(rate)) return output_;
  previous_value_ = current;
  return finish(error, rate, dt_s, fresh_ || dt_s > kMaxGap_s, integrate);
}

inline double Pid::finish(double error, double rate, double dt_s, bool restarted,
                          Integrate integrate) {
  const double rest = gains_.kp * error - gains_.kd * rate;
  if (gains_.ki != 0.0 && integrate == Integrate::kYes) {
    const double step_s = dt_s > kMaxGap_s ? 0.0 : dt_s;
    const double mean = 0.5 * (error + (restarted ? error : previous_error_));
    const double wanted = integral_ + gains_.ki * step_s * mean;
    if (wanted > integral_) {
      integral_ = std::max(integral_, std::min(wanted, limits_.upper - rest));
    } else {
      integral_ = std::min(integral_, std::max(wanted, limits_.lower - rest));
    }
  }
  previous_error_ = error;
  fresh_ = false;
  output_ = std::clamp(rest + integral_, limits_.lower, limits_.upper);
  return output_;
}

}  // namespace rosflight::autonomy
