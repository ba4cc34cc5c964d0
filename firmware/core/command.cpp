// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/command.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::core {
namespace {

constexpr Time kNever = Time::max();
constexpr std::uint16_t kAllAxes = 0x3FF;
constexpr std::uint16_t kFreeAxes = 0x3C0;
constexpr float kLandedShare = 0.5f;  // share of T_f in (2)

using link::OffboardMode;

CommandType offboard_type(OffboardMode mode, std::size_t axis) {
  if (mode == OffboardMode::kPassThrough || axis >= 6) return CommandType::kPassThrough;
  if (axis <= 2) return CommandType::kThrottle;
  if (axis == 5 || mode == OffboardMode::kRatesThrottle) return CommandType::kRate;
  return CommandType::kAngle;
}

}  // namespace

void CommandManager::configure(const Config& config) {
  config_ = config;
  failsafe_ = CommandVector{};
  failsafe_.active = kAllAxes;
  if (config_.fixed_wing) {
    failsafe_.type.fill(CommandType::kPassThrough);
  } else if (failsafe_valid()) {
    failsafe_.value[config_.throttle_axis] = config_.failsafe_throttle;
  }
  decided_ = false;
  set_axis_limits(offboard_limits_[static_cast<std::size_t>(OffboardMode::kPassThrough)]);
}

bool CommandManager::failsafe_valid() const {
  return config_.fixed_wing ||
         (config_.failsafe_throttle >= 0.0f && config_.failsafe_throttle <= 1.0f);
}

void CommandManager::set_axis_limits(const std::array<float, kAxes>& limits) {
  constexpr auto kRates = static_cast<std::size_t>(OffboardMode::kRatesThrottle);
  constexpr auto kAngles = static_cast<std::size_t>(OffboardMode::kRollPitchYawrateThrottle);
  offboard_limits_.fill(limits);
  for (const std::size_t mode : {kRates, kAngles}) {
    auto& limit = offboard_limits_[mode];
    limit[0] = limit[1] = limit[2] = 1.0f;
    limit[3] = mode == kAngles ? config_.max_roll_rad : config_.max_roll_rate_rad_s;
    limit[4] = mode == kAngles ? config_.max_pitch_rad : config_.max_pitch_rate_rad_s;
    limit[5] = config_.max_yaw_rate_rad_s;
  }
}

void CommandManager::set_throttle_factor(float factor) {
  if (factor == throttle_factor_) return;
  throttle_factor_ = factor;
  decided_ = false;
  if (held_.factor == 0.0f) return;
  const float share = factor / held_.factor;
  float& throttle = offboard_.value[config_.throttle_axis];
  throttle = held_.throttle * share;
  if (share > 1.0f) throttle = std::max(held_.throttle, std::min(throttle, 1.0f));
}

float CommandManager::corrected(float throttle) const {
  return std::max(throttle, std::min(throttle * throttle_factor_, 1.0f));
}

bool CommandManager::admit(link::OffboardControl& command) {
  if (command.mode >= kModes) return false;
  const bool throttle = static_cast<OffboardMode>(command.mode) != OffboardMode::kPassThrough;
  const auto& limits = offboard_limits_[command.mode];
  bool limited = false;
  for (std::size_t k = 0; k < kAxes; ++k) {
    float& u = command.u[k];
    if ((static_cast<unsigned>(command.ignore) >> k & 1u) != 0) {
      u = 0.0f;  // its value has no meaning
      continue;
    }
    const float low = throttle && k < 3 ? 0.0f : -limits[k];
    if (u >= low && u <= limits[k]) continue;
    if (!std::isfinite(u)) return false;
    const float used = u < low ? low : limits[k];
    if (!limited) limited_ = {limited_.count + 1, static_cast<std::uint8_t>(k), u, used};
    limited = true;
    u = used;
  }
  return true;
}

bool CommandManager::set_offboard(Time now, const link::OffboardControl& command,
                                  float thrust_fraction) {
  link::OffboardControl admitted = command;
  if (!admit(admitted)) return false;
  take_offboard(now, admitted, thrust_fraction);
  return true;
}

void CommandManager::take_offboard(Time now, const link::OffboardControl& command,
                                   float thrust_fraction) {
  offboard_.active = static_cast<std::uint16_t>(~command.ignore & kAllAxes);
  offboard_.value = command.u;
  for (std::size_t k = 0; k < kAxes; ++k) {
    offboard_.type[k] = offboard_type(static_cast<OffboardMode>(command.mode), k);
  }
  if (offboard_.is_active(config_.throttle_axis)) {
    offboard_throttle_ = command.u[config_.throttle_axis];
  }
  held_ = {};
  offboard_time_ = now;
  offboard_thrust_fraction_ = thrust_fraction;
  offboard_new_ = true;
}

void CommandManager::forget_offboard() {
  held_ = {};
  offboard_ = CommandVector{};
  offboard_throttle_ = offboard_thrust_fraction_ = 0.0f;
  decided_ = false;
}

void CommandManager::arm(Time now, bool in_air) {
  armed_ = true;
  in_air_ = in_air;
  flight_agreed_ = now;
}

void CommandManager::disarm() {
  armed_ = in_air_ = decided_ = false;
}

bool CommandManager::StickHold::deviated(Time now, float stick, const Config& config) {
  if (std::abs(stick) > config.stick_deviation) {
    ever = true;
    released = now;
    return true;
  }
  return ever && now - released < config.stick_hold;
}

void CommandManager::interpret(const PilotInput& pilot) {
  CommandVector& c = pilot_;
  c = CommandVector{};
  c.active = 0x3F;
  c.value[config_.throttle_axis] = corrected(pilot.throttle);
  c.value[3] = pilot.roll;
  c.value[4] = pilot.pitch;
  c.value[5] = pilot.yaw;
  if (config_.fixed_wing) {
    c.type.fill(CommandType::kPassThrough);
    return;
  }
  const bool angle =
      config_.type_switch_mapped ? pilot.is_on(Switch::kAttitudeType) : config_.angle_mode;
  c.type[3] = c.type[4] = angle ? CommandType::kAngle : CommandType::kRate;
  c.value[3] *= angle ? config_.max_roll_rad : config_.max_roll_rate_rad_s;
  c.value[4] *= angle ? config_.max_pitch_rad : config_.max_pitch_rate_rad_s;
  c.value[5] *= config_.max_yaw_rate_rad_s;
}

bool CommandManager::pilot_wants_less_thrust() const {
  const std::size_t k = config_.throttle_axis;
  if (offboard_.type[k] == CommandType::kThrottle) return pilot_.value[k] < offboard_throttle_;
  if (config_.fixed_wing) return pilot_.value[k] < offboard_throttle_;
  return pilot_.value[k] * config_.max_throttle < offboard_thrust_fraction_;
}

/// Fraction of a pass-through companion's torques that remains when the pilot commands the thrust:
/// the pilot's thrust over the companion's, so that no thrust means no torque.
float CommandManager::torque_share() const {
  const std::size_t k = config_.throttle_axis;
  if (config_.fixed_wing || offboard_.type[k] != CommandType::kPassThrough) return 1.0f;
  const float thrust = pilot_.value[k] * config_.max_throttle;
  if (!(thrust > 0.0f)) return 0.0f;
  return thrust < offboard_thrust_fraction_ ? thrust / offboard_thrust_fraction_ : 1.0f;
}

std::uint16_t CommandManager::override_now(Time now, const PilotInput& pilot) {
  using namespace override_bit;  // NOLINT(google-build-using-namespace): a table of its constants
  std::uint16_t word = 0;
  if (pilot.is_on(Switch::kAttitudeOverride)) word |= kAttitudeSwitch;
  if (pilot.is_on(Switch::kThrottleOverride)) word |= kThrottleSwitch;
  if (holds_[0].deviated(now, pilot.roll, config_)) word |= kStickRoll;
  if (holds_[1].deviated(now, pilot.pitch, config_)) word |= kStickPitch;
  if (holds_[2].deviated(now, pilot.yaw, config_)) word |= kStickYaw;
  if (config_.take_min_throttle && pilot_wants_less_thrust()) word |= kMinThrottle;
  if (!offboard_.is_active(3)) word |= kRollInactive;
  if (!offboard_.is_active(4)) word |= kPitchInactive;
  if (!offboard_.is_active(5)) word |= kYawInactive;
  if (!offboard_.is_active(config_.throttle_axis)) word |= kThrottleInactive;
  return word;
}

void CommandManager::combine() {
  std::uint16_t pilot = 0;
  if ((override_ & override_bit::kThrottle) != 0) pilot |= 0x007;
  if ((override_ & override_bit::kRoll) != 0) pilot |= 0x008;
  if ((override_ & override_bit::kPitch) != 0) pilot |= 0x010;
  if ((override_ & override_bit::kYaw) != 0) pilot |= 0x020;
  if (config_.override_whole && pilot != 0) pilot = 0x03F;
  combined_.value = offboard_.value;
  combined_.type = offboard_.type;
  constexpr std::size_t kOfThePilot = 6;  // the pilot has no free axes
  for (std::size_t k = 0; pilot != 0 && k < kOfThePilot; ++k) {
    if ((static_cast<unsigned>(pilot) >> k & 1u) == 0) continue;
    combined_.value[k] = pilot_.value[k];
    combined_.type[k] = pilot_.type[k];
  }
  if ((override_ & override_bit::kThrottle) != 0) {
    const float share = torque_share();
    for (std::size_t k = 3; k < 6; ++k) {
      if ((static_cast<unsigned>(pilot) >> k & 1u) == 0) combined_.value[k] *= share;
    }
  }
  combined_.active =
      static_cast<std::uint16_t>((pilot_.active & pilot) | (offboard_.active & ~pilot));
  const auto free_inactive = static_cast<std::uint16_t>(kFreeAxes & ~offboard_.active);
  primary_axes_ = static_cast<std::uint16_t>(pilot | free_inactive);
}

/// Roll and pitch of a fixed wing that nobody flies are angles: with surfaces at neutral it would trade
/// height for speed in long swings. The pilot holds them because the companion is silent, not by his switch.
void CommandManager::hold_angles() {
  constexpr auto kSilent =
      static_cast<std::uint16_t>(override_bit::kRollInactive | override_bit::kPitchInactive);
  const bool silent = (override_ & (override_bit::kAttitudeSwitch | kSilent)) == kSilent;
  if (!in_failsafe_ && !silent) return;
  combined_.type[3] = combined_.type[4] = CommandType::kAngle;
  combined_.value[3] *= config_.max_roll_rad;
  combined_.value[4] *= config_.max_pitch_rad;
}

/// Thrust of a multirotor, 0..1 of the motors' maximum.
float CommandManager::thrust(const CommandVector& command) const {
  const std::size_t k = config_.throttle_axis;
  if (command.type[k] == CommandType::kPassThrough) return offboard_thrust_fraction_;
  return command.value[k] * config_.max_throttle;
}

float CommandManager::sinking_thrust() const {
  return corrected(config_.failsafe_throttle) * config_.max_throttle;
}

/// Evaluates (1) and (2) with the thrust that was in force until now.
void CommandManager::watch_flight(Time now) {
  const float in_force = thrust(combined_);
  const bool agrees =
      in_air_ ? in_force > kLandedShare * sinking_thrust() : !(in_force > sinking_thrust());
  if (!armed_ || agrees) flight_agreed_ = now;
  if (now - flight_agreed_ < kFlightChange) return;
  in_air_ = !in_air_;
  flight_agreed_ = now;
}

/// Only where both mixers are the same: there an angle means what it meant to the companion. The failsafe command does
/// not wait for the end of a hold.
bool CommandManager::may_hold(bool failsafe) const {
  return config_.offboard_hold > Time{} && !config_.fixed_wing && !config_.override_whole &&
         in_air_ && !failsafe && offboard_.is_active(config_.throttle_axis) &&
         thrust(offboard_) > kLandedShare * sinking_thrust();
}

/// The last thrust carried the vehicle; angles and torques were meant for the next hundredth of a second.
void CommandManager::hold_level() {
  if (held_.factor == 0.0f) held_ = {offboard_.value[config_.throttle_axis], throttle_factor_};
  offboard_.active = static_cast<std::uint16_t>(offboard_.active & ~kFreeAxes);
  for (std::size_t k = 3; k < kAxes; ++k) {
    offboard_.value[k] = 0.0f;
    offboard_.type[k] = offboard_type(OffboardMode::kRollPitchYawrateThrottle, k);
  }
}

bool CommandManager::update(Time now, const PilotInput& pilot, bool new_input, bool failsafe) {
  const bool due =
      new_input || offboard_new_ || !decided_ || now >= decide_at_ || failsafe != in_failsafe_;
  if (!due) return false;
  decided_ = true;
  offboard_new_ = false;
  watch_flight(now);
  Time silent_at = offboard_time_ + config_.offboard_timeout;
  if (now > silent_at && may_hold(failsafe)) {
    silent_at += config_.offboard_hold;
    hold_level();
  }
  if (now > silent_at) {
    held_ = {};
    offboard_.active = 0;
    offboard_.value.fill(0.0f);
  }
  interpret(pilot);
  const std::uint16_t before = override_;
  override_ = override_now(now, pilot);
  in_failsafe_ = failsafe;
  if (failsafe && config_.companion_in_failsafe) {
    override_ = static_cast<std::uint16_t>(override_ & ~override_bit::kMinThrottle);
    in_failsafe_ = override_ != 0;
  }

  decide_at_ = kNever;
  if (offboard_.active != 0) decide_at_ = silent_at + hal::microseconds(1);
  for (const StickHold& hold : holds_) {
    const Time end = hold.released + config_.stick_hold;
    if (hold.ever && end > now) decide_at_ = std::min(decide_at_, end);
  }

  if (in_failsafe_) {
    combined_ = failsafe_;
    float& throttle = combined_.value[config_.throttle_axis];
    throttle = corrected(throttle);
    primary_axes_ = kAllAxes;
  } else {
    combine();
  }
  if (config_.fixed_wing_holds) hold_angles();
  return override_ != before;
}

}  // namespace rosflight::core
