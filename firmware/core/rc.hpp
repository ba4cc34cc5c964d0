// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>

#include "firmware/core/log.hpp"
#include "firmware/hal/samples.hpp"

namespace rosflight::core {

enum class Switch : std::uint8_t { kArm, kAttitudeOverride, kThrottleOverride, kAttitudeType };
inline constexpr std::size_t kSwitchCount = 4;

/// The pilot's controls. Throttle 0..1, the others -1..1, none of them clipped.
struct PilotInput {
  float roll{0.0f};
  float pitch{0.0f};
  float yaw{0.0f};
  float throttle{0.0f};
  std::array<bool, kSwitchCount> on{};  ///< Unmapped switches are off.
  /// The switch is mapped and on.
  bool is_on(Switch s) const { return on[static_cast<std::size_t>(s)]; }
};

/// Interprets receiver frames: validity, sticks, switches, and requests to arm or disarm.
///
/// A frame is bad if it carries a loss flag, if it lacks the channel of a stick, or if one of the
/// sticks or of its first `channel_count` channels is outside -0.25..1.25; it then changes nothing.
/// A switch on a channel that the frame lacks is unmapped in that frame. The radio counts as lost
///     at once         if the receiver sets its failsafe flag,
///     after 100 ms    of bad frames only, counted from the last good one,
///     after 200 ms    without any good frame (unplugged receiver).
///
/// An arm switch requests arming with the first frame in which it is on. It requests disarming, and
/// permits another arming, when it was off for 100 ms: in every good frame of that time, at least
/// three. Bad frames in between are ignored; an outage of 100 ms restarts the count. Switches are not
/// read from a frame with fewer channels than another of the last 100 ms.
class Rc {
 public:
  static constexpr Time kOffTime = hal::milliseconds(100);
  static constexpr std::uint8_t kOffFrames = 3;
  static constexpr Time kBadFramesUntilLost = hal::milliseconds(100);
  static constexpr Time kSilenceUntilLost = hal::milliseconds(200);
  static constexpr Time kGestureTime = hal::milliseconds(1000);

  struct Config {
    std::uint8_t channel_count{6};  ///< Checked for validity; switches must lie below.
    std::uint8_t roll{0}, pitch{1}, throttle{2}, yaw{3};  ///< Channels of the sticks, below 24.
    std::array<std::uint8_t, kSwitchCount> switch_channel{255, 4, 4, 255};
    std::array<std::int8_t, 4> direction{1, 1, 1, 1};  ///< Channels 4..7; negative reverses.
    float arm_threshold{0.15f};
  };

  struct Update {
    bool frame{};   ///< `input()` is new.
    bool found{};   ///< A good frame: the radio is there.
    bool lost{};    ///< The radio is gone.
    bool arm{};     ///< The pilot asks to arm ...
    bool disarm{};  ///< ... or to disarm.
  };

  /// An arm switch on another channel or reversed has to be off for kOffTime before it can arm; after a change of the gesture the yaw stick
  /// has to be inside its threshold before sticks can arm or disarm: no change of parameters alone arms.
  void configure(const Config& config);
  /// The switch has a channel.
  bool mapped(Switch s) const;
  /// Says on which channel each switch is, one text each.
  void describe(Log& log) const;

  /// Once per pass, with a frame or without (nullptr).
  /// @param may_disarm  the stick gesture looked for is that of disarming, else that of arming.
  Update step(Time now, const hal::RcFrame* frame, bool may_disarm);

  /// No good frame for so long that the radio counts as lost; step() reports it without a frame.
  bool silent(Time now) const { return now - last_good_ >= kSilenceUntilLost; }

  const PilotInput& input() const { return input_; }
  bool throttle_low() const { return input_.throttle < config_.arm_threshold; }
  /// There is an arm switch and it is off.
  bool arm_switch_off() const { return by_switch_ && !input_.is_on(Switch::kArm); }

 private:
  bool good(const hal::RcFrame& frame) const;
  bool carries(const hal::RcFrame& frame, Switch s) const;
  bool shortened(Time now, const hal::RcFrame& frame);
  bool read_switch(const hal::RcFrame& frame, Switch s) const;
  void look_for_gesture(Time step, bool may_disarm, Update& update);
  void look_at_arm_switch(Time now, Update& update);
  void forget_arm_switch();

  Config config_{};
  PilotInput input_{};
  Time last_good_{};
  Time gesture_{};                     ///< How long the sticks have been in the corner.
  Time off_since_{};                   ///< First of the consecutive frames with the switch off.
  std::uint8_t off_frames_{0};         ///< Their number, up to kOffFrames.
  bool arm_switch_was_off_{false};     ///< For kOffTime: on may arm.
  bool yaw_was_inside_{true};          ///< Since the last change of the gesture.
  bool received_{false};               ///< A good frame came since boot.
  bool by_switch_{false};              ///< Arming is by switch: the receiver carries its channel.
  Time complete_{};                    ///< When the last frame that was not shortened came.
  std::uint8_t complete_channels_{0};  ///< Its number of channels.
};

}  // namespace rosflight::core
