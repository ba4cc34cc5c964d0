// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <limits>

#include "firmware/core/rc.hpp"
#include "link/messages.hpp"

namespace rosflight::core {

inline constexpr std::size_t kEntries = link::kCommandEntries;

/// How an entry of the command vector is to be taken.
enum class CommandType : std::uint8_t { kRate, kAngle, kThrottle, kPassThrough };

/// Ten entries: 0..2 force or throttle x y z, 3..5 torque, angle or rate about x y z, 6..9 free.
struct CommandVector {
  std::array<float, kEntries> value{};
  std::array<CommandType, kEntries> type{CommandType::kThrottle,    CommandType::kThrottle,
                                         CommandType::kThrottle,    CommandType::kAngle,
                                         CommandType::kAngle,       CommandType::kRate,
                                         CommandType::kPassThrough, CommandType::kPassThrough,
                                         CommandType::kPassThrough, CommandType::kPassThrough};
  std::uint16_t active{0};  ///< Bit k: entry k is meant.
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
inline constexpr std::uint16_t kThrottle = 0x222;  ///< Any of these: entries 0..2 are the pilot's.
inline constexpr std::uint16_t kRoll = 0x045;      ///< Any of these: entry 3 is.
inline constexpr std::uint16_t kPitch = 0x089;
inline constexpr std::uint16_t kYaw = 0x111;
}  // namespace override_bit

/// Decides who flies: combines the pilot's sticks and the companion's commands, entry by entry, and
/// holds the failsafe command. Decides anew at every receiver frame and offboard command and at the
/// moment a time-out or hold ends, so the answer is never older than one pass.
class CommandManager {
 public:
  struct Config {
    bool fixed_wing{false};
    std::uint8_t throttle_entry{
        2};                 ///< RC_F_AXIS: which of entries 0..2 the throttle stick drives.
    bool angle_mode{true};  ///< Stick roll and pitch are angles unless a switch decides.
    bool type_switch_mapped{false};
    float max_roll_rad{0.786f}, max_pitch_rad{0.786f};
    float max_roll_rate_rad_s{3.14159f}, max_pitch_rate_rad_s{3.14159f}, max_yaw_rate_rad_s{1.507f};
    float max_throttle{0.7f};
    float stick_deviation{0.1f};
    Time stick_hold{hal::milliseconds(1000)};  ///< From the release of the stick.
    bool take_min_throttle{true};
    Time offboard_timeout{hal::milliseconds(100)};
    float failsafe_throttle{-1.0f};
    /// The two mixers differ, so their entries may mean different things: any override then takes
    /// all six entries, or none.
    bool override_whole{false};
  };

  /// Takes new settings and rebuilds the failsafe command.
  void configure(const Config& config);
  /// The failsafe throttle is usable (always, for fixed wings).
  bool failsafe_valid() const;

  /// The largest magnitude of each entry that the companion may command in pass-through
  /// (Mixer::entry_limits).
  void set_entry_limits(const std::array<float, kEntries>& limits);

  /// A command of the companion before it is used: entries masked out become 0, the others are
  /// limited by their type,
  ///
  ///     throttle      0..1
  ///     angle, rate   the largest that the sticks can command, of either sign
  ///     pass-through  the limits of set_entry_limits(), of either sign
  ///
  /// @returns false for an unknown mode or a value that is not finite: to be refused whole.
  bool admit(link::OffboardControl& command);
  /// What admit() last limited.
  struct Limited {
    std::uint32_t count{0};  ///< Commands with a limited entry, since start.
    std::uint8_t entry{0};   ///< The first of the newest such command ...
    float asked{0.0f};
    float used{0.0f};
  };
  const Limited& limited() const { return limited_; }

  /// Takes an admitted command. Entries masked out are inactive, as all are after the time-out. An
  /// inactive entry is the pilot's, or 0 where the pilot has none.
  /// @param thrust_fraction  total thrust it asks for, 0..1 of what the motors can give; used only
  /// in
  ///                         pass-through, where the entries do not tell.
  void take_offboard(Time now, const link::OffboardControl& command, float thrust_fraction);
  /// Both in one. @returns what admit() returns; if false nothing changed.
  bool set_offboard(Time now, const link::OffboardControl& command, float thrust_fraction);
  /// As if the companion had never commanded anything: what came before an arming on the ground
  /// does not count after it.
  void forget_offboard();

  /// Once per pass. @param new_input  `pilot` changed.
  /// @returns true if the override word changed.
  bool update(Time now, const PilotInput& pilot, bool new_input, bool failsafe);

  const CommandVector& combined() const { return combined_; }
  const CommandVector& pilot() const { return pilot_; }
  std::uint16_t override_word() const { return override_; }
  /// Some of the offboard entries 0..5 is in force.
  bool offboard_active() const { return (offboard_.active & 0x3Fu) != 0; }
  /// Entries (bits) that come from the pilot or the failsafe: they use the primary mixer.
  std::uint16_t primary_entries() const { return primary_entries_; }
  bool in_failsafe() const { return in_failsafe_; }

 private:
  struct StickHold {
    Time released{};
    bool ever{false};
    bool deviated(Time now, float stick, const Config& config);
  };

  void interpret(const PilotInput& pilot);
  std::uint16_t override_now(Time now, const PilotInput& pilot);
  bool pilot_wants_less_thrust() const;
  float torque_share() const;
  void combine();

  static constexpr std::size_t kModes = 3;
  using Limits = std::array<float, kEntries>;
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
  Time decide_at_{};               ///< Next moment at which time alone changes something.
  float offboard_throttle_{0.0f};  ///< The last one commanded, masked or timed out since or not.
  float offboard_thrust_fraction_{0.0f};
  std::uint16_t override_{0};
  std::uint16_t primary_entries_{0x3FF};
  bool offboard_new_{false};
  bool in_failsafe_{false};
  bool decided_{false};
};

}  // namespace rosflight::core
