// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/mixer.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::core {
namespace {

constexpr float kSmallestBattery_V = 1e-4f;
constexpr float kServoCentre = 0.5f;
constexpr float kGpioThreshold = 0.5f;

}  // namespace

void Mixer::set_header(const MixerHeader& header) {
  header_ = header;
  motors_ = servos_ = gpios_ = free_ = ChannelList{};
  used_.setZero();
  for (std::size_t k = 0; k < hal::kOutputs; ++k) {
    const OutputType type = k < kChannels ? header_.type[k] : OutputType::kAux;
    if (type != OutputType::kAux) used_[static_cast<Eigen::Index>(k)] = 1.0f;
    const auto bit = static_cast<std::uint16_t>(1u << k);
    switch (type) {
      case OutputType::kMotor:
        motors_.add(k);
        was_servo_ &= static_cast<std::uint16_t>(~bit);
        break;
      case OutputType::kServo:
        servos_.add(k);
        was_servo_ |= bit;
        break;
      case OutputType::kGpio:
        gpios_.add(k);
        was_servo_ &= static_cast<std::uint16_t>(~bit);
        break;
      case OutputType::kAux:
        free_.add(k);
        break;
    }
  }
  free_stale_ = true;
}

bool Mixer::set_auxiliary(const link::AuxCommand& command) {
  for (std::size_t k = 0; k < command.type.size(); ++k) {
    if (command.type[k] > static_cast<std::uint8_t>(link::AuxType::kMotor)) return false;
    if (command.type[k] != 0 && !std::isfinite(command.value[k])) return false;
  }
  auxiliary_ = command;
  free_stale_ = true;
  return true;
}

const hal::OutputValues& Mixer::step(const std::array<float, kEntries>& u,
                                     const Conditions& conditions) {
  if (!valid_) return outputs_;
  mix(u, conditions);
  if (!mixed_is_finite()) {
    mixed_.fill(0.0f);
    stop_motors();
    return outputs_;
  }
  limit_mixed(conditions.armed);
  if (free_stale_ || free_armed_ != conditions.armed) fill_free_channels(conditions.armed);
  return outputs_;
}

void Mixer::stop_motors() {
  for (const std::size_t k : motors_) outputs_[k] = 0.0f;
  for (const std::size_t k : free_) {
    if (auxiliary_.type[k] == static_cast<std::uint8_t>(link::AuxType::kMotor)) outputs_[k] = 0.0f;
  }
  free_stale_ = true;
}

bool Mixer::mixed_is_finite() const {
  return Eigen::Map<const Column, Eigen::Aligned16>(mixed_.data()).allFinite();
}

void Mixer::mix(const std::array<float, kEntries>& u, const Conditions& conditions) {
  const std::size_t throttle = config_.throttle_entry;
  std::array<float, kEntries> input = u;
  if (config_.fixed_wing) {
    if (config_.reverse_aileron) input[3] = -input[3];
    if (config_.reverse_elevator) input[4] = -input[4];
    if (config_.reverse_rudder) input[5] = -input[5];
  } else {
    const float idle = config_.use_motor_model ? config_.idle_throttle * config_.max_thrust_N
                                               : config_.idle_throttle;
    if (std::abs(input[throttle]) < idle) input[5] = 0.0f;
  }
  if (config_.unsigned_throttle) input[throttle] = std::abs(input[throttle]);

  Column tau = Column::Zero();
  for (std::size_t i = 0; i < kEntries; ++i) {
    if (input[i] == 0.0f) continue;
    const bool primary = (conditions.primary_entries >> i & 1u) != 0;
    tau += (primary ? primary_ : secondary_).col(static_cast<Eigen::Index>(i)) * input[i];
  }
  Eigen::Map<Column, Eigen::Aligned16>(mixed_.data()) = tau.cwiseProduct(used_);
  motor_model_failed_ = false;
  saturation_ = 0.0f;
  if (config_.fixed_wing) return;
  if (config_.use_motor_model) motors_from_speed(conditions);
  scale_motors();
}

void Mixer::motors_from_speed(const Conditions& conditions) {
  motor_model_failed_ = !config_.motor.usable() || !(conditions.battery_V >= kSmallestBattery_V);
  for (const std::size_t k : motors_) {
    const float speed_sq = std::max(mixed_[k], 0.0f);  // in this order a NaN stays one
    mixed_[k] = motor_model_failed_ ? 0.0f
                                    : config_.motor.voltage_V(speed_sq, conditions.density_kg_m3) /
                                          conditions.battery_V;
  }
}

void Mixer::scale_motors() {
  for (const std::size_t k : motors_) saturation_ = std::max(saturation_, std::abs(mixed_[k]));
  if (saturation_ <= 1.0f) return;
  const float scale = 1.0f / saturation_;
  for (const std::size_t k : motors_) mixed_[k] *= scale;
}

Mixer::MotorRange Mixer::motor_range(bool armed) const {
  if (!armed) return {0.0f, 0.0f};
  return {config_.spin_when_armed ? config_.idle_throttle : 0.0f, 1.0f};
}

/// Outputs of the mixer's own channels.
void Mixer::limit_mixed(bool armed) {
  const MotorRange range = motor_range(armed);
  for (const std::size_t k : motors_) {
    outputs_[k] = std::min(std::max(range.low, mixed_[k]), range.high);
  }
  for (const std::size_t k : servos_) {
    outputs_[k] = std::clamp(mixed_[k], -1.0f, 1.0f) * 0.5f + kServoCentre;
  }
  for (const std::size_t k : gpios_) {
    outputs_[k] = mixed_[k] >= kGpioThreshold ? 1.0f : 0.0f;
  }
}

/// Outputs that the mixer leaves to auxiliary commands.
void Mixer::fill_free_channels(bool armed) {
  const MotorRange range = motor_range(armed);
  free_stale_ = false;
  free_armed_ = armed;
  for (const std::size_t k : free_) {
    const auto bit = static_cast<std::uint16_t>(1u << k);
    const float value = auxiliary_.value[k];
    switch (static_cast<link::AuxType>(auxiliary_.type[k])) {
      case link::AuxType::kServo:
        was_servo_ |= bit;
        outputs_[k] = std::clamp(value, -1.0f, 1.0f) * 0.5f + kServoCentre;
        break;
      case link::AuxType::kMotor:
        was_servo_ &= static_cast<std::uint16_t>(~bit);
        outputs_[k] = std::min(std::max(range.low, value), range.high);
        break;
      case link::AuxType::kDisabled:
        outputs_[k] = (was_servo_ & bit) != 0 ? kServoCentre : 0.0f;
        break;
    }
  }
}

float Mixer::thrust_fraction(const std::array<float, kEntries>& u, float density_kg_m3) const {
  if (motors_.size == 0) return 0.0f;
  float total = 0.0f;
  for (const std::size_t k : motors_) {
    const float value = secondary_.row(static_cast<Eigen::Index>(k))
                            .dot(Eigen::Map<const Eigen::Matrix<float, 1, kEntries>>(u.data()));
    total += std::max(0.0f, value);
  }
  if (!config_.use_motor_model) return total / static_cast<float>(motors_.size);
  return total * config_.motor.thrust_gain(density_kg_m3) / std::max(config_.max_thrust_N, 1e-3f);
}

}  // namespace rosflight::core
