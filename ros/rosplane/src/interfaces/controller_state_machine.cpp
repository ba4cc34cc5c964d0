// SPDX-License-Identifier: BSD-3-Clause
#include "controller/controller_state_machine.hpp"

namespace rosplane {

ControllerStateMachine::ControllerStateMachine(const rclcpp::NodeOptions& options)
    : ControllerROS(options) {
  params_.declare_double("alt_toz", 5.0);
  params_.declare_double("alt_hz", 10.0);
}

void ControllerStateMachine::control(const Input& input, Output& output) {
  const auto take_off_below_m = static_cast<float>(params_.get_double("alt_toz"));
  const float hold_from_m = input.h_c - static_cast<float>(params_.get_double("alt_hz"));
  AltZones next = current_zone_;
  switch (current_zone_) {
    case AltZones::TAKE_OFF:
      take_off(input, output);
      if (input.h >= take_off_below_m) next = AltZones::CLIMB;
      break;
    case AltZones::CLIMB:
      climb(input, output);
      if (input.h >= hold_from_m)
        next = AltZones::ALTITUDE_HOLD;
      else if (input.h <= take_off_below_m)
        next = AltZones::TAKE_OFF;
      break;
    case AltZones::ALTITUDE_HOLD:
      altitude_hold(input, output);
      if (input.h <= take_off_below_m) next = AltZones::TAKE_OFF;
      break;
  }
  if (next != current_zone_) leave(current_zone_);
  current_zone_ = next;
  output.current_zone = current_zone_;
}

void ControllerStateMachine::leave(AltZones zone) {
  switch (zone) {
    case AltZones::TAKE_OFF:
      return take_off_exit();
    case AltZones::CLIMB:
      return climb_exit();
    case AltZones::ALTITUDE_HOLD:
      return altitude_hold_exit();
  }
}

}  // namespace rosplane
