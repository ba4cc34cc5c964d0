// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <utility>

#include "base/eigen.hpp"
#include "firmware/core/command.hpp"
#include "firmware/core/math.hpp"
#include "firmware/core/motor_model.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::core {

inline constexpr std::size_t kChannels = 10;  ///< Output channels a mixer drives.

enum class OutputType : std::uint8_t { kAux = 0, kServo = 1, kMotor = 2, kGpio = 3 };

/// Gains K of one mixer, channel by input: tau_j = sum_i K(j, i) u_i. For multirotors K is the
/// pseudo-inverse of the matrix M of what each actuator contributes to each force and torque. Two
/// rows of zeros complete a column to three groups of four channels, one vector register each.
inline constexpr std::size_t kGroup = 4;
inline constexpr std::size_t kPaddedChannels = 12;
using MixerGains = Eigen::Matrix<float, kPaddedChannels, kAxes>;

/// Kind and pulse rate of each channel; the primary mixer's serves both.
struct MixerHeader {
  std::array<OutputType, kChannels> type{};
  hal::OutputRates rate_hz{};
};

/// Distributes forces and torques over the actuators and limits the outputs.
///
/// Per IMU sample, with the primary gains for the inputs of the pilot and the secondary gains for
/// those of the companion:
///
///     multirotor             tau_j = sum_i K(j, i) u_i                                   (1)
///     with motor parameters  tau_j = V(max(0, sum_i K(j, i) u_i)) / V_battery            (2)
///     motors                 tau_j <- tau_j / max(1, max |tau|)                          (3)
///     fixed wing             (1) with aileron, elevator, rudder reversed on request, without (3)
///
/// V() is MotorModel::voltage_V, V_battery within kMinVoltage and kMaxVoltage of the full battery.
/// Below the idle throttle the yaw torque is left out, since it alone could start motors. Then
/// auxiliary commands set the channels that the mixer leaves free, and every channel is limited by
/// its type. A channel of type GPIO is low or high: an auxiliary command of type servo for it is compared with
/// one half, without one what the mixer makes of it. A NaN or an infinity in any of them stops all motors for that pass; the other outputs
/// keep their value, and a servo without a command its centre.
///
/// An auxiliary motor turns on a command that was received while armed, and only while the mixer is
/// armed, the radio is present and the companion sends frames. When one of these ends, the motor
/// stops and its command is discarded: a new one is needed. Owns 1.2 kB.
class Mixer {
 public:
  using Inputs = std::array<float, kAxes>;
  using MotorCommands = std::array<float, 4>;
  static constexpr std::uint16_t kAllAxes = 0x3FF;
  /// Largest output of a motor test.
  static constexpr float kTestLimit = 0.3f;

  struct Config {
    bool fixed_wing{false};
    bool reverse_aileron{false}, reverse_elevator{false}, reverse_rudder{false};
    bool use_motor_model{false};
    bool spin_when_armed{true};
    bool unsigned_throttle{false};  ///< ESC calibration: full range for either sign of throttle.
    float idle_throttle{0.1f};
    std::uint8_t throttle_axis{2};
    float max_thrust_N{1.0f};
    MotorModel motor{};
  };

  /// Everything besides the inputs that the outputs depend on.
  struct Conditions {
    float density_kg_m3{kSeaLevelDensity_kg_m3};
    float battery_V{0.0f};
    bool armed{false};                     ///< Motors may turn.
    std::uint16_t primary_axes{kAllAxes};  ///< Bit i: input i goes through the primary gains.
    bool hold_idle{false};          ///< Just after arming: motors do not exceed the idle throttle.
    bool failsafe{false};           ///< The pilot's radio is lost.
    bool companion_present{false};  ///< A frame was received within the last second.
    std::int8_t test_motor{-1};     ///< Disarmed: this motor of the mixer turns alone; -1 none.
    float test_value{0.0f};         ///< Its output, 0..kTestLimit.
  };

  /// Applies new settings from the next step on.
  void configure(const Config& config) {
    config_ = config;
    invalidate();
  }
  const Config& config() const { return config_; }

  /// A mixer is in force; without one all outputs stay at zero.
  bool valid() const { return valid_; }
  /// See valid().
  void set_valid(bool valid) { valid_ = valid; }

  /// Sets kinds and rates; a channel whose kind changes starts without a command.
  void set_header(const MixerHeader& header);
  const MixerHeader& header() const { return header_; }
  MixerGains& primary() { return primary_; }
  const MixerGains& primary() const { return primary_; }
  MixerGains& secondary() { return secondary_; }
  const MixerGains& secondary() const { return secondary_; }
  /// Both mixers have the same gains, so their inputs mean the same.
  bool mixers_agree() const { return primary_ == secondary_; }

  /// The mixer drives a motor on this channel, so a motor test may turn it.
  bool is_motor(std::size_t channel) const {
    return channel < kChannels && header_.type[channel] == OutputType::kMotor;
  }
  /// The mixer that calibrates speed controllers: the stick drives all motors from 0 to 1.
  bool calibrates_escs() const { return config_.unsigned_throttle; }

  /// Stores an auxiliary command, in force until the next (motors: see above). @returns false and
  /// changes nothing if a type is unknown or a value of an enabled channel is not finite.
  bool set_auxiliary(const link::AuxCommand& command);
  /// An auxiliary motor is commanded, so failsafe and companion_present have an effect.
  bool has_auxiliary_motors() const { return auxiliary_motors_; }
  /// Discards the motors of the auxiliary command and stops them; servos keep their value.
  void drop_auxiliary_motors();
  /// drop_auxiliary_motors() unless armed, with a radio and a companion. step() includes it, but a
  /// condition may end and hold again before the next IMU sample: call it once per pass while a
  /// motor is commanded. @returns whether it dropped them.
  bool end_auxiliary_motors(const Conditions& conditions);

  /// All 14 outputs, 0..1.
  const hal::OutputValues& step(const Inputs& u, const Conditions& conditions);

  /// Motors that the mixer drives.
  std::size_t motor_count() const { return motors_.size; }
  /// As step(), with commands for its first four motors, in the order of their channels, in place of (1) to (3). Limits, conditions
  /// and what a NaN does are the same; servos of the mixer stay at their centre.
  const hal::OutputValues& step_motors(const MotorCommands& commands, const Conditions& conditions);

  const hal::OutputValues& outputs() const { return outputs_; }
  /// Outputs as without any command: servos at their centre, all others at zero.
  void clear_outputs();
  /// Sets every channel that drives a motor to zero; the others keep their value.
  void stop_motors();
  /// Result after (3), before limits; for logs.
  const std::array<float, kPaddedChannels>& mixed() const { return mixed_; }
  /// Largest motor value before (3); above 1 the command exceeds the actuators.
  float saturation() const { return saturation_; }
  /// The outputs do not produce the commanded forces: they are at a limit or motors are held at idle.
  bool saturated() const { return saturation_ > 1.0f || set_for_ == Mode::kHeldAtIdle; }
  /// (2) is configured without a usable motor model.
  bool motor_model_failed() const { return motor_model_failed_; }
  /// (2) used the lowest voltage instead of the measured one.
  bool voltage_replaced() const { return voltage_replaced_; }

  /// For each input alone, the largest magnitude that still changes an output of the secondary gains:
  /// it drives the first actuator to its limit. With motor parameters the limit of a motor is its
  /// speed on a full battery. An unused input has no limit.
  /// @param density_kg_m3  of the air.
  Inputs axis_limits(float density_kg_m3) const;

  /// Total thrust of an offboard vector through the secondary gains, as a fraction of the motors'
  /// maximum.
  float thrust_fraction(const Inputs& u, float density_kg_m3) const;

 private:
  /// Channels of one kind, so that a pass need not test kinds.
  struct ChannelList {
    std::array<std::uint8_t, hal::kOutputs> channel{};
    std::uint8_t size{0};
    const std::uint8_t* begin() const { return channel.data(); }
    const std::uint8_t* end() const { return channel.data() + size; }
    void add(std::size_t k) { channel[size++] = static_cast<std::uint8_t>(k); }
  };

  using Group = Eigen::Array<float, kGroup, 1>;
  using Padded = std::array<float, kPaddedChannels>;
  /// Selects the limits of the motors.
  enum class Mode : std::uint8_t { kDisarmed, kHeldAtIdle, kArmed, kNone };

  static bool all_secondary(const Inputs& u, std::uint16_t primary_axes);
  void begin_step(const Conditions& conditions);
  const hal::OutputValues& end_step(const Conditions& conditions);
  void mix(const Inputs& u, const Conditions& conditions);
  template <std::size_t... kLater>
  static Group product(const MixerGains& gains, const Inputs& u, std::size_t group,
                       std::index_sequence<kLater...>);
  Group product_by_axis(const Inputs& u, std::size_t group, const Conditions& conditions) const;
  void motors_from_speed(const Conditions& conditions);
  void scale_motors();
  bool mixed_is_finite() const;
  bool used_by_mixer(std::size_t channel) const {
    return channel < kChannels && header_.type[channel] != OutputType::kAux;
  }
  void limit_mixed();
  void invalidate() {
    stale_ = true;
    prepared_for_ = Mode::kNone;
  }
  void prepare(Mode mode, const Conditions& conditions);
  void set_limits();
  void fill_free_channels();
  void turn_test_motor(const Conditions& conditions);
  struct MotorRange {
    float low;
    float high;
  };
  MotorRange motor_range() const;
  float voltage(float battery_V);

  Config config_{};
  MixerHeader header_{};
  MixerGains primary_{MixerGains::Zero()};
  MixerGains secondary_{MixerGains::Zero()};
  alignas(16) Padded mixed_{};
  alignas(16) Padded used_{};   ///< 1 for channels of the mixer, 0 for free ones.
  alignas(16) Padded motor_{};  ///< 1 for motors, 0 for others.
  alignas(16) Padded gain_{};   ///< Output of a channel: clamp(gain x mixed + centre, low, high).
  alignas(16) Padded centre_{};
  alignas(16) Padded low_{};
  alignas(16) Padded high_{};
  std::uint8_t groups_{0};  ///< Up to the last channel that the mixer uses.
  ChannelList motors_, servos_, gpios_, free_;
  alignas(16) hal::OutputValues outputs_{};
  link::AuxCommand auxiliary_{};
  std::uint16_t was_servo_{0};  ///< Bit per output: idles at its centre once released.
  float saturation_{0.0f};
  bool motor_model_failed_{false};
  bool voltage_replaced_{false};
  bool valid_{false};
  bool auxiliary_motors_{false};    ///< auxiliary_ drives one.
  bool stale_{true};                ///< Limits and outputs of free_ must be set again.
  Mode set_for_{Mode::kDisarmed};   ///< They were set for this.
  Mode prepared_for_{Mode::kNone};  ///< prepare() has nothing to do while this is the mode.
};

}  // namespace rosflight::core
