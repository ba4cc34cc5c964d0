// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "controller/controller_ros.hpp"

namespace rosplane {

/// Base class for a controller with three altitude zones. The names are those of rosplane 2.0.
///
/// Below alt_toz [m] it calls take_off(); then climb() up to alt_hz [m] below the commanded altitude; then altitude_hold(). Below
/// alt_toz again it calls take_off(). The zone changes after a step; the *_exit() of the zone it leaves is called once.
/// Compiles as C++17.
class ControllerStateMachine : public ControllerROS {
 public:
  explicit ControllerStateMachine(const rclcpp::NodeOptions& options = rclcpp::NodeOptions());

  void control(const Input& input, Output& output) override;

 protected:
  AltZones current_zone_{AltZones::TAKE_OFF};

  virtual void take_off(const Input& input, Output& output) = 0;
  virtual void climb(const Input& input, Output& output) = 0;
  virtual void altitude_hold(const Input& input, Output& output) = 0;
  virtual void take_off_exit() = 0;
  virtual void climb_exit() = 0;
  virtual void altitude_hold_exit() = 0;

 private:
  void leave(AltZones zone);
};

}  // namespace rosplane
