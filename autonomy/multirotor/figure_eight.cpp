// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/figure_eight.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::autonomy::multirotor {
namespace {

constexpr double kFirstZeroOfJ0 = 2.404825557695773;

}  // namespace

FigureEightLeg::FigureEightLeg(const Trajectory& start, double radius_m, int turns,
                               double course_rad, double speed_m_s, double acceleration_m_s2)
    : start_{start}, length_m_{2.0 * kPi * kFirstZeroOfJ0 * radius_m} {
  for (std::size_t n = 1; n <= kTerms; ++n) {
    const double sign = (n / 2) % 2 == 0 ? 1.0 : -1.0;
    const double order = static_cast<double>(n);
    c_[n - 1] =
        length_m_ / (2.0 * kPi) * 2.0 * sign * std::cyl_bessel_j(order, kFirstZeroOfJ0) / order;
  }
  // The first lobe of (1) lies along y.
  cosine_ = std::cos(course_rad - 0.5 * kPi);
  sine_ = std::sin(course_rad - 0.5 * kPi);
  path_m_ = length_m_ * turns;
  // A ramp of T takes v T/2 of the way; half of it must do.
  const double half = 0.5 * acceleration_m_s2;
  speed_m_s_ = std::min(speed_m_s, std::sqrt(2.0 * half * path_m_ / kPi));
  ramp_s_ = 0.5 * kPi * speed_m_s_ / half;
  cruise_end_s_ = path_m_ / speed_m_s_;
}

FigureEightLeg::Along FigureEightLeg::along(double t_s) const {
  const auto ramp = [this](double t) -> Along {
    const double w = kPi / ramp_s_;
    return {0.5 * speed_m_s_ * (t - std::sin(w * t) / w),
            0.5 * speed_m_s_ * (1.0 - std::cos(w * t)), 0.5 * speed_m_s_ * w * std::sin(w * t),
            0.5 * speed_m_s_ * w * w * std::cos(w * t)};
  };
  if (t_s <= 0.0) return {};
  if (t_s < ramp_s_) return ramp(t_s);
  if (t_s < cruise_end_s_) return {speed_m_s_ * (t_s - 0.5 * ramp_s_), speed_m_s_, 0.0, 0.0};
  if (t_s >= duration_s()) return {path_m_, 0.0, 0.0, 0.0};
  const Along back = ramp(duration_s() - t_s);
  return {path_m_ - back.s_m, back.v_m_s, -back.a_m_s2, back.j_m_s3};
}

Trajectory FigureEightLeg::sample(double t_s) const {
  Trajectory out = start_;
  out.v_W.setZero();
  out.a_W.setZero();
  out.j_W.setZero();
  out.psi_dot_rad_s = out.psi_ddot_rad_s2 = 0.0;
  if (t_s >= duration_s() || t_s <= 0.0) return out;  // both ends are the crossing
  const Along at = along(t_s);
  const double k = 2.0 * kPi / length_m_;
  const double phi = k * at.s_m;
  double x = 0.0;
  double y = 0.0;
  for (std::size_t n = 1; n <= kTerms; ++n) {
    (n % 2 == 0 ? x : y) += c_[n - 1] * std::sin(static_cast<double>(n) * phi);
  }
  const double chi = kFirstZeroOfJ0 * std::cos(phi);
  const double curvature = -kFirstZeroOfJ0 * k * std::sin(phi);
  const double curvature_rate = -kFirstZeroOfJ0 * k * k * std::cos(phi) * at.v_m_s;
  const double v = at.v_m_s;
  // Along and across the path: d(v t)/dt = a t + v^2 c n, once more for the jerk.
  const double a_t = at.a_m_s2;
  const double a_n = v * v * curvature;
  const double j_t = at.j_m_s3 - v * v * v * curvature * curvature;
  const double j_n = 3.0 * v * at.a_m_s2 * curvature + v * v * curvature_rate;
  const auto turned = [this](double north, double east) {
    return Vector3(cosine_ * north - sine_ * east, sine_ * north + cosine_ * east, 0.0);
  };
  const double c = std::cos(chi);
  const double s = std::sin(chi);
  out.p_W += turned(x, y);
  out.v_W = turned(v * c, v * s);
  out.a_W = turned(a_t * c - a_n * s, a_t * s + a_n * c);
  out.j_W = turned(j_t * c - j_n * s, j_t * s + j_n * c);
  return out;
}

}  // namespace rosflight::autonomy::multirotor
