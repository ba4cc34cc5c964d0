// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace rosflight::autonomy {

enum class FlightEventType : std::uint8_t {
  kPhase,            ///< index: the new Phase of the vehicle's table.
  kWaypointReached,  ///< index: the waypoint; value: distance [m], of a fixed wing horizontal.
  kWaypointMissed,   ///< The same; a multirotor waited arrival_timeout_s for the waypoint.
  kMissionDone,
  kTakeoffFailed,
  kPathFault,  ///< No path leads on from the present position: the vehicle circles.
  kMotorOut,
  kPositionLost,
  kPilotTookOver,
  kPilotGaveBack,
  kStateLost,  ///< The state is not finite, or missing, or the link is silent. The next event says what follows.
  kStateRegained,
  kThrustFault,  ///< The vehicle does not follow its thrust (ThrustWatch); value: its climb rate [m/s]. It lands.
  kBatteryLow,     ///< BatteryWatch; the next two decide.
  kBatteryReturn,  ///< It returns and lands.
  kBatteryLand,    ///< It lands now.
  kFenceCrossed,   ///< It returns and lands.
  kFailsafeFlies,  ///< The receiver is lost and the flight controller flies its failsafe command.
  kFailsafeOver,   ///< It follows commands again.
  kReturning,      ///< On its way back to the start, to land there.
  kAileronsLost,   ///< They have no effect: the rudder rolls.
  kSinksLevel,     ///< A multirotor without a state (LevelSink).
  kGlidesLevel,    ///< A fixed wing without a state (LevelGlide).
  kLongGap,        ///< It could not be guided for more than GapWatch::kGoesOn_s.
  kTakeoffAgain  ///< A fixed wing tries the take-off again that link or receiver have interrupted.
};
/// Text for logs, such as "waypoint reached"; "unknown" outside the enumeration.
const char* name(FlightEventType type);

struct FlightEvent {
  FlightEventType type{};
  std::size_t index{};
  double value{};
};

/// The events of one step, in order; more than kMax are dropped.
struct FlightEvents {
  static constexpr std::size_t kMax = 8;
  std::array<FlightEvent, kMax> list{};
  std::size_t count{};

  /// Appends an event; index and value as FlightEventType says.
  void add(FlightEventType type, std::size_t index = 0, double value = 0.0) {
    if (count < kMax) list[count++] = {type, index, value};
  }
  const FlightEvent* begin() const { return list.data(); }
  const FlightEvent* end() const { return list.data() + count; }
};

}  // namespace rosflight::autonomy
