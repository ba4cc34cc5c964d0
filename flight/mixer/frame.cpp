// SPDX-License-Identifier: BSD-3-Clause
#include "flight/mixer/frame.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>

#include "base/constants.hpp"

namespace rosflight::flight {
namespace {

using companion::ParameterValue;
using config::Range;

constexpr std::size_t kMostMotors = 10;
constexpr double kFourPiSq = 4.0 * base::kPi * base::kPi;
constexpr float kMotorRate_hz = 490.0F;

double drag_power(double diameter_m) {
  return std::pow(diameter_m, 4);
}

/// A list of n triples, written flat or as triples.
std::vector<Eigen::Vector3d> triples(const config::Section& section, const std::string& key,
                                     std::size_t count) {
  const std::vector<double> flat = section.numbers(key, 3 * count, Range::any());
  std::vector<Eigen::Vector3d> result(count);
  for (std::size_t k = 0; k < count; ++k) {
    result[k] = {flat[3 * k], flat[3 * k + 1], flat[3 * k + 2]};
  }
  return result;
}

}  // namespace

double FrameConfig::thrust_gain_N_s2() const {
  return prop_ct * air_density_kg_m3 * drag_power(prop_diameter_m) / kFourPiSq;
}

double FrameConfig::torque_gain_Nm_s2() const {
  return prop_cq * air_density_kg_m3 * drag_power(prop_diameter_m) * prop_diameter_m / kFourPiSq;
}

FrameConfig read_frame(const std::string& path) {
  return read_frame(config::Document::from_file(path));
}

FrameConfig read_frame(const config::Document& document) {
  const config::Section file = document.root();
  FrameConfig frame;
  const auto count = static_cast<std::size_t>(
      file.integer("num_motors", 1, static_cast<std::int64_t>(kMostMotors)));
  const auto positions = triples(file, "motor_positions", count);
  const auto axes = triples(file, "motor_orientations", count);
  const auto spins = file.numbers("motor_directions", count, Range::between(-1.0, 1.0));
  for (std::size_t k = 0; k < count; ++k) {
    constexpr double kUnitTolerance = 1e-3;
    if (std::abs(axes[k].norm() - 1.0) > kUnitTolerance) {
      throw file.error("motor_orientations",
                       fmt::format("length {:.4f} for motor {}", axes[k].norm(), k),
                       "unit vectors");
    }
    if (std::abs(spins[k]) != 1.0) {
      throw file.error("motor_directions", fmt::format("{}", spins[k]), "-1 or 1");
    }
    frame.rotors.push_back({positions[k], axes[k].normalized(), spins[k]});
  }
  frame.air_density_kg_m3 = file.number("air_density", Range::positive_up_to(2.0));
  frame.prop_diameter_m = file.number("prop_diameter", Range::positive_up_to(5.0));
  frame.prop_ct = file.number("prop_ct", Range::positive_up_to(1.0));
  frame.prop_cq = file.number("prop_cq", Range::positive_up_to(1.0));
  frame.mass_kg = file.number("vehicle_mass", Range::positive_up_to(1000.0));
  frame.motor_resistance_ohm = file.number("motor_resistance", Range::positive_up_to(100.0));
  frame.motor_kv_V_s_rad = file.number("motor_kv", Range::positive_up_to(10.0));
  frame.no_load_current_A = file.number("no_load_current", Range::between(0.0, 100.0));
  frame.max_voltage_V = file.number("max_voltage", Range::positive_up_to(1000.0));
  file.finish();
  const FrameQuality quality = frame_quality(frame, frame_matrix(frame));
  if (!quality.commands_lift_and_torque) {
    throw file.error("motor_positions", fmt::format("a frame of rank {}", quality.rank),
                     "one that can command lift, roll, pitch and yaw independently");
  }
  return frame;
}

Eigen::MatrixXd frame_matrix(const FrameConfig& frame) {
  const double kt = frame.thrust_gain_N_s2();
  const double kq = frame.torque_gain_Nm_s2();
  Eigen::MatrixXd M(6, static_cast<Eigen::Index>(frame.rotors.size()));
  for (Eigen::Index k = 0; k < M.cols(); ++k) {
    const FrameRotor& rotor = frame.rotors[static_cast<std::size_t>(k)];
    M.block<3, 1>(0, k) = kt * rotor.e_B;
    M.block<3, 1>(3, k) = kt * rotor.p_B.cross(rotor.e_B) + kq * rotor.spin * rotor.e_B;
  }
  return M;
}

FrameQuality frame_quality(const FrameConfig& frame, const Eigen::MatrixXd& M) {
  double arm = 0.0;
  for (const FrameRotor& rotor : frame.rotors) arm += rotor.p_B.norm();
  arm /= static_cast<double>(frame.rotors.size());
  if (!(arm > 0.0)) arm = 1.0;
  Eigen::MatrixXd scaled = M / frame.thrust_gain_N_s2();
  scaled.bottomRows(3) /= arm;
  constexpr double kRankTolerance = 1e-6;
  const auto rank_of = [](const Eigen::MatrixXd& A, Eigen::VectorXd& sigma) {
    sigma = Eigen::JacobiSVD<Eigen::MatrixXd>(A).singularValues();
    return static_cast<int>((sigma.array() > kRankTolerance * sigma(0)).count());
  };
  FrameQuality quality;
  Eigen::VectorXd sigma;
  quality.rank = rank_of(scaled, sigma);
  quality.condition = sigma(0) / sigma(quality.rank - 1);
  quality.commands_lift_and_torque = rank_of(scaled.bottomRows(4), sigma) == 4;
  return quality;
}

Eigen::MatrixXd frame_inverse(const Eigen::MatrixXd& M) {
  return M.completeOrthogonalDecomposition().pseudoInverse();
}

HoverCheck hover_check(const FrameConfig& frame) {
  const double kt = frame.thrust_gain_N_s2();
  const double kq = frame.torque_gain_Nm_s2();
  double lift = 0.0;  // per squared speed, all rotors alike
  for (const FrameRotor& rotor : frame.rotors) lift += -kt * rotor.e_B.z();
  constexpr double kGravity_m_s2 = base::kStandardGravity_m_s2;
  HoverCheck check;
  if (lift <= 0.0) return check;
  check.speed_rad_s = std::sqrt(frame.mass_kg * kGravity_m_s2 / lift);
  const double K = frame.motor_kv_V_s_rad;
  const double R = frame.motor_resistance_ohm;
  check.voltage_V = R / K * kq * check.speed_rad_s * check.speed_rad_s +
                    R * frame.no_load_current_A + K * check.speed_rad_s;
  check.throttle = check.voltage_V / frame.max_voltage_V;
  const double a = R * kq / K;
  const double c = frame.no_load_current_A * R - frame.max_voltage_V;
  check.max_speed_rad_s = (-K + std::sqrt(K * K - 4.0 * a * c)) / (2.0 * a);
  check.max_thrust_N =
      static_cast<double>(frame.rotors.size()) * kt * check.max_speed_rad_s * check.max_speed_rad_s;
  check.thrust_to_weight =
      lift * check.max_speed_rad_s * check.max_speed_rad_s / (frame.mass_kg * kGravity_m_s2);
  return check;
}

companion::ParameterSet mixer_parameters(const FrameConfig& frame, MixerTarget target) {
  const bool primary = target == MixerTarget::kPrimary;
  const Eigen::MatrixXd inverse = frame_inverse(frame_matrix(frame));
  const auto motors = static_cast<std::size_t>(inverse.rows());
  companion::ParameterSet set;
  const auto add_float = [&set](const std::string& name, double value) {
    set.push_back({name, ParameterValue::of(static_cast<float>(value))});
  };
  const auto add_int = [&set](const std::string& name, int value) {
    set.push_back({name, ParameterValue::of(static_cast<std::int32_t>(value))});
  };
  if (primary) {
    add_int("PRIMARY_MIXER", 11);
    add_int("USE_MOTOR_PARAM", 1);
    add_int("NUM_MOTORS", static_cast<int>(motors));
    add_float("MOTOR_RESISTANCE", frame.motor_resistance_ohm);
    add_float("MOTOR_KV", frame.motor_kv_V_s_rad);
    add_float("NO_LOAD_CURRENT", frame.no_load_current_A);
    add_float("PROP_DIAMETER", frame.prop_diameter_m);
    add_float("PROP_CT", frame.prop_ct);
    add_float("PROP_CQ", frame.prop_cq);
    add_float("BATT_VOLT_MAX", frame.max_voltage_V);
    for (std::size_t k = 0; k < kMostMotors; ++k) {
      add_int(fmt::format("PRI_MIXER_OUT_{}", k), k < motors ? 2 : 0);
      add_float(fmt::format("PRI_MIXER_PWM_{}", k), static_cast<double>(kMotorRate_hz));
    }
  } else {
    add_int("SECONDARY_MIXER", 11);
  }
  for (std::size_t channel = 0; channel < kMostMotors; ++channel) {
    for (std::size_t input = 0; input < kMostMotors; ++input) {
      const bool used = channel < motors && input < 6;
      const double gain =
          used ? inverse(static_cast<Eigen::Index>(channel), static_cast<Eigen::Index>(input))
               : 0.0;
      // Least-squares noise of an input the frame cannot command is no gain.
      constexpr double kNoise = 1e-9;
      const double largest = inverse.cwiseAbs().maxCoeff();
      add_float(fmt::format("{}_MIXER_{}_{}", primary ? "PRI" : "SEC", input, channel),
                std::abs(gain) < kNoise * largest ? 0.0 : gain);
    }
  }
  return set;
}

}  // namespace rosflight::flight
