// SPDX-License-Identifier: BSD-3-Clause
#include "companion/offboard.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::companion {

namespace {

constexpr std::size_t kRollAxis = 3;
constexpr std::size_t kPitchAxis = 4;
constexpr std::size_t kYawAxis = 5;
constexpr float kMinNorm = 1e-3f;

template <std::size_t N>
bool all_finite(const std::array<float, N>& values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

link::OffboardControl attitude_command(link::OffboardMode mode, float roll, float pitch, float yaw,
                                       float throttle, ThrottleAxis axis) {
  link::OffboardControl command;
  command.mode = static_cast<std::uint8_t>(mode);
  command.ignore = kIgnoreAll;
  const auto use = [&command](std::size_t entry, float value) {
    command.u[entry] = value;
    command.ignore = static_cast<std::uint16_t>(command.ignore & ~ignore_bit(entry));
  };
  use(static_cast<std::size_t>(axis), throttle);
  use(kRollAxis, roll);
  use(kPitchAxis, pitch);
  use(kYawAxis, yaw);
  return command;
}

bool in_range(std::uint8_t type, float value) {
  switch (static_cast<link::AuxType>(type)) {
    case link::AuxType::kDisabled:
      return true;
    case link::AuxType::kServo:
      return value >= -1.0f && value <= 1.0f;
    case link::AuxType::kMotor:
      return value >= 0.0f && value <= 1.0f;
  }
  return false;
}

}  // namespace

link::OffboardControl pass_through(const std::array<float, link::kCommandAxes>& u,
                                   std::uint16_t ignore) {
  return {static_cast<std::uint8_t>(link::OffboardMode::kPassThrough), ignore, u};
}

link::OffboardControl body_rates(float roll_rad_s, float pitch_rad_s, float yaw_rad_s,
                                 float throttle, ThrottleAxis axis) {
  return attitude_command(link::OffboardMode::kRatesThrottle, roll_rad_s, pitch_rad_s, yaw_rad_s,
                          throttle, axis);
}

link::OffboardControl angles(float roll_rad, float pitch_rad, float yaw_rad_s, float throttle,
                             ThrottleAxis axis) {
  return attitude_command(link::OffboardMode::kRollPitchYawrateThrottle, roll_rad, pitch_rad,
                          yaw_rad_s, throttle, axis);
}

link::OffboardControl surfaces(float aileron, float elevator, float rudder, float throttle) {
  return attitude_command(link::OffboardMode::kPassThrough, aileron, elevator, rudder, throttle,
                          ThrottleAxis::kX);
}

SendStatus Offboard::check(SendStatus status) {
  counters_.refused += status == SendStatus::kSent ? 0 : 1;
  return status;
}

SendStatus Offboard::put(const link::Message& message, std::uint8_t qos) {
  if (port_.send(message, qos)) {
    return SendStatus::kSent;
  }
  ++counters_.dropped;
  return SendStatus::kLinkBusy;
}

SendStatus Offboard::send(const link::OffboardControl& command) {
  const bool known =
      command.mode <= static_cast<std::uint8_t>(link::OffboardMode::kRollPitchYawrateThrottle) &&
      (command.ignore & ~kIgnoreAll) == 0;
  if (!known) {
    return check(SendStatus::kBadMode);
  }
  if (!all_finite(command.u)) {
    return check(SendStatus::kNotFinite);
  }
  const SendStatus status = put(command, kUrgent);
  counters_.sent += status == SendStatus::kSent ? 1 : 0;
  return status;
}

SendStatus Offboard::hold(const link::OffboardControl& command, double rate_hz, Time lifetime) {
  const bool possible = rate_hz >= 0.1 && rate_hz <= 1000.0;  // false for NaN
  if (!possible) {
    return check(SendStatus::kBadMode);
  }
  const SendStatus status = send(command);
  if (status == SendStatus::kNotFinite || status == SendStatus::kBadMode) {
    return status;
  }
  held_ = command;
  period_ = Time{std::llround(1e9 / rate_hz)};
  next_ = port_.now() + period_;
  held_until_ = port_.now() + lifetime;
  port_.wake();
  return status;
}

void Offboard::run() {
  const Time now = port_.now();
  if (!holding() || now < next_) {
    return;
  }
  static_cast<void>(send(held_));
  // Late steps do not make up for lost setpoints: only the newest counts.
  next_ = next_ + period_ > now ? next_ + period_ : now + period_;
}

SendStatus Offboard::send(const link::AuxCommand& command) {
  if (!all_finite(command.value)) {
    return check(SendStatus::kNotFinite);
  }
  for (std::size_t i = 0; i < command.type.size(); ++i) {
    if (!in_range(command.type[i], command.value[i])) {
      return check(SendStatus::kBadMode);
    }
  }
  return put(command, kOrdinary);
}

SendStatus Offboard::send(const link::ExternalAttitude& attitude) {
  if (!all_finite(attitude.q_WB)) {
    return check(SendStatus::kNotFinite);
  }
  double norm_squared = 0.0;
  for (const float q : attitude.q_WB) {
    norm_squared += static_cast<double>(q) * static_cast<double>(q);
  }
  const double norm = std::sqrt(norm_squared);
  if (norm < static_cast<double>(kMinNorm)) {
    return check(SendStatus::kBadMode);
  }
  link::ExternalAttitude unit;
  for (std::size_t i = 0; i < unit.q_WB.size(); ++i) {
    unit.q_WB[i] = static_cast<float>(static_cast<double>(attitude.q_WB[i]) / norm);
  }
  return put(unit, kOrdinary);
}

void Offboard::copy_state_of(const Offboard& other) {
  held_ = other.held_;
  period_ = other.period_;
  next_ = other.next_;
  held_until_ = other.held_until_;
  counters_ = other.counters_;
}

}  // namespace rosflight::companion
