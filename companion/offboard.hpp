// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>

#include "companion/port.hpp"
#include "companion/time.hpp"
#include "link/messages.hpp"

namespace rosflight::companion {

/// The force axis that carries the throttle: parameter RC_F_AXIS of the vehicle.
enum class ThrottleAxis : std::uint8_t { kX = 0, kY = 1, kZ = 2 };

inline constexpr std::uint16_t kIgnoreNone = 0;
inline constexpr std::uint16_t kIgnoreAll = 0x3FF;
/// The bit of one axis in the ignore mask.
constexpr std::uint16_t ignore_bit(std::size_t axis) {
  return static_cast<std::uint16_t>(1U << axis);
}

// Setpoints. All ten axes are sent; an axis whose ignore bit is set stays with the pilot.

/// Directly to the mixer: u = forces Fx Fy Fz, torques Qx Qy Qz and four free axes, in the unit of
/// the mixer. Thrust up is negative Fz.
link::OffboardControl pass_through(const std::array<float, link::kCommandAxes>& u,
                                   std::uint16_t ignore = kIgnoreNone);
/// Body rates [rad/s] and throttle 0..1 along the axis (positive Z is up); the other forces and the
/// free axes are ignored.
link::OffboardControl body_rates(float roll_rad_s, float pitch_rad_s, float yaw_rad_s,
                                 float throttle, ThrottleAxis axis = ThrottleAxis::kZ);
/// Roll and pitch angle [rad], yaw rate [rad/s] and throttle 0..1.
link::OffboardControl angles(float roll_rad, float pitch_rad, float yaw_rad_s, float throttle,
                             ThrottleAxis axis = ThrottleAxis::kZ);
/// Aileron, elevator, rudder -1..1 and throttle 0..1 on Fx, directly to a fixed wing's mixer.
link::OffboardControl surfaces(float aileron, float elevator, float rudder, float throttle);

enum class [[nodiscard]] SendStatus : std::uint8_t {
  kSent,
  kNotFinite,  ///< An axis is NaN or infinite; nothing sent.
  kBadMode,    ///< Undefined mode, type or mask, or a value out of range; nothing sent.
  kLinkBusy    ///< Link closed or queue full; nothing sent.
};

/// A few words for a message.
constexpr const char* send_status_text(SendStatus status) {
  constexpr const char* kTexts[] = {"sent", "NaN or infinity", "unknown mode or value out of range",
                                    "link closed or full"};
  return kTexts[static_cast<std::size_t>(status)];
}

/// Sends setpoints. A rejected setpoint is never sent.
class Offboard {
 public:
  struct Counters {
    std::uint64_t sent{};     ///< Setpoints, held ones included.
    std::uint64_t refused{};  ///< kNotFinite and kBadMode, of all three kinds.
    std::uint64_t dropped{};  ///< kLinkBusy.
  };

  /// @param port  must outlive this.
  explicit Offboard(Port& port) : port_(port) {}

  /// Sends a setpoint at once, as an urgent frame. The FCU discards it after OFFBOARD_TIMEOUT
  /// (100 ms): call it at a steady rate, or use hold().
  SendStatus send(const link::OffboardControl& command);

  /// Sends now and then repeats at `rate_hz` until release(), another hold() or the end of
  /// `lifetime`, which stops the commands of a caller that hangs. A send() in between does not end
  /// it.
  /// @param rate_hz  0.1 to 1000; limited by the rate of Session::step.
  SendStatus hold(const link::OffboardControl& command, double rate_hz, Time lifetime);
  /// Ends hold().
  void release() { held_until_ = Time::min(); }
  bool holding() const { return port_.now() < held_until_; }

  /// Sets outputs outside the mixer; servo -1..1, motor 0..1. In force until the next one.
  SendStatus send(const link::AuxCommand& command);

  /// Sends an external attitude (w, x, y, z; body to north-east-down). It is normalised here.
  SendStatus send(const link::ExternalAttitude& attitude);

  const Counters& counters() const { return counters_; }

  // For the session.
  /// Repeats the held setpoint when it is due.
  void run();
  Time next_due() const { return holding() ? next_ : kNever; }
  /// Takes over the state of another one.
  void copy_state_of(const Offboard& other);

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
