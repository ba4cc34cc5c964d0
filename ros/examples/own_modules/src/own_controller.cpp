// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <memory>

#include "controller/controller_state_machine.hpp"
#include "run.hpp"

// A controller of your own in place of roscopter's: position errors become velocities, then accelerations, then angles and a throttle.
// The vehicle is the one of own_forces.cpp.

namespace {

using roscopter_msgs::msg::ControllerCommand;
using rosflight_msgs::msg::Command;

class OwnController : public roscopter::ControllerStateMachine {
 public:
  OwnController() {
    params.declare_double("mass", 3.5);
    params.declare_double("full_thrust", 144.0);  // of all rotors [N]
    params.declare_double("max_throttle", 0.7);   // RC_MAX_THR: the firmware's output at throttle 1
    params.declare_double("max_tilt", 0.4);       // [rad]
  }

 private:
  static constexpr double kGravity = 9.81;

  void update_gains() override { RCLCPP_INFO(get_logger(), "mass %g", params.get_double("mass")); }
  void reset_integrators() override { sum_ = 0.0; }

  Command compute_offboard_control(ControllerCommand& in, double dt) override {
    switch (in.mode) {
      case ControllerCommand::MODE_NPOS_EPOS_DVEL_YAW:
        return fly_to(in.cmd1, in.cmd2, in.cmd3, in.cmd4, dt);
      case ControllerCommand::MODE_NPOS_EPOS_DPOS_YAW:
        return fly_to(in.cmd1, in.cmd2, saturate(1.0 * (in.cmd3 - xhat_.p_d), 1.0, -1.5), in.cmd4,
                      dt);
      case ControllerCommand::MODE_ROLL_PITCH_YAWRATE_THRUST_TO_MIXER:
        return angles(in.cmd1, in.cmd2, in.cmd3, in.cmd4);
      default:
        RCLCPP_ERROR_ONCE(get_logger(), "mode %d: not supported", in.mode);
        return Command();
    }
  }

  /// Flies to a position [m] at a vertical velocity [m/s] and a heading [rad].
  Command fly_to(double north, double east, double down_m_s, double yaw, double dt) {
    const double c = std::cos(xhat_.psi), s = std::sin(xhat_.psi);
    // Velocity over ground, roughly: as if the vehicle were level.
    const double v_n = c * xhat_.v_x - s * xhat_.v_y, v_e = s * xhat_.v_x + c * xhat_.v_y;
    const double a_n = 2.0 * (saturate(0.9 * (north - xhat_.p_n), 2.0, -2.0) - v_n);
    const double a_e = 2.0 * (saturate(0.9 * (east - xhat_.p_e), 2.0, -2.0) - v_e);
    const double error = down_m_s - xhat_.v_z;
    sum_ = saturate(sum_ + error * dt, 3.0, -3.0);
    const double a_d = saturate(3.0 * error + 1.0 * sum_, 5.0, -5.0);
    const double turn = wrap_within_180(0.0, yaw - xhat_.psi);
    const double lift = (kGravity - a_d) / (std::cos(xhat_.phi) * std::cos(xhat_.theta));
    return angles((c * a_e - s * a_n) / kGravity, -(c * a_n + s * a_e) / kGravity,
                  saturate(1.5 * turn, 1.0, -1.0), params.get_double("mass") * lift);
  }

  /// Roll, pitch [rad], yaw rate [rad/s], thrust [N].
  Command angles(double roll, double pitch, double yaw_rate, double thrust_N) {
    const double tilt = params.get_double("max_tilt");
    const double share = saturate(thrust_N / params.get_double("full_thrust"), 0.9, 0.02);
    Command out;
    out.mode = Command::MODE_ROLL_PITCH_YAWRATE_THROTTLE;
    out.u[2] =
        static_cast<float>(std::min(1.0, std::sqrt(share) / params.get_double("max_throttle")));
    out.u[3] = static_cast<float>(saturate(roll, tilt, -tilt));
    out.u[4] = static_cast<float>(saturate(pitch, tilt, -tilt));
    out.u[5] = static_cast<float>(yaw_rate);
    return out;
  }

  double sum_{0.0};
};

}  // namespace

int main(int argc, char** argv) {
  return run(argc, argv, {{"controller", [] { return std::make_shared<OwnController>(); }}});
}
