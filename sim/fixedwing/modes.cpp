// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/fixedwing/motion.hpp"
#include "sim/fixedwing/trim.hpp"

namespace rosflight::sim {
namespace {

/// Order of the states: v (3), w (3), roll, pitch, rotor speeds.
constexpr Eigen::Index kBody = 8;

Eigen::MatrixXd linearise(const TrimVehicle& vehicle, const Trim& trim, Eigen::Index rotors) {
  std::vector<double> x = trim.module_state;
  std::vector<double> x_dot(x.size());
  const auto derivative = [&](const Eigen::VectorXd& y) {
    for (Eigen::Index i = 0; i < rotors; ++i) x[static_cast<std::size_t>(i)] = y[kBody + i];
    const detail::Motion motion{y.segment<3>(0), y.segment<3>(3), y[6], y[7]};
    const detail::Acceleration a =
        detail::accelerate(vehicle, trim.air, motion, trim.outputs, x, x_dot);
    const double turn = y[4] * std::sin(y[6]) + y[5] * std::cos(y[6]);
    Eigen::VectorXd rate(y.size());
    rate.segment<3>(0) = a.v_dot_B;
    rate.segment<3>(3) = a.w_dot_B;
    rate[6] = y[3] + std::tan(y[7]) * turn;
    rate[7] = y[4] * std::cos(y[6]) - y[5] * std::sin(y[6]);
    for (Eigen::Index i = 0; i < rotors; ++i) rate[kBody + i] = x_dot[static_cast<std::size_t>(i)];
    return rate;
  };
  Eigen::VectorXd y(kBody + rotors);
  y << trim.body.v_B, trim.body.w_B, trim.roll_rad, trim.pitch_rad,
      Eigen::Map<const Eigen::VectorXd>(trim.module_state.data(), rotors);
  Eigen::MatrixXd slope(y.size(), y.size());
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    const double step = 1e-5 * std::max(1.0, std::abs(y[i]));
    Eigen::VectorXd high = y;
    Eigen::VectorXd low = y;
    high[i] += step;
    low[i] -= step;
    slope.col(i) = (derivative(high) - derivative(low)) / (2.0 * step);
  }
  return slope;
}

/// How much of a mode is in rotor speeds, lateral and longitudinal motion: sums of participation
/// factors |w_k v_k|, w and v its left and right eigenvectors, which do not depend on units.
struct Share {
  double motor{};
  double lateral{};
  double longitudinal{};
};

Share share_of(const Eigen::VectorXcd& right, const Eigen::RowVectorXcd& left) {
  const Eigen::ArrayXd part = (right.transpose().array() * left.array()).abs().transpose();
  return {part.tail(part.size() - kBody).sum(), part[1] + part[3] + part[5] + part[6],
          part[0] + part[2] + part[4] + part[7]};
}

/// Fast first.
void sort(std::vector<Mode>& modes) {
  std::ranges::sort(modes, std::greater<>(), &Mode::frequency_rad_s);
}

/// Two eigenvalues are the short period, the slower rest the phugoid; a pair counts for two.
void name_longitudinal(std::vector<Mode>& modes) {
  sort(modes);
  int passed = 0;
  for (Mode& mode : modes) {
    mode.name = passed < 2 ? "short period" : "phugoid";
    passed += mode.imaginary_rad_s > 0.0 ? 2 : 1;
  }
}

void name_lateral(std::vector<Mode>& modes) {
  sort(modes);
  bool pair_seen = false;
  bool real_seen = false;
  for (Mode& mode : modes) {
    const bool pair = mode.imaginary_rad_s > 0.0;
    if (pair) {
      mode.name = pair_seen ? "roll and spiral" : "Dutch roll";
    } else {
      mode.name = real_seen ? "spiral" : "roll";
    }
    (pair ? pair_seen : real_seen) = true;
  }
}

}  // namespace

double Mode::frequency_rad_s() const {
  return std::hypot(real_1_s, imaginary_rad_s);
}

double Mode::damping_ratio() const {
  return -real_1_s / frequency_rad_s();
}

std::vector<Mode> find_modes(const TrimVehicle& vehicle, const Trim& trim) {
  const MultirotorParameters& propulsion = vehicle.forces.parameters().propulsion;
  const bool instant = propulsion.motor.model == MotorModel::kInstant;
  const auto rotors =
      instant ? Eigen::Index{0} : static_cast<Eigen::Index>(propulsion.rotors.size());
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(linearise(vehicle, trim, rotors));
  const Eigen::MatrixXcd left = solver.eigenvectors().inverse();
  std::vector<std::pair<Mode, Share>> found;
  for (Eigen::Index i = 0; i < solver.eigenvalues().size(); ++i) {
    const std::complex<double> value = solver.eigenvalues()[i];
    if (value.imag() < 0.0) continue;
    found.emplace_back(Mode{"motor", value.real(), value.imag()},
                       share_of(solver.eigenvectors().col(i), left.row(i)));
  }
  // As many motors' modes as there are rotors, whatever else moves with them.
  std::ranges::sort(found, std::greater<>(), [](const auto& f) { return f.second.motor; });
  std::vector<Mode> motor;
  std::vector<Mode> longitudinal;
  std::vector<Mode> lateral;
  for (const auto& [mode, share] : found) {
    if (static_cast<Eigen::Index>(motor.size()) < rotors) {
      motor.push_back(mode);
    } else {
      (share.lateral > share.longitudinal ? lateral : longitudinal).push_back(mode);
    }
  }
  name_longitudinal(longitudinal);
  name_lateral(lateral);
  std::vector<Mode> all = longitudinal;
  all.insert(all.end(), lateral.begin(), lateral.end());
  all.insert(all.end(), motor.begin(), motor.end());
  return all;
}

Mode lanchester_phugoid(double airspeed_m_s, double lift_to_drag, double gravity_m_s2) {
  const double frequency = std::numbers::sqrt2 * gravity_m_s2 / airspeed_m_s;
  const double damping = 1.0 / (std::numbers::sqrt2 * lift_to_drag);
  return {"phugoid", -damping * frequency, frequency * std::sqrt(1.0 - damping * damping)};
}

}  // namespace rosflight::sim
