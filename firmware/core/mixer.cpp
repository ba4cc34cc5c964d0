// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/mixer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

namespace rosflight::core {
namespace {

constexpr float kMinBattery_V = 1e-4f;
constexpr float kServoCentre = 0.5f;

/// Four channels of a padded array, from the first of `group` on.
template <class Values>
auto four(Values& values, std::size_t group) {
  using Array = std::conditional_t<std::is_const_v<Values>, const Eigen::Array<float, kGroup, 1>,
                                   Eigen::Array<float, kGroup, 1>>;
  return Eigen::Map<Array, Eigen::Aligned16>(values.data() + kGroup * group);
}

bool drives_motor(const link::AuxCommand& command, std::size_t channel) {
  return command.type[channel] == static_cast<std::uint8_t>(link::AuxType::kMotor);
}

}  // namespace

void Mixer::set_header(const MixerHeader& header) {
  const MixerHeader before = header_;
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
    // There is no command for the channel's new kind.
    if (k < kChannels && type != OutputType::kAux && type != before.type[k]) {
      outputs_[k] = type == OutputType::kServo ? kServoCentre : 0.0f;
    }
  }
  invalidate();
}

bool Mixer::set_auxiliary(const link::AuxCommand& command) {
  for (std::size_t k = 0; k < command.type.size(); ++k) {
    if (command.type[k] > static_cast<std::uint8_t>(link::AuxType::kMotor)) return false;
    if (command.type[k] != 0 && !std::isfinite(command.value[k])) return false;
  }
  auxiliary_ = command;
  auxiliary_motors_ = false;
  for (std::size_t k = 0; k < command.type.size(); ++k) {
    if (!drives_motor(command, k)) continue;
    auxiliary_motors_ = true;
    if (used_by_mixer(k)) continue;
    was_servo_ &= static_cast<std::uint16_t>(~(1u << k));  // it stays a motor once released
  }
  invalidate();
  return true;
}

void Mixer::drop_auxiliary_motors() {
  if (!auxiliary_motors_) return;
  for (std::size_t k = 0; k < auxiliary_.type.size(); ++k) {
    if (!drives_motor(auxiliary_, k)) continue;
    auxiliary_.type[k] = static_cast<std::uint8_t>(link::AuxType::kDisabled);
  }
  auxiliary_motors_ = false;
  fill_free_channels();
  invalidate();
}

bool Mixer::end_auxiliary_motors(const Conditions& conditions) {
  if (conditions.armed && !conditions.failsafe && conditions.companion_present) return false;
  drop_auxiliary_motors();
  return true;
}

void Mixer::clear_outputs() {
  for (std::size_t k = 0; k < outputs_.size(); ++k) {
    outputs_[k] = (static_cast<unsigned>(was_servo_) >> k & 1u) != 0 ? kServoCentre : 0.0f;
  }
  set_for_ = Mode::kDisarmed;
  invalidate();
}

/// Work that is not needed in every pass: ends auxiliary motors, sets limits and free channels.
void Mixer::prepare(Mode mode, const Conditions& conditions) {
  end_auxiliary_motors(conditions);
  if (stale_ || set_for_ != mode) {
    stale_ = false;
    set_for_ = mode;
    set_limits();
    fill_free_channels();
  }
  prepared_for_ = auxiliary_motors_ ? Mode::kNone : mode;  // these are tested in every pass
}

/// Disarmed, all motors are at zero already.
void Mixer::turn_test_motor(const Conditions& conditions) {
  if (conditions.armed) return;
  const auto channel = static_cast<std::uint8_t>(conditions.test_motor);
  if (!is_motor(channel) || !(conditions.test_value > 0.0f)) return;
  outputs_[channel] = std::min(conditions.test_value, kTestLimit);
}

void Mixer::stop_motors() {
  for (const std::size_t k : motors_) outputs_[k] = 0.0f;
  for (const std::size_t k : free_) {
    // A motor that is no longer commanded may still have its last value: all but servos.
    const bool servo = auxiliary_.type[k] == static_cast<std::uint8_t>(link::AuxType::kServo) ||
                       (static_cast<unsigned>(was_servo_) >> k & 1u) != 0;
    if (!servo) outputs_[k] = 0.0f;
  }
  invalidate();
}

inline bool Mixer::mixed_is_finite() const {
  float sum = 0.0f;  // one NaN or infinity makes it one
  for (std::size_t g = 0; g < groups_; ++g) sum += four(mixed_, g).abs().sum();
  return std::isfinite(sum);
}

/// Free axes without a command are zero and use the primary gains: all gains give the same.
[[gnu::always_inline]] inline bool Mixer::all_secondary(const Inputs& u,
                                                        std::uint16_t primary_axes) {
  constexpr std::uint16_t kFreeAxes = 0x3C0;
  if ((primary_axes & ~kFreeAxes) != 0) return false;
  return primary_axes == 0 || (u[6] == 0.0f && u[7] == 0.0f && u[8] == 0.0f && u[9] == 0.0f);
}

inline void Mixer::mix(const Inputs& u, const Conditions& conditions) {
  const std::size_t throttle = config_.throttle_axis;
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

  const bool all_primary = conditions.primary_axes == kAllAxes;
  const bool one_mixer = all_primary || all_secondary(input, conditions.primary_axes);
  const MixerGains& gains = all_primary ? primary_ : secondary_;
  for (std::size_t g = 0; g < groups_; ++g) {
    four(mixed_, g) = four(used_, g) *
                      (one_mixer ? product(gains, input, g, std::make_index_sequence<kAxes - 1>{})
                                 : product_by_axis(input, g, conditions));
  }
  motor_model_failed_ = voltage_replaced_ = false;
  saturation_ = 0.0f;
  if (config_.fixed_wing) return;
  if (config_.use_motor_model) motors_from_speed(conditions);
  scale_motors();
}

/// (1) for the channels of one group. Axis by axis: the order of sums is the same on every processor.
/// Unrolled, because a loop would cost as much as the sums.
template <std::size_t... kLater>
inline Mixer::Group Mixer::product(const MixerGains& gains, const Inputs& u, std::size_t group,
                                   std::index_sequence<kLater...> /*axes from 1 on*/) {
  const float* column = gains.data() + kGroup * group;
  using Four = Eigen::Map<const Group, Eigen::Aligned16>;
  Group tau = Four(column) * u[0];
  ((tau += Four(column + kPaddedChannels * (kLater + 1)) * u[kLater + 1]), ...);
  return tau;
}

/// The same, each input with the gains of its own mixer.
Mixer::Group Mixer::product_by_axis(const Inputs& u, std::size_t group,
                                    const Conditions& conditions) const {
  Group tau = Group::Zero();
  for (std::size_t i = 0; i < kAxes; ++i) {
    const bool primary = (conditions.primary_axes >> i & 1u) != 0;
    const float* gains = (primary ? primary_ : secondary_).data() + kPaddedChannels * i;
    tau += Eigen::Map<const Group, Eigen::Aligned16>(gains + kGroup * group) * u[i];
  }
  return tau;
}

void Mixer::motors_from_speed(const Conditions& conditions) {
  const float battery_V = voltage(conditions.battery_V);
  motor_model_failed_ = !config_.motor.usable() || !(battery_V >= kMinBattery_V);
  for (const std::size_t k : motors_) {
    const float speed_sq = std::max(mixed_[k], 0.0f);  // in this order a NaN is kept
    mixed_[k] = motor_model_failed_
                    ? 0.0f
                    : config_.motor.voltage_V(speed_sq, conditions.density_kg_m3) / battery_V;
  }
}

/// The measured voltage, limited to the range of a usable battery. Without BATT_VOLT_MAX there are no
/// limits.
float Mixer::voltage(float battery_V) {
  const float lowest_V = kMinVoltage * config_.motor.full_voltage_V;
  const float highest_V = kMaxVoltage * config_.motor.full_voltage_V;
  const bool too_low = battery_V < lowest_V || !std::isfinite(battery_V);
  const bool too_high = !too_low && battery_V > highest_V && highest_V > 0.0f;
  voltage_replaced_ = too_low || too_high;
  if (too_low) return lowest_V;
  return too_high ? highest_V : battery_V;
}

inline void Mixer::scale_motors() {
  float largest = 0.0f;
  for (std::size_t g = 0; g < groups_; ++g) {
    const Group size = (four(mixed_, g) * four(motor_, g)).abs();
    largest = std::max(largest, std::max(std::max(size[0], size[1]), std::max(size[2], size[3])));
  }
  saturation_ = largest;
  if (saturation_ <= 1.0f) return;
  const float scale = 1.0f / saturation_;
  for (const std::size_t k : motors_) mixed_[k] *= scale;
}

Mixer::MotorRange Mixer::motor_range() const {
  if (set_for_ == Mode::kDisarmed) return {0.0f, 0.0f};
  return {config_.spin_when_armed ? config_.idle_throttle : 0.0f,
          set_for_ == Mode::kHeldAtIdle ? config_.idle_throttle : 1.0f};
}

void Mixer::set_limits() {
  const MotorRange range = motor_range();
  for (const std::size_t k : motors_) {
    gain_[k] = 1.0f, centre_[k] = 0.0f, low_[k] = range.low, high_[k] = range.high;
  }
  for (const std::size_t k : servos_) {
    gain_[k] = 0.5f, centre_[k] = kServoCentre, low_[k] = 0.0f, high_[k] = 1.0f;
  }
}

/// Outputs of the mixer's own channels.
[[gnu::always_inline]] inline void Mixer::limit_mixed() {
  for (std::size_t g = 0; g < groups_; ++g) {
    four(outputs_, g) = (four(mixed_, g) * four(gain_, g) + four(centre_, g))
                            .max(four(low_, g))
                            .min(four(high_, g));
  }
  for (const std::size_t k : gpios_) {
    const bool commanded = auxiliary_.type[k] == static_cast<std::uint8_t>(link::AuxType::kServo);
    const float value = commanded ? auxiliary_.value[k] : mixed_[k];
    outputs_[k] = value >= hal::Outputs::kHighLevel ? 1.0f : 0.0f;
  }
}

[[gnu::always_inline]] inline void Mixer::begin_step(const Conditions& conditions) {
  Mode mode = Mode::kDisarmed;
  if (conditions.armed) mode = conditions.hold_idle ? Mode::kHeldAtIdle : Mode::kArmed;
  if (prepared_for_ != mode) prepare(mode, conditions);
}

[[gnu::always_inline]] inline const hal::OutputValues& Mixer::end_step(
    const Conditions& conditions) {
  if (!mixed_is_finite()) {
    mixed_.fill(0.0f);
    stop_motors();
    return outputs_;
  }
  limit_mixed();
  if (conditions.test_motor >= 0) turn_test_motor(conditions);
  return outputs_;
}

const hal::OutputValues& Mixer::step(const Inputs& u, const Conditions& conditions) {
  if (!valid_) return outputs_;
  begin_step(conditions);
  mix(u, conditions);
  return end_step(conditions);
}

const hal::OutputValues& Mixer::step_motors(const MotorCommands& commands,
                                            const Conditions& conditions) {
  if (!valid_) return outputs_;
  begin_step(conditions);
  mixed_.fill(0.0f);
  for (std::size_t k = 0; k < motors_.size && k < commands.size(); ++k) {
    mixed_[motors_.channel[k]] = commands[k];
  }
  motor_model_failed_ = voltage_replaced_ = false;
  saturation_ = 0.0f;
  return end_step(conditions);
}

/// Outputs that the mixer leaves to auxiliary commands.
void Mixer::fill_free_channels() {
  const MotorRange range = motor_range();
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
    if (k < kPaddedChannels) low_[k] = high_[k] = outputs_[k];  // limit_mixed() does not change it
  }
}

Mixer::Inputs Mixer::axis_limits(float density_kg_m3) const {
  constexpr float kRounding = 1.0001f;  // of the gains: full output is within the limits
  const bool by_speed = config_.use_motor_model && !config_.fixed_wing;
  const float motor_end =
      by_speed ? config_.motor.speed_sq_rad2_s2(config_.motor.full_voltage_V, density_kg_m3) : 1.0f;
  Inputs limits;
  limits.fill(std::numeric_limits<float>::max());
  for (std::size_t k = 0; k < kChannels; ++k) {
    if (!used_by_mixer(k)) continue;
    const float end = kRounding * (is_motor(k) ? motor_end : 1.0f);
    for (std::size_t i = 0; i < kAxes; ++i) {
      const float gain =
          std::abs(secondary_(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)));
      if (gain * limits[i] > end) limits[i] = end / gain;
    }
  }
  return limits;
}

float Mixer::thrust_fraction(const Inputs& u, float density_kg_m3) const {
  if (motors_.size == 0) return 0.0f;
  float total = 0.0f;
  for (const std::size_t k : motors_) {
    float value = 0.0f;
    for (std::size_t i = 0; i < kAxes; ++i) {
      value += secondary_(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) * u[i];
    }
    total += std::max(0.0f, value);
  }
  if (!config_.use_motor_model) return total / static_cast<float>(motors_.size);
  return total * config_.motor.thrust_gain(density_kg_m3) / std::max(config_.max_thrust_N, 1e-3f);
}

}  // namespace rosflight::core
