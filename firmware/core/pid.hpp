// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rosflight::core {

/// One PID loop:  u = K_P (r - x) - K_D dx/dt + K_I s ,  s <- s + (r - x) dt.
///
/// Differing from ROSflight 2.x on purpose (docs/compatibility.md, 40 and 41): while integration is
/// held, the integral term stays in u; it is clamped; and a loop that starts anew starts from rest.
class Pid {
 public:
  struct Gains {
    float p{0.0f}, i{0.0f}, d{0.0f};
  };

  void configure(const Gains& gains) { gains_ = gains; }
  /// Forgets integral and derivative: arming, or the loop did not run before.
  void reset() { *this = Pid{gains_}; }

  Pid() = default;

  /// @param x_dot       derivative of x if it is measured, else use derivative().
  /// @param integrate   let the integral move.
  /// @param limit       largest magnitude of K_I s.
  float step(float r, float x, float x_dot, float dt_s, bool integrate, float limit) {
    const float e = r - x;
    if (gains_.i > 0.0f) {
      if (integrate) integral_ += e * dt_s;
      const float most = limit / gains_.i;
      integral_ = integral_ > most ? most : (integral_ < -most ? -most : integral_);
    }
    const float d = gains_.d > 0.0f ? gains_.d * x_dot : 0.0f;
    return gains_.p * e - d + gains_.i * integral_;
  }

  /// Band-limited derivative, time constant tau (Tustin):
  ///     y_k = (2 tau - dt)/(2 tau + dt) y_{k-1} + 2/(2 tau + dt) (x_k - x_{k-1})
  /// Unchanged for dt <= 0.1 ms. The first call after a reset only remembers x.
  float derivative(float x, float dt_s, float tau_s) {
    if (gains_.d <= 0.0f) {
      derivative_ = 0.0f;
      has_last_ = false;  // a derivative gain set later starts from rest
      return 0.0f;
    }
    constexpr float kSmallestStep_s = 1e-4f;
    if (dt_s > kSmallestStep_s && has_last_) {
      const float sum = 2.0f * tau_s + dt_s;
      derivative_ = (2.0f * tau_s - dt_s) / sum * derivative_ + 2.0f / sum * (x - last_);
    }
    last_ = x;
    has_last_ = true;
    return derivative_;
  }

 private:
  explicit Pid(const Gains& gains) : gains_{gains} {}

  Gains gains_{};
  float integral_{0.0f};
  float derivative_{0.0f};
  float last_{0.0f};
  bool has_last_{false};
};

}  // namespace rosflight::core
