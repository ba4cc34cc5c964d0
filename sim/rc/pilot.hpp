// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "sim/modules.hpp"
#include "sim/sample_clock.hpp"

/// A pilot with a radio, controlled by a script and by calls.
namespace rosflight::sim::rc {

/// The controls of the transmitter. Sticks: 0..1, middle 0.5; roll right, stick back (nose up),
/// throttle up and yaw right are 1. Switches: 0 off, 1 on.
enum class Control : std::uint8_t {
  kRoll,
  kPitch,
  kThrottle,
  kYaw,
  kArm,
  kAttitudeOverride,
  kThrottleOverride,
  kAttitudeMode,  ///< On: sticks command angles, off: rates.
};
inline constexpr std::size_t kControls = 8;
inline constexpr std::array<std::string_view, kControls> kControlNames{
    "roll",         "pitch", "throttle", "yaw", "arm", "attitude_override", "throttle_override",
    "attitude_mode"};

/// Receiver channel of each control, -1 for none; two switches may share one. The defaults are the
/// channels of the ROSflight 2.x simulator's pilot: arm 4, both overrides 5, attitude mode 6.
struct ChannelMap {
  std::array<int, kControls> channel{0, 1, 2, 3, 4, 5, 5, 6};

  int& operator[](Control control) { return channel[static_cast<std::size_t>(control)]; }
  int operator[](Control control) const { return channel[static_cast<std::size_t>(control)]; }
};

/// One thing that happens at a time.
struct Event {
  enum class Kind : std::uint8_t { kMove, kSilence, kFrameLost, kFailsafe };
  Time at{};
  Kind kind{Kind::kMove};
  int channel{};      ///< kMove.
  float to{};         ///< kMove: where the channel goes ...
  Time over{};        ///< ... in this time, at constant speed; 0: at once.
  bool begins{true};  ///< The other kinds: begin or end.
};

struct Script {
  Timing timing{.enabled = true, .period = Time{20'000}, .phase = {}, .delay = {}};  ///< 50 Hz.
  int channel_count{8};
  ChannelMap channels;
  /// Positions at start: sticks in the middle, throttle down, switches off.
  std::array<float, hal::RcFrame::kMaxChannels> start{0.5F, 0.5F, 0.0F, 0.5F};
  std::vector<Event> events;  ///< In order of time.
};

/// Sends a frame every period. Events of the script and calls take effect in the next frame; the last
/// one that moved a channel counts. In a frame with one of the flags the channels repeat the last good
/// frame, as receivers do.
class Pilot : public RcModule {
 public:
  /// @param script  its events must be in order of time.
  explicit Pilot(Script script = {});
  bool step(Time t, hal::RcFrame& frame) override;

  /// Moves a control to 0..1, at once or at constant speed in a time that starts with the next
  /// frame.
  /// @returns false if it has no channel.
  bool set(Control control, float to, Time over = Time{0});
  /// Moves a switch at once. @returns false if it has no channel.
  bool set_switch(Control control, bool on) { return set(control, on ? 1.0F : 0.0F); }
  /// The same by channel number. @returns false if the receiver has no such channel.
  bool set_channel(int channel, float to, Time over = Time{0});
  /// Moves all four sticks to their positions at start.
  void center_sticks();
  /// No frames are sent while on.
  void set_silent(bool on) { silent_ = on; }
  /// Frames carry the flag "frame lost" while on.
  void set_frame_lost(bool on) { frame_lost_ = on; }
  /// Frames carry the flag "failsafe" while on.
  void set_failsafe(bool on) { failsafe_ = on; }

  /// Position of a control in the newest frame; nothing if it has no channel.
  std::optional<float> position(Control control) const;
  const ChannelMap& channels() const { return script_.channels; }

 private:
  struct Move {
    float from{};
    float to{};
    Time start{};
    Time over{};
    bool fresh{false};  ///< `start` is the next frame.
  };
  void handle(const Event& event);
  void move_channels(Time t);

  Script script_;
  SampleClock clock_;
  std::size_t next_event_{0};
  std::array<float, hal::RcFrame::kMaxChannels> position_{};
  std::array<float, hal::RcFrame::kMaxChannels> last_good_{};
  std::array<Move, hal::RcFrame::kMaxChannels> moves_{};
  std::uint32_t moving_{0};  ///< Bit per channel.
  bool silent_{false};
  bool frame_lost_{false};
  bool failsafe_{false};
};

}  // namespace rosflight::sim::rc
