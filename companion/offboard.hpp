// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>

#include "companion/port.hpp"
#include "companion/time.hpp"
#include "link/messages.hpp"

namespace rosflight::companion {

/// Which of the three force entries carries the throttle: parameter RC_F_AXIS of the vehicle.
enum class ThrottleAxis : std::uint8_t { kX = 0, kY = 1, kZ = 2 };

inline constexpr std::uint16_t kIgnoreNone = 0;
inline constexpr std::uint16_t kIgnoreAll = 0x3FF;
/// Mask bit of one entry of the command vector.
constexpr std::uint16_t ignore_bit(std::size_t entry) {
  return static_cast<std::uint16_t>(1U << entry);
}

// Set-points. All ten entries travel; an entry whose ignore bit is set stays with the pilot.

/// Everything straight to the mixer: u = forces Fx Fy Fz, torques Qx Qy Qz and four free entries,
/// in the unit of the mixer. Up-thrust is negative Fz.
link::OffboardControl pass_through(const std::array<float, link::kCommandEntries>& u,
                                   std::uint16_t ignore = kIgnoreNone);
/// Body rates [rad/s], throttle 0..1 along the axis (positive Z is up); other forces and free
/// entries ignored.
link::OffboardControl body_rates(float roll_rad_s, float pitch_rad_s, float yaw_rad_s,
                                 float throttle, ThrottleAxis axis = ThrottleAxis::kZ);
/// Roll and pitch angle [rad], yaw rate [rad/s], throttle 0..1.
link::OffboardControl angles(float roll_rad, float pitch_rad, float yaw_rad_s, float throttle,
                             ThrottleAxis axis = ThrottleAxis::kZ);
/// Aileron, elevator, rudder -1..1 and throttle 0..1 on Fx, straight to a fixed wing's mixer.
link::OffboardControl surfaces(float aileron, float elevator, float rudder, float throttle);

enum class [[nodiscard]] SendStatus : std::uint8_t {
  kSent,
  kNotFinite,  ///< NaN or infinity in an entry; nothing sent.
  kBadMode,    ///< Mode, type or mask that no FCU knows, or a value out of its range; nothing sent.
  kLinkBusy    ///< Link closed or queue full; nothing sent.
};

constexpr const char* send_status_text(SendStatus status) {
  constexpr const char* kTexts[] = {"sent", "NaN or infinity", "unknown mode or value out of range",
                                    "link closed or full"};
  return kTexts[static_cast<std::size_t>(status)];
}

/// Sends set-points. What is refused here never reaches the link.
class Offboard {
 public:
  struct Counters {
    std::uint64_t sent{};     ///< Set-points, held ones included.
    std::uint64_t refused{};  ///< kNotFinite and kBadMode, of all three kinds.
    std::uint64_t dropped{};  ///< kLinkBusy.
  };

  explicit Offboard(Port& port) : port_(port) {}

  /// At once, urgently. The FCU forgets it OFFBOARD_TIMEOUT (100 ms) later: call steadily, or
  /// hold().
  SendStatus send(const link::OffboardControl& command);

  /// Sends now and then at `rate_hz` until release(), another hold(), or `lifetime` is over; the
  /// lifetime is the dead man's switch of a caller that may hang. A send() in between does not end
  /// it.
  /// @param rate_hz  0.1 to 1000; held to the rhythm of Session::step.
  SendStatus hold(const link::OffboardControl& command, double rate_hz, Time lifetime);
  void release() { held_until_ = Time::min(); }
  bool holding() const { return port_.now() < held_until_; }

  /// Outputs outside the mixer; servo -1..1, motor 0..1. Stays in force until the next one.
  SendStatus send(const link::AuxCommand& command);

  /// Attitude from outside (w, x, y, z; body to NED). Normalised here.
  SendStatus send(const link::ExternalAttitude& attitude);

  const Counters& counters() const { return counters_; }

  // For the session.
  void run();
  Time next_due() const { return holding() ? next_ : kNever; }

 private:
  SendStatus check(SendStatus status);
  SendStatus put(const link::Message& message, std::uint8_t qos);

  Port& port_;
  link::OffboardControl held_;
  Time period_{};
  Time next_{};
  Time held_until_{Time::min()};
  Counters counters_;
};

}  // namespace rosflight::companion
