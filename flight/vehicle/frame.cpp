// SPDX-License-Identifier: BSD-3-Clause
#include "flight/vehicle/frame.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "firmware/core/mixer_frames.hpp"
#include "flight/vehicle/vehicle_setup.hpp"

namespace rosflight::flight {
namespace {

using companion::ParameterValue;
using config::Range;

constexpr std::size_t kMaxMotors = core::kChannels;
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

/// Refuses a frame that cannot hover under control.
void check_quality(const FrameConfig& frame, const config::Section& section, const char* key) {
  const FrameQuality quality = frame_quality(frame, frame_matrix(frame));
  if (quality.commands_lift_and_torque) return;
  throw section.error(key, fmt::format("a frame of rank {}", quality.rank),
                      "one that can command lift, roll, pitch and yaw independently");
}

void add(companion::ParameterSet& set, const std::string& name, double value) {
  set.push_back({name, ParameterValue::of(static_cast<float>(value))});
}

void add(companion::ParameterSet& set, const std::string& name, int value) {
  set.push_back({name, ParameterValue::of(static_cast<std::int32_t>(value))});
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
      file.integer("num_motors", 1, static_cast<std::int64_t>(kMaxMotors)));
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
    frame.rotors.push_back({positions[k], axes[k].normalized(), spins[k], k});
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
  check_quality(frame, file, "motor_positions");
  return frame;
}

FrameConfig vehicle_frame(const sim::Vehicle& vehicle) {
  if (is_fixed_wing(vehicle)) {
    throw vehicle.root().error("type", vehicle.type(),
                               "a multirotor: mixers of fixed wings are predefined");
  }
  FrameConfig frame = propulsion_frame(vehicle);
  const config::Section section = vehicle.root().section("rotors");
  for (const FrameRotor& rotor : frame.rotors) {
    if (rotor.output >= kMaxMotors) {
      throw section.error("layout", fmt::format("output {}", rotor.output), "outputs 0 to 9");
    }
  }
  check_quality(frame, section, "layout");
  return frame;
}

FrameConfig propulsion_frame(const sim::Vehicle& vehicle) {
  const sim::MultirotorParameters propulsion = read_rotors(vehicle);
  const sim::EnvironmentParameters& environment = vehicle.environment();
  FrameConfig frame;
  for (const sim::RotorParameters& rotor : propulsion.rotors) {
    frame.rotors.push_back({rotor.p_B, rotor.e_B, rotor.spin, rotor.output});
  }
  frame.air_density_kg_m3 =
      sim::Atmosphere(environment.atmosphere).at(environment.origin.altitude_m).density_kg_m3;
  frame.prop_diameter_m = propulsion.propeller.diameter_m;
  frame.prop_ct = propulsion.propeller.thrust[0];
  frame.prop_cq = propulsion.propeller.torque[0];
  frame.mass_kg = vehicle.body().mass_kg;
  frame.motor_resistance_ohm = propulsion.motor.resistance_ohm;
  frame.motor_kv_V_s_rad = propulsion.motor.torque_constant_Nm_A;
  frame.no_load_current_A = propulsion.motor.no_load_current_A;
  const sim::Battery battery(propulsion.battery);
  frame.max_voltage_V = vehicle.firmware().number(
      "BATT_VOLT_MAX", Range::any(), battery.open_circuit_V(propulsion.battery.capacity_As));
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
  const Eigen::MatrixXd inverse = frame_inverse(scaled);
  FrameQuality quality;
  quality.rank = static_cast<int>(std::lround((scaled * inverse).trace()));
  quality.condition = scaled.norm() * inverse.norm();
  Eigen::MatrixXd lift_and_torque = scaled;
  lift_and_torque.topRows(2).setZero();
  constexpr double kFullRank = 3.5;  // the trace is a whole number
  quality.commands_lift_and_torque =
      (lift_and_torque * frame_inverse(lift_and_torque)).trace() > kFullRank;
  return quality;
}

Eigen::MatrixXd frame_inverse(const Eigen::MatrixXd& M) {
  Eigen::Matrix<float, core::kAxes, core::kChannels> whole;
  whole.setZero();
  whole.topLeftCorner(M.rows(), M.cols()) = M.cast<float>();
  Eigen::MatrixXd inverse =
      core::pseudo_inverse(whole).topLeftCorner(M.cols(), M.rows()).cast<double>();
  // The rounding of an input that the frame cannot command is no gain.
  constexpr double kNoise = 1e-6;
  const double noise = kNoise * inverse.cwiseAbs().maxCoeff();
  return inverse.unaryExpr([noise](double gain) { return std::abs(gain) < noise ? 0.0 : gain; });
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

companion::ParameterSet motor_parameters(const FrameConfig& frame) {
  companion::ParameterSet set;
  add(set, "NUM_MOTORS", static_cast<int>(frame.rotors.size()));
  add(set, "PROP_DIAMETER", frame.prop_diameter_m);
  add(set, "PROP_CT", frame.prop_ct);
  add(set, "PROP_CQ", frame.prop_cq);
  add(set, "MOTOR_KV", frame.motor_kv_V_s_rad);
  add(set, "MOTOR_RESISTANCE", frame.motor_resistance_ohm);
  add(set, "NO_LOAD_CURRENT", frame.no_load_current_A);
  return set;
}

companion::ParameterSet mixer_parameters(const FrameConfig& frame, MixerTarget target) {
  const Eigen::MatrixXd inverse = frame_inverse(frame_matrix(frame));
  companion::ParameterSet set;
  const char* prefix = "SEC";
  if (target == MixerTarget::kPrimary) {
    prefix = "PRI";
    set = motor_parameters(frame);
    add(set, "PRIMARY_MIXER", 11);
    add(set, "USE_MOTOR_PARAM", 1);
    add(set, "BATT_VOLT_MAX", frame.max_voltage_V);
  } else {
    add(set, "SECONDARY_MIXER", 11);
  }
  for (std::size_t channel = 0; channel < kMaxMotors; ++channel) {
    const auto rotor = std::find_if(frame.rotors.begin(), frame.rotors.end(),
                                    [channel](const FrameRotor& r) { return r.output == channel; });
    const bool used = rotor != frame.rotors.end();
    if (target == MixerTarget::kPrimary) {
      add(set, fmt::format("PRI_MIXER_OUT_{}", channel), used ? 2 : 0);
      add(set, fmt::format("PRI_MIXER_PWM_{}", channel), static_cast<double>(kMotorRate_hz));
    }
    for (Eigen::Index input = 0; input < Eigen::Index{core::kAxes}; ++input) {
      const double gain =
          used && input < inverse.cols() ? inverse(rotor - frame.rotors.begin(), input) : 0.0;
      add(set, fmt::format("{}_MIXER_{}_{}", prefix, input, channel), gain);
    }
  }
  return set;
}

}  // namespace rosflight::flight
