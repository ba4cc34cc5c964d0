// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/mixer.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace rosflight::core {
namespace {

constexpr float kSmallestBattery_V = 1e-4f;
constexpr float kServoCentre = 0.5f;
constexpr float kGpioThreshold = 0.5f;

/// Four channels of a padded array, from the first of `group` on.
template <class Values>
auto four(Values& values, std::size_t group) {
  using Array = std::conditional_t<std::is_const_v<Values>, const Eigen::Array<float, kGroup, 1>,
                                   Eigen::Array<float, kGroup, 1>>;
  return Eigen::Map<Array, Eigen::Aligned16>(values.data() + kGroup * group);
}

}  // namespace

void Mixer::set_header(const MixerHeader& header) {
  header_ = header;
  motors_ = servos_ = gpios_ = free_ = ChannelList{};
  mixed_.fill(0.0f);
  used_.fill(0.0f);
  motor_.fill(0.0f);
  groups_ = 0;
  for (std::size_t k = 0; k < hal::kOutputs; ++k) {
    const OutputType type = k < kChannels ? header_.type[k] : OutputType::kAux;
    if (type != OutputType::kAux) {
      used_[k] = 1.0f;
      groups_ = static_cast<std::uint8_t>(k / kGroup + 1);
    }
    const auto bit = static_cast<std::uint16_t>(1u << k);
    switch (type) {
      case OutputType::kMotor:
        motors_.add(k);
        motor_[k] = 1.0f;
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
  stale_ = true;
}

bool Mixer::set_auxiliary(const link::AuxCommand& command) {
  for (std::size_t k = 0; k < command.type.size(); ++k) {
    if (command.type[k] > static_cast<std::uint8_t>(link::AuxType::kMotor)) return false;
    if (command.type[k] != 0 && !std::isfinite(command.value[k])) return false;
  }
  auxiliary_ = command;
  stale_ = true;
  return true;
}

const hal::OutputValues& Mixer::step(const Inputs& u, const Conditions& conditions) {
  if (!valid_) return outputs_;
  mix(u, conditions);
  if (!mixed_is_finite()) {
    mixed_.fill(0.0f);
    stop_motors();
    return outputs_;
  }
  if (stale_ || set_armed_ != conditions.armed) {
    stale_ = false;
    set_armed_ = conditions.armed;
    set_limits(conditions.armed);
    fill_free_channels(conditions.armed);
  }
  limit_mixed();
  return outputs_;
}

void Mixer::stop_motors() {
  for (const std::size_t k : motors_) outputs_[k] = 0.0f;
  for (const std::size_t k : free_) {
    if (auxiliary_.type[k] == static_cast<std::uint8_t>(link::AuxType::kMotor)) outputs_[k] = 0.0f;
  }
  stale_ = true;
}

inline bool Mixer::mixed_is_finite() const {
  float sum = 0.0f;  // one NaN or infinity makes it one
  for (std::size_t g = 0; g < groups_; ++g) sum += four(mixed_, g).abs().sum();
  return std::isfinite(sum);
}

inline void Mixer::mix(const Inputs& u, const Conditions& conditions) {
  const std::size_t throttle = config_.throttle_entry;
  Inputs input = u;
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

  const bool all_primary = conditions.primary_entries == kAllEntries;
  for (std::size_t g = 0; g < groups_; ++g) {
    four(mixed_, g) = four(used_, g) * (all_primary ? product(primary_, input, g)
                                                    : product_by_entry(input, g, conditions));
  }
  motor_model_failed_ = false;
  saturation_ = 0.0f;
  if (config_.fixed_wing) return;
  if (config_.use_motor_model) motors_from_speed(conditions);
  scale_motors();
}

/// (1) for the channels of one group.
inline Mixer::Group Mixer::product(const MixerGains& gains, const Inputs& u, std::size_t group) {
  // Entry by entry, the same order of sums on every processor.
  const float* column = gains.data() + kGroup * group;
  using Four = Eigen::Map<const Group, Eigen::Aligned16>;
  Group tau = Four(column) * u[0];
  for (std::size_t i = 1; i < kEntries; ++i) tau += Four(column + kPaddedChannels * i) * u[i];
  return tau;
}

/// The same with each input through the gains of the mixer that has it.
Mixer::Group Mixer::product_by_entry(const Inputs& u, std::size_t group,
                                     const Conditions& conditions) const {
  Group tau = Group::Zero();
  for (std::size_t i = 0; i < kEntries; ++i) {
    const bool primary = (conditions.primary_entries >> i & 1u) != 0;
    const float* gains = (primary ? primary_ : secondary_).data() + kPaddedChannels * i;
    tau += Eigen::Map<const Group, Eigen::Aligned16>(gains + kGroup * group) * u[i];
  }
  return tau;
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

inline void Mixer::scale_motors() {
  for (std::size_t g = 0; g < groups_; ++g) {
    saturation_ = std::max(saturation_, (four(mixed_, g) * four(motor_, g)).abs().maxCoeff());
  }
  if (saturation_ <= 1.0f) return;
  const float scale = 1.0f / saturation_;
  for (const std::size_t k : motors_) mixed_[k] *= scale;
}

Mixer::MotorRange Mixer::motor_range(bool armed) const {
  if (!armed) return {0.0f, 0.0f};
  return {config_.spin_when_armed ? config_.idle_throttle : 0.0f, 1.0f};
}

void Mixer::set_limits(bool armed) {
  const MotorRange range = motor_range(armed);
  for (const std::size_t k : motors_) {
    gain_[k] = 1.0f, centre_[k] = 0.0f, low_[k] = range.low, high_[k] = range.high;
  }
  for (const std::size_t k : servos_) {
    gain_[k] = 0.5f, centre_[k] = kServoCentre, low_[k] = 0.0f, high_[k] = 1.0f;
  }
}

/// Outputs of the mixer's own channels.
inline void Mixer::limit_mixed() {
  for (std::size_t g = 0; g < groups_; ++g) {
    four(outputs_, g) = (four(mixed_, g) * four(gain_, g) + four(centre_, g))
                            .max(four(low_, g))
                            .min(four(high_, g));
  }
  for (const std::size_t k : gpios_) outputs_[k] = mixed_[k] >= kGpioThreshold ? 1.0f : 0.0f;
}

/// Outputs that the mixer leaves to auxiliary commands.
void Mixer::fill_free_channels(bool armed) {
  const MotorRange range = motor_range(armed);
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
    if (k < kPaddedChannels) low_[k] = high_[k] = outputs_[k];  // limit_mixed() leaves it so
  }
}

float Mixer::thrust_fraction(const Inputs& u, float density_kg_m3) const {
  if (motors_.size == 0) return 0.0f;
  float total = 0.0f;
  for (const std::size_t k : motors_) {
    float value = 0.0f;
    for (std::size_t i = 0; i < kEntries; ++i) {
      value += secondary_(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) * u[i];
    }
    total += std::max(0.0f, value);
  }
  if (!config_.use_motor_model) return total / static_cast<float>(motors_.size);
  return total * config_.motor.thrust_gain(density_kg_m3) / std::max(config_.max_thrust_N, 1e-3f);
}

}  // namespace rosflight::core
