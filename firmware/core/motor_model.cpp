// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/motor_model.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/math.hpp"

namespace rosflight::core {
namespace {

constexpr float kFourPiSq = 4.0f * kPi * kPi;

}  // namespace

float MotorModel::torque_gain(float density_kg_m3) const {
  const float d2 = prop_diameter_m * prop_diameter_m;
  return density_kg_m3 * d2 * d2 * prop_diameter_m * prop_cq / kFourPiSq;
}

float MotorModel::thrust_gain(float density_kg_m3) const {
  const float d2 = prop_diameter_m * prop_diameter_m;
  return density_kg_m3 * d2 * d2 * prop_ct / kFourPiSq;
}

float MotorModel::voltage_V(float speed_sq_rad2_s2, float density_kg_m3) const {
  return torque_gain(density_kg_m3) * speed_sq_rad2_s2 * resistance_ohm / kv_V_s_rad +
         resistance_ohm * no_load_current_A + kv_V_s_rad * std::sqrt(speed_sq_rad2_s2);
}

float MotorModel::speed_sq_rad2_s2(float voltage_V, float density_kg_m3) const {
  if (!usable()) return 0.0f;
  const float a = resistance_ohm * torque_gain(density_kg_m3) / kv_V_s_rad;
  const float b = kv_V_s_rad;
  const float c = no_load_current_A * resistance_ohm - voltage_V;
  if (c >= 0.0f) return 0.0f;
  // The form without a difference of almost equal numbers; right for a = 0 too.
  const float speed = -2.0f * c / (b + std::sqrt(b * b - 4.0f * a * c));
  return speed * speed;
}

float MotorModel::max_thrust_N(float density_kg_m3) const {
  return static_cast<float>(motor_count) * thrust_gain(density_kg_m3) *
         speed_sq_rad2_s2(full_voltage_V, density_kg_m3);
}

float full_battery_factor(float voltage_V, float full_voltage_V) {
  constexpr float kMargin = 0.98f;
  constexpr float kMaxFactor = 1.2f;
  const bool measured = voltage_V > 0.0f && voltage_V >= kMinVoltage * full_voltage_V &&
                        voltage_V <= kMaxVoltage * full_voltage_V;
  if (!measured) return 1.0f;
  return std::clamp(kMargin * full_voltage_V / voltage_V, 1.0f, kMaxFactor);
}

}  // namespace rosflight::core
