// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <utility>

#include "firmware/core/command.hpp"
#include "firmware/core/motor_model.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::core {

inline constexpr std::size_t kChannels = 10;  ///< Output channels a mixer drives.

enum class OutputType : std::uint8_t { kAux = 0, kServo = 1, kMotor = 2, kGpio = 3 };

/// Gains K of one mixer, channel by input: tau_j = sum_i K(j, i) u_i. For multirotors K is the
/// pseudo-inverse of the matrix M that says what each actuator adds to each force and torque. Two
/// rows of zeros make a column three groups of four channels, one vector register each.
inline constexpr std::size_t kGroup = 4;
inline constexpr std::size_t kPaddedChannels = 12;
using MixerGains = Eigen::Matrix<float, kPaddedChannels, kEntries>;

/// Kind and pulse rate of each channel; the primary mixer's serves both.
struct MixerHeader {
  std::array<OutputType, kChannels> type{};
  hal::OutputRates rate_hz{};
};

/// Distributes forces and torques over the actuators, and limits what reaches the pins.
///
/// Per IMU sample: for every input the primary or the secondary gains (by who commands that input),
/// then
///
///     multirotor             tau_j = sum_i K(j, i) u_i                                   (1)
///     with motor parameters  tau_j = V(max(0, sum_i K(j, i) u_i)) / V_battery            (2)
///     motors                 tau_j <- tau_j / max(1, max |tau|)                          (3)
///     fixed wing             (1) with aileron, elevator, rudder reversed on request, no (3)
///
/// V() is MotorModel::voltage_V. Below the idle throttle the yaw torque is dropped, since yaw alone
/// could start motors. Then auxiliary commands fill what the mixer leaves free, and every channel
/// is limited by its type. NaN or infinity anywhere stops all motors for that pass; the other
/// outputs keep what they had, a servo that has had no command yet its centre.
///
/// An auxiliary motor runs on a command that came while the mixer was armed, and only as long as
/// the mixer stays armed, the pilot's radio is there and the companion sends frames. When one of
/// these ends the motor stops and the command is forgotten: a new one has to come. Owns 1.2 kB.
class Mixer {
 public:
  using Inputs = std::array<float, kEntries>;
  static constexpr std::uint16_t kAllEntries = 0x3FF;
  /// Largest output of a motor test.
  static constexpr float kTestLimit = 0.3f;
  /// Range of the voltage in (2), as fractions of that of the full battery: no sensor failure can
  /// ask for more than 1/0.6 of the right throttle, or for less than 0.6/1.1.
  static constexpr float kLowestVoltage = 0.6f;
  static constexpr float kHighestVoltage = 1.1f;

  struct Config {
    bool fixed_wing{false};
    bool reverse_aileron{false}, reverse_elevator{false}, reverse_rudder{false};
    bool use_motor_model{false};
    bool spin_when_armed{true};
    bool unsigned_throttle{
        false};  ///< ESC calibration: full range whatever the sign of the throttle.
    float idle_throttle{0.1f};
    std::uint8_t throttle_entry{2};
    float max_thrust_N{1.0f};
    MotorModel motor{};
  };

  /// What else the mix depends on.
  struct Conditions {
    float density_kg_m3{1.225f};
    float battery_V{0.0f};
    bool armed{false};                           ///< Motors may turn.
    std::uint16_t primary_entries{kAllEntries};  ///< Bit i: input i goes through the primary gains.
    bool hold_idle{false};  ///< Motors turn at the idle throttle at most, just after arming.
    bool failsafe{false};   ///< The pilot's radio is lost.
    bool companion_present{false};  ///< A frame of the companion came during the last second.
    std::int8_t test_motor{-1};     ///< Disarmed: this motor of the mixer turns alone; -1 none.
    float test_value{0.0f};         ///< Its output, 0..kTestLimit.
  };

  void configure(const Config& config) {
    config_ = config;
    invalidate();
  }
  const Config& config() const { return config_; }

  /// A mixer is in force; without one all outputs stay at zero.
  bool valid() const { return valid_; }
  void set_valid(bool valid) { valid_ = valid; }

  void set_header(const MixerHeader& header);
  const MixerHeader& header() const { return header_; }
  MixerGains& primary() { return primary_; }
  const MixerGains& primary() const { return primary_; }
  MixerGains& secondary() { return secondary_; }
  const MixerGains& secondary() const { return secondary_; }
  /// The same gains in both: their inputs mean the same.
  bool mixers_agree() const { return primary_ == secondary_; }

  /// The mixer drives a motor on this channel: what a motor test may turn.
  bool is_motor(std::size_t channel) const {
    return channel < kChannels && header_.type[channel] == OutputType::kMotor;
  }
  /// The mixer that calibrates speed controllers: the stick drives all motors from 0 to 1.
  bool calibrates_escs() const { return config_.unsigned_throttle; }

  /// Stores an auxiliary command, in force until the next; motors see above. @returns false, and
  /// changes nothing, if a type is unknown or a value of an enabled channel is not finite.
  bool set_auxiliary(const link::AuxCommand& command);
  /// An auxiliary motor is commanded: failsafe and companion_present matter.
  bool has_auxiliary_motors() const { return auxiliary_motors_; }
  /// Forgets motors of the auxiliary command and stops them; servos hold.
  void drop_auxiliary_motors();
  /// The same unless armed, with a radio and a companion. step() does it too, but a condition may
  /// end and hold again before the next IMU sample: call it once a pass while a motor is commanded.
  /// @returns whether it dropped them.
  bool end_auxiliary_motors(const Conditions& conditions);

  /// All 14 outputs, 0..1.
  const hal::OutputValues& step(const Inputs& u, const Conditions& conditions);

  const hal::OutputValues& outputs() const { return outputs_; }
  /// As without any command: servos at their centre, everything else at zero.
  void clear_outputs();
  /// Zero on every channel that drives a motor; the others hold.
  void stop_motors();
  /// Result after (3), before limits; for logs.
  const std::array<float, kPaddedChannels>& mixed() const { return mixed_; }
  /// Largest motor value before (3); above 1 the command did not fit.
  float saturation() const { return saturation_; }
  /// The actuators do not give what was asked for: too much of it, or motors are held at idle.
  bool saturated() const { return saturation_ > 1.0f || set_for_ == Mode::kHeldAtIdle; }
  /// (2) was asked for without a usable motor model.
  bool motor_model_failed() const { return motor_model_failed_; }
  /// (2) took the lowest voltage instead of the measured one.
  bool voltage_replaced() const { return voltage_replaced_; }

  /// The largest magnitude of each input that the secondary gains turn into different outputs when
  /// it is the only one: what drives the first actuator to its end. Motors with motor parameters
  /// end at the speed that the full battery gives. An input that nothing uses has no limit.
  Inputs entry_limits(float density_kg_m3) const;

  /// Total thrust an offboard vector asks for through the secondary gains, as a fraction of what
  /// the motors can give together.
  float thrust_fraction(const Inputs& u, float density_kg_m3) const;

 private:
  /// Channels of one kind, so that a pass need not look at the kinds.
  struct ChannelList {
    std::array<std::uint8_t, hal::kOutputs> channel{};
    std::uint8_t size{0};
    const std::uint8_t* begin() const { return channel.data(); }
    const std::uint8_t* end() const { return channel.data() + size; }
    void add(std::size_t k) { channel[size++] = static_cast<std::uint8_t>(k); }
  };

  using Group = Eigen::Array<float, kGroup, 1>;
  using Padded = std::array<float, kPaddedChannels>;
  /// What the limits of the motors depend on.
  enum class Mode : std::uint8_t { kDisarmed, kHeldAtIdle, kArmed, kNone };

  static bool all_secondary(const Inputs& u, std::uint16_t primary_entries);
  void mix(const Inputs& u, const Conditions& conditions);
  template <std::size_t... kLater>
  static Group product(const MixerGains& gains, const Inputs& u, std::size_t group,
                       std::index_sequence<kLater...>);
  Group product_by_entry(const Inputs& u, std::size_t group, const Conditions& conditions) const;
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
