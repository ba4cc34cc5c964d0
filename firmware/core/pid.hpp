// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>

namespace rosflight::core {

/// One PID loop on an error e:
///
///     u = K_P e - K_D dx/dt + I ,   I <- I + K_I e dt                                     (1)
///
/// I has the unit of the output, so that a new K_I makes no step; with K_I = 0 it does not change.
/// While the actuators are saturated it changes only towards a smaller |u| or |I|.
///
/// Differing from ROSflight 2.x on purpose (docs/compatibility.md, 40 and 41): while integration is
/// held, I stays in u; it is clamped; and a loop that is started again starts from rest.
class Pid {
 public:
  struct Gains {
    float p{0.0f}, i{0.0f}, d{0.0f};
  };

  /// Applies new gains; the state is kept.
  void configure(const Gains& gains) { gains_ = gains; }
  /// Clears integral and derivative: on arming, or when the loop did not run before.
  void reset() { *this = Pid{gains_}; }

  Pid() = default;

  /// Evaluates (1). A NaN or infinity propagates to u, never to I.
  /// @param x_dot       derivative of x if it is measured, else of derivative().
  /// @param integrate   I may change.
  /// @param saturated   the previous output exceeded the actuators.
  /// @param limit       largest magnitude of I.
  float step(float e, float x_dot, float dt_s, bool integrate, bool saturated, float limit) {
    const float d = gains_.d > 0.0f ? gains_.d * x_dot : 0.0f;
    const float quick = gains_.p * e - d;
    if (gains_.i > 0.0f) {
      float next = integral_;
      if (integrate && (!saturated || unwinds(e, quick))) next += gains_.i * e * dt_s;
      if (std::isfinite(next)) {
        integral_ = next > limit ? limit : (next < -limit ? -limit : next);
      }
    }
    return quick + integral_;
  }

  /// Band-limited derivative, time constant tau (Tustin):
  ///     y_k = (2 tau - dt)/(2 tau + dt) y_{k-1} + 2/(2 tau + dt) (x_k - x_{k-1})
  /// Unchanged for dt <= 0.1 ms. The first call after a reset only stores x.
  float derivative(float x, float dt_s, float tau_s) {
    if (gains_.d <= 0.0f) {
      derivative_ = 0.0f;
      has_last_ = false;  // a derivative gain set later starts from rest
      return 0.0f;
    }
    constexpr float kMinStep_s = 1e-4f;
    if (dt_s > kMinStep_s && has_last_) {
      const float sum = 2.0f * tau_s + dt_s;
      const float next = (2.0f * tau_s - dt_s) / sum * derivative_ + 2.0f / sum * (x - last_);
      if (!std::isfinite(next)) return next;  // and is not stored
      derivative_ = next;
    }
    last_ = x;
    has_last_ = true;
    return derivative_;
  }

 private:
  /// The error takes the output or the integral towards zero.
  bool unwinds(float e, float quick) const {
    return e * (quick + integral_) < 0.0f || e * integral_ < 0.0f;
  }

  explicit Pid(const Gains& gains) : gains_{gains} {}

  Gains gains_{};
  float integral_{0.0f};  ///< I.
  float derivative_{0.0f};
  float last_{0.0f};
  bool has_last_{false};
};

}  // namespace rosflight::core
