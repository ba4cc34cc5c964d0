// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/action_map.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <variant>
#include <vector>

#include "base/constants.hpp"
#include "flight/vehicle/vehicle_setup.hpp"

namespace rosflight::python {
namespace {

using autonomy::multirotor::ControlMode;

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
    Level{"velocity", ActionLevel::kVelocity, true, false},
    Level{"waypoint", ActionLevel::kWaypoint, true, false},
};

ActionLevel level_of(const std::string& name, const flight::FlightSetup& setup) {
  if (setup.quadplane()) {
    throw config::Error(
        fmt::format("vehicle: found {}, a quad-plane, allowed a multirotor or a fixed wing",
                    setup.choice.vehicle));
  }
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
  if (depends_on_state()) {
    const auto& flight = std::get<flight::MultirotorPlan>(setup.plan).autonomy.flight;
    fresh_ = {flight.controller, flight.thrust};
  }
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
  controller_ = fresh_;
}

float ActionMap::throttle(float action) const {
  return action < 0.0F ? hover_throttle_ * (1.0F + action)
                       : hover_throttle_ + (1.0F - hover_throttle_) * action;
}

/// The same output of the motor where the firmware scales a throttle by RC_MAX_THR.
float ActionMap::limited_throttle(float action) const {
  return std::min(throttle(action) / max_throttle_, 1.0F);
}

void ActionMap::begin(const Action& given, const SeenState& state) {
  action_ = given;
  for (float& value : action_) value = std::clamp(value, -1.0F, 1.0F);
  if (!depends_on_state()) return;
  const auto& limits = fresh_.config();
  std::array<double, kActions> a{};
  std::ranges::copy(action_, a.begin());
  if (level_ == ActionLevel::kVelocity) {
    const double vertical = a[2] < 0.0 ? limits.max_climb_m_s : limits.max_descend_m_s;
    const double horizontal = limits.max_horizontal_velocity_m_s;
    wanted_ = {
        ControlMode::kNvelEvelDvelYawrate,
        {horizontal * a[0], horizontal * a[1], vertical * a[2], limits.max_yaw_rate_rad_s * a[3]},
        true};
  } else {
    wanted_ = {ControlMode::kNposEposDposYaw,
               {state.p_W.x() + kReach_m * a[0], state.p_W.y() + kReach_m * a[1],
                state.p_W.z() + kReach_m * a[2], base::kPi * a[3]},
               true};
  }
}

void ActionMap::fly_to(const sim::Vector3& p_W, double heading_rad) {
  wanted_ = {ControlMode::kNposEposDposYaw, {p_W.x(), p_W.y(), p_W.z(), heading_rad}, true};
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

link::OffboardControl ActionMap::command(const SeenState& state, double dt_s,
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
  autonomy::multirotor::State flown;
  flown.p_W = state.p_W;
  flown.v_W = state.v_W;
  flown.q_WB = state.q_WB;
  flown.w_B = state.w_B;
  const autonomy::multirotor::AttitudeView attitude{state.q_WB};
  const autonomy::FirmwareCommand made = controller_
                                             .step({.state = flown,
                                                    .attitude = attitude,
                                                    .command = wanted_,
                                                    .dt_s = dt_s,
                                                    .battery_voltage_V = battery_voltage_V})
                                             .command;
  link::OffboardControl out;
  out.mode = static_cast<std::uint8_t>(made.mode);
  out.ignore = made.ignore;
  out.u = made.u;
  return out;
}

}  // namespace rosflight::python
