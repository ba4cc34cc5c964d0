// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>
#include <memory>

#include "rosflight_sim/forces_and_moments_interface.hpp"
#include "run.hpp"

// A quadrotor of your own: thrust by the square of the pulse, torque by the arms, drag of the body.

namespace {

struct Rotor {
  double x_m, y_m;
  double spin;  // +1: its drag yaws the body right
};

// Front right, rear right, rear left, front left, as the mixer "quadrotor X" has them.
constexpr std::array<Rotor, 4> kRotors{{{0.1768, 0.1768, 1.0},
                                        {-0.1768, 0.1768, -1.0},
                                        {-0.1768, -0.1768, 1.0},
                                        {0.1768, -0.1768, -1.0}}};
constexpr double kMaxThrust = 36.0;  // of a rotor [N]
constexpr double kTorquePerThrust_m = 0.0187;
constexpr double kDrag_N_s_m = 0.5;

class OwnForces : public rosflight_sim::ForcesAndMomentsInterface {
 public:
  geometry_msgs::msg::WrenchStamped update_forces_and_torques(
      rosflight_msgs::msg::SimState x, geometry_msgs::msg::Vector3Stamped /*wind*/,
      std::array<uint16_t, NUM_TOTAL_OUTPUTS> act_cmds) override {
    geometry_msgs::msg::WrenchStamped out;
    auto& force = out.wrench.force;
    auto& torque = out.wrench.torque;
    for (std::size_t k = 0; k < kRotors.size(); ++k) {
      const double throttle = sat((act_cmds[k] - 1000.0) / 1000.0, 1.0, 0.0);
      const double thrust_N = kMaxThrust * throttle * throttle;
      force.z -= thrust_N;
      torque.x -= kRotors[k].y_m * thrust_N;
      torque.y += kRotors[k].x_m * thrust_N;
      torque.z += kRotors[k].spin * kTorquePerThrust_m * thrust_N;
    }
    force.x -= kDrag_N_s_m * x.twist.linear.x;
    force.y -= kDrag_N_s_m * x.twist.linear.y;
    force.z -= kDrag_N_s_m * x.twist.linear.z;
    return out;
  }

  void get_firmware_parameters() override {
    RCLCPP_INFO(get_logger(), "read mixer %d of the firmware", primary_mixer_);
  }
};

}  // namespace

int main(int argc, char** argv) {
  return run(argc, argv, {{"forces", [] { return std::make_shared<OwnForces>(); }}});
}
