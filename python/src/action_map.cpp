// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/action_map.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

#include "flight/vehicle/vehicle_setup.hpp"

namespace rosflight::python {
namespace {

struct Level {
  const char* name;
  ActionLevel level;
  bool multirotor;
  bool fixed_wing;
};
constexpr std::array kLevels{
    Level{"motors", ActionLevel::kMotors, true, false},
    Level{"surfaces", ActionLevel::kSurfaces, false, true},
    Level{"rates", ActionLevel::kRates, true, true},
    Level{"angles", ActionLevel::kAngles, true, true},
    Level{"velocity", ActionLevel::kVelocity, true, true},
    Level{"waypoint", ActionLevel::kWaypoint, true, true},
};

ActionLevel level_of(const std::string& name, const flight::FlightSetup& setup) {
  std::vector<const char*> allowed;
  for (const Level& level : kLevels) {
    if (!(setup.fixed_wing() ? level.fixed_wing : level.multirotor)) continue;
    if (name == level.name) return level.level;
    allowed.push_back(level.name);
  }
  throw config::Error(
      fmt::format("action: found '{}' for {}, a {}, allowed {}", name, setup.choice.vehicle,
                  setup.fixed_wing() ? "fixed wing" : "multirotor", fmt::join(allowed, ", ")));
}

}  // namespace

ActionMap::ActionMap(const flight::FlightSetup& setup, const std::string& level)
    : level_{level_of(level, setup)},
      hover_throttle_{static_cast<float>(setup.hover_throttle)},
      axis_{static_cast<companion::ThrottleAxis>(
          flight::firmware_value(setup.firmware, "RC_F_AXIS"))} {
  const auto value = [&setup](const char* name) {
    return static_cast<float>(flight::firmware_value(setup.firmware, name));
  };
  if (level_ == ActionLevel::kRates) {
    scale_ = {value("RC_MAX_ROLLRATE"), value("RC_MAX_PITCHRATE"), value("RC_MAX_YAWRATE")};
  } else {
    scale_ = {value("RC_MAX_ROLL"), value("RC_MAX_PITCH"), value("RC_MAX_YAWRATE")};
  }
  const bool direct = setup.rotors.rotors.size() == kActions && value("USE_MOTOR_PARAM") == 0.0F;
  if (level_ == ActionLevel::kMotors && !direct) {
    throw config::Error(
        fmt::format("action: found motors for {}, allowed for four rotors and USE_MOTOR_PARAM 0",
                    setup.choice.vehicle));
  }
  if (setup.fixed_wing()) max_throttle_ = value("RC_MAX_THR");
  if (level_ == ActionLevel::kVelocity || level_ == ActionLevel::kWaypoint)
    loops_ = CompanionLoops::make(setup);
}

void ActionMap::read_mixer(const core::Firmware& firmware) {
  constexpr int kInputs = 6;
  const Eigen::Matrix<double, kActions, kInputs> gains =
      firmware.mixer().primary().topLeftCorner<kActions, kInputs>().cast<double>();
  // The least-norm inputs of the mixer that give these outputs.
  const Eigen::Matrix<double, kInputs, kActions> inverse =
      gains.completeOrthogonalDecomposition().pseudoInverse();
  for (int row = 0; row < kInputs; ++row) {
    for (int k = 0; k < static_cast<int>(kActions); ++k) {
      inverse_[static_cast<std::size_t>(row)][static_cast<std::size_t>(k)] =
          static_cast<float>(inverse(row, k));
    }
  }
}

void ActionMap::restart() {
  if (loops_ != nullptr) loops_->restart();
}

float ActionMap::throttle(float action) const {
  return action < 0.0F ? hover_throttle_ * (1.0F + action)
                       : hover_throttle_ + (1.0F - hover_throttle_) * action;
}

/// The same output of the motor where the firmware scales a throttle by RC_MAX_THR.
float ActionMap::limited_throttle(float action) const {
  return std::min(throttle(action) / max_throttle_, 1.0F);
}

void ActionMap::begin(const Action& given, const autonomy::StateEstimate& state) {
  action_ = given;
  for (float& value : action_) value = std::clamp(value, -1.0F, 1.0F);
  if (loops_ == nullptr) return;
  CompanionLoops::Numbers a{};
  std::ranges::copy(action_, a.begin());
  if (level_ == ActionLevel::kVelocity) {
    loops_->fly_velocity(a, state);
  } else {
    loops_->fly_waypoint(a, state);
  }
}

link::OffboardControl ActionMap::pass_through() const {
  std::array<float, link::kCommandAxes> u{};
  for (std::size_t row = 0; row < inverse_.size(); ++row) {
    for (std::size_t k = 0; k < kActions; ++k) {
      u[row] += inverse_[row][k] * 0.5F * (action_[k] + 1.0F);
    }
  }
  return companion::pass_through(u);
}

link::OffboardControl ActionMap::command(const autonomy::StateEstimate& state, double dt_s,
                                         double battery_voltage_V) {
  const Action& a = action_;
  switch (level_) {
    case ActionLevel::kMotors:
      return pass_through();
    case ActionLevel::kSurfaces:
      return companion::surfaces(a[1], a[2], a[3], throttle(a[0]));
    case ActionLevel::kRates:
      return companion::body_rates(scale_[0] * a[1], scale_[1] * a[2], scale_[2] * a[3],
                                   limited_throttle(a[0]), axis_);
    case ActionLevel::kAngles:
      return companion::angles(scale_[0] * a[1], scale_[1] * a[2], scale_[2] * a[3],
                               limited_throttle(a[0]), axis_);
    case ActionLevel::kVelocity:
    case ActionLevel::kWaypoint:
      break;
  }
  return sent(loops_->step(state, dt_s, battery_voltage_V));
}

link::OffboardControl sent(const autonomy::FirmwareCommand& command) {
  link::OffboardControl out;
  out.mode = static_cast<std::uint8_t>(command.mode);
  out.ignore = command.ignore;
  out.u = command.u;
  return out;
}

}  // namespace rosflight::python
