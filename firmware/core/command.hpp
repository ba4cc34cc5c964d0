// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <limits>

#include "firmware/core/rc.hpp"
#include "link/messages.hpp"

namespace rosflight::core {

inline constexpr std::size_t kAxes = link::kCommandAxes;

/// The meaning of one axis of the command vector.
enum class CommandType : std::uint8_t { kRate, kAngle, kThrottle, kPassThrough };

/// Ten axes: 0..2 force or throttle along x y z; 3..5 torque, angle or rate about x y z; 6..9 free.
struct CommandVector {
  std::array<float, kAxes> value{};
  std::array<CommandType, kAxes> type{CommandType::kThrottle,    CommandType::kThrottle,
                                      CommandType::kThrottle,    CommandType::kAngle,
                                      CommandType::kAngle,       CommandType::kRate,
                                      CommandType::kPassThrough, CommandType::kPassThrough,
                                      CommandType::kPassThrough, CommandType::kPassThrough};
  std::uint16_t active{0};  ///< Bit k: axis k carries a command.
  /// Axis k carries a command; k < kAxes.
  bool is_active(std::size_t k) const { return (active >> k & 1u) != 0; }
};

/// Why the pilot has control: bits of the override word, as in the status message.
namespace override_bit {
inline constexpr std::uint16_t kAttitudeSwitch = 0x001;
inline constexpr std::uint16_t kThrottleSwitch = 0x002;
inline constexpr std::uint16_t kStickRoll = 0x004;
inline constexpr std::uint16_t kStickPitch = 0x008;
inline constexpr std::uint16_t kStickYaw = 0x010;
inline constexpr std::uint16_t kMinThrottle = 0x020;
inline constexpr std::uint16_t kRollInactive = 0x040;
inline constexpr std::uint16_t kPitchInactive = 0x080;
inline constexpr std::uint16_t kYawInactive = 0x100;
inline constexpr std::uint16_t kThrottleInactive = 0x200;
inline constexpr std::uint16_t kThrottle = 0x222;  ///< Any of these: the pilot commands axes 0..2.
inline constexpr std::uint16_t kRoll = 0x045;      ///< Any of these: the pilot commands axis 3.
inline constexpr std::uint16_t kPitch = 0x089;
inline constexpr std::uint16_t kYaw = 0x111;
}  // namespace override_bit

/// Combines the pilot's sticks and the companion's commands, axis by axis, and holds the failsafe
/// command. The combination is computed at every receiver frame, every offboard command, and when a
/// timeout or a stick hold ends, so it is never older than one pass.
///
/// A multirotor in the air whose companion is silent keeps the last thrust, level, for OFFBOARD_HOLD.
/// With T the thrust in force, from stick or companion, and T_f that of FAILSAFE_THR, at which the vehicle
/// sinks slowly, it is
///
///     in the air      after T > T_f for 1 s, or when armed in the air                          (1)
///     on the ground   after T <= T_f / 2 for 1 s, when armed on the ground, or disarmed        (2)
///
/// A thrust of T_f / 2 or less is not kept: from there on no hold begins on a vehicle that has landed.
/// Between its touchdown and then, a hold prolongs what the companion commanded on the ground, which is
/// less than the weight unless it takes off again. No sensor is used: in a flight a barometer drifts by
/// more than the heights that matter here, and not every vehicle has a range sensor.
class CommandManager {
 public:
  /// For so long the thrust must satisfy (1) or (2).
  static constexpr Time kFlightChange = hal::milliseconds(1000);

  struct Config {
    bool fixed_wing{false};
    std::uint8_t throttle_axis{2};  ///< RC_F_AXIS: the axis, 0..2, of the throttle stick.
    bool angle_mode{true};  ///< Roll and pitch sticks command angles, unless a switch decides.
    bool type_switch_mapped{false};
    float max_roll_rad{0.786f}, max_pitch_rad{0.786f};
    float max_roll_rate_rad_s{3.14159f}, max_pitch_rate_rad_s{3.14159f}, max_yaw_rate_rad_s{1.507f};
    float max_throttle{0.7f};
    float stick_deviation{0.1f};
    Time stick_hold{hal::milliseconds(1000)};  ///< From the release of the stick.
    bool take_min_throttle{true};
    Time offboard_timeout{hal::milliseconds(100)};
    Time offboard_hold{};  ///< OFFBOARD_HOLD; 0: none.
    float failsafe_throttle{-1.0f};
    bool companion_in_failsafe{false};  ///< FAILSAFE_OFFBRD: see update().
    bool fixed_wing_holds{false};       ///< FW_ANGLE_HOLD: see hold_angles().
    /// The two mixers differ, so their axes may mean different things: an override then applies to
    /// all six axes or to none.
    bool override_whole{false};
  };

  /// Applies new settings and rebuilds the failsafe command.
  void configure(const Config& config);
  /// The failsafe throttle is usable (always, for fixed wings).
  bool failsafe_valid() const;

  /// Sets the largest magnitude of each axis that the companion may command in pass-through
  /// (Mixer::axis_limits).
  void set_axis_limits(const std::array<float, kAxes>& limits);

  /// Limits a command of the companion. Masked axes become 0, the others are limited by their type:
  ///
  ///     throttle      0..1
  ///     angle, rate   the maximum of the sticks, of either sign
  ///     pass-through  the limits of set_axis_limits(), of either sign
  ///
  /// @returns false for an unknown mode or a value that is not finite; the command is then rejected.
  bool admit(link::OffboardControl& command);
  /// The last command that admit() limited.
  struct Limited {
    std::uint32_t count{0};  ///< Commands with a limited axis, since start.
    std::uint8_t axis{0};    ///< The first limited axis of the newest such command ...
    float requested{0.0f};   ///< ... its value ...
    float used{0.0f};        ///< ... and the limit.
  };
  const Limited& limited() const { return limited_; }

  /// Sets what the throttle of the pilot and of the failsafe is multiplied with, up to 1.
  /// A command of the companion is taken as it is; while it is held after the companion fell silent, it follows the factor.
  /// @param factor  1 or more.
  void set_throttle_factor(float factor);

  /// Stores an admitted command. Masked axes are inactive; after the timeout, and the hold if there
  /// is one, all are. An inactive axis follows the pilot, or is 0 where the pilot has no command for
  /// it.
  /// @param thrust_fraction  total thrust of the command, 0..1 of the motors' maximum; used only in
  ///                         pass-through, where the axes do not show it.
  void take_offboard(Time now, const link::OffboardControl& command, float thrust_fraction);
  /// admit() and take_offboard(). @returns the result of admit(); if false nothing changed.
  bool set_offboard(Time now, const link::OffboardControl& command, float thrust_fraction);
  /// Discards every offboard command, as on arming on the ground.
  void forget_offboard();

  /// From now on the motors turn. @param in_air  the vehicle is in the air already.
  void arm(Time now, bool in_air);
  /// From now on the vehicle counts as on the ground.
  void disarm();

  /// Once per pass. While the receiver is lost (`failsafe`) the failsafe command is in force. With
  /// companion_in_failsafe the companion goes on instead, as long as its roll, pitch, yaw and
  /// throttle are active and the pilot commanded none of them when the receiver fell silent; the
  /// last position of his throttle stick does not count.
  /// @param new_input  `pilot` changed.
  /// @returns true if the override word changed.
  bool update(Time now, const PilotInput& pilot, bool new_input, bool failsafe);

  const CommandVector& combined() const { return combined_; }
  const CommandVector& pilot() const { return pilot_; }
  std::uint16_t override_word() const { return override_; }
  /// Any of the offboard axes 0..5 is in force.
  bool offboard_active() const { return (offboard_.active & 0x3Fu) != 0; }
  /// Bit k: axis k comes from the pilot or the failsafe, and uses the primary mixer.
  std::uint16_t primary_axes() const { return primary_axes_; }
  /// The failsafe command is in force.
  bool in_failsafe() const { return in_failsafe_; }
  /// By (1) and (2); always false while disarmed.
  bool in_air() const { return in_air_; }

 private:
  struct StickHold {
    Time released{};
    bool ever{false};
    bool deviated(Time now, float stick, const Config& config);
  };

  void interpret(const PilotInput& pilot);
  float corrected(float throttle) const;
  std::uint16_t override_now(Time now, const PilotInput& pilot);
  bool pilot_wants_less_thrust() const;
  float torque_share() const;
  void combine();
  void hold_angles();
  float thrust(const CommandVector& command) const;
  float sinking_thrust() const;
  void watch_flight(Time now);
  bool may_hold(bool failsafe) const;
  void hold_level();

  static constexpr std::size_t kModes = 3;
  using Limits = std::array<float, kAxes>;
  static constexpr Limits no_limits() {
    constexpr float kNone = std::numeric_limits<float>::max();
    return {kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone};
  }

  Config config_{};
  std::array<Limits, kModes> offboard_limits_{no_limits(), no_limits(), no_limits()};  ///< By mode.
  Limited limited_{};
  CommandVector pilot_{};
  CommandVector offboard_{};
  CommandVector failsafe_{};
  CommandVector combined_{};
  std::array<StickHold, 3> holds_{};
  Time offboard_time_{};
  Time decide_at_{};      ///< Next time at which a timeout or a hold ends.
  Time flight_agreed_{};  ///< When the thrust in force last agreed with in_air_.
  float throttle_factor_{1.0f};
  float offboard_throttle_{0.0f};  ///< The last one commanded, also if masked or timed out since.
  float offboard_thrust_fraction_{0.0f};
  std::uint16_t override_{0};
  std::uint16_t primary_axes_{0x3FF};
  /// The last throttle of a silent companion and throttle_factor_ then; a factor of 0: none is held.
  struct Held {
    float throttle{0.0f}, factor{0.0f};
  } held_{};
  bool offboard_new_{false};
  bool in_failsafe_{false};
  bool decided_{false};
  bool armed_{false};
  bool in_air_{false};
};

}  // namespace rosflight::core
