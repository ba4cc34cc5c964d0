// SPDX-License-Identifier: BSD-3-Clause
#include "sim/environment/dryden.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/portable_math.hpp"

namespace rosflight::sim {
namespace {

constexpr double kMetrePerFoot = 0.3048;
constexpr double kSqrt3 = 1.7320508075688772;

/// Integral of s^m e^-2s from 0 to r for m = 0, 1, 2: the covariance (q11, q12, q22) that unit
/// white noise leaves in (z1, z2). A series for small r, where the closed form would cancel.
std::array<double, 3> noise_covariance(double r) {
  if (r < 0.05) {
    std::array<double, 3> q{};
    double term = 1.0;  // (-2 r)^k / k!
    for (int k = 0; k < 10; ++k) {
      q[0] += term * r / (k + 1);
      q[1] += term * r * r / (k + 2);
      q[2] += term * r * r * r / (k + 3);
      term *= -2.0 * r / (k + 1);
    }
    return q;
  }
  const double e = portable::exp(-2.0 * r);
  return {0.5 * (1.0 - e), 0.25 - e * (0.5 * r + 0.25), 0.25 - e * (0.5 * r * (r + 1.0) + 0.25)};
}

}  // namespace

DrydenTurbulence::Transverse::Transverse(RandomStream random) : z1{0.0}, z2{0.0}, stream{random} {
  // Stationary: covariance 1/2, 1/4, 1/4.
  const double n1 = stream.normal();
  const double n2 = stream.normal();
  z1 = std::sqrt(0.5) * n1;
  z2 = std::sqrt(0.125) * (n1 + n2);
}

double DrydenTurbulence::Transverse::step(double r) {
  const auto [q11, q12, q22] = noise_covariance(r);
  const double l11 = std::sqrt(q11);
  const double l21 = l11 > 0.0 ? q12 / l11 : 0.0;
  const double l22 = std::sqrt(std::max(0.0, q22 - l21 * l21));
  const double n1 = stream.normal();
  const double n2 = stream.normal();
  const double decay = portable::exp(-r);
  z2 = decay * (z2 + r * z1) + l21 * n1 + l22 * n2;
  z1 = decay * z1 + l11 * n1;
  return kSqrt3 * z1 + (1.0 - kSqrt3) * z2;
}

DrydenTurbulence::DrydenTurbulence(double w20_m_s, const RandomSource& source)
    : w20_m_s_{w20_m_s},
      stream_u_{source.stream("dryden/u")},
      u_{stream_u_.normal()},
      v_{source.stream("dryden/v")},
      w_{source.stream("dryden/w")} {}

Vector3 DrydenTurbulence::step(double dt_s, double height_m, double speed_m_s) {
  const double h_ft = std::clamp(height_m / kMetrePerFoot, 10.0, 1000.0);
  const double log_k = portable::log(0.177 + 0.000823 * h_ft);
  const double length_u_m = h_ft * kMetrePerFoot * portable::exp(-1.2 * log_k);
  const double length_w_m = h_ft * kMetrePerFoot;
  const double sigma_w = 0.1 * w20_m_s_;
  const double sigma_u = sigma_w * portable::exp(-0.4 * log_k);

  const double path_m = std::max({speed_m_s, w20_m_s_, 1.0}) * dt_s;
  const double r_u = path_m / length_u_m;
  const double decay = portable::exp(-r_u);
  u_ = decay * u_ + std::sqrt(2.0 * noise_covariance(r_u)[0]) * stream_u_.normal();
  return {sigma_u * u_, sigma_u * v_.step(r_u), sigma_w * w_.step(path_m / length_w_m)};
}

}  // namespace rosflight::sim
