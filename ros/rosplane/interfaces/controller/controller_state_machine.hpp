// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "controller/controller_ros.hpp"

namespace rosplane {

/// A controller of your own in three zones of height. Names are those of rosplane 2.0.
///
/// take_off() below alt_toz [m]; then climb() until alt_hz [m] below the commanded height; then altitude_hold(). Back below alt_toz it is
/// take_off() again. The zone changes after a step, and its *_exit() is called once then. Compiles as C++17.
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
