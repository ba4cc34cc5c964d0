// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <memory>

#include "controller/controller_state_machine.hpp"
#include "ekf/estimator_ros.hpp"
#include "path_follower/path_follower_ros.hpp"
#include "path_manager/path_manager_ros.hpp"
#include "run.hpp"

// The four modules of rosplane, each as short as possible: a start for your own. All but the estimator fly together.

namespace {

const double kPi = std::acos(-1.0);

/// No filter: position and course from GNSS, rates from the gyro, airspeed from the pitot tube.
class OwnEstimator : public rosplane::EstimatorROS {
  void estimate(const Input& input, Output& output) override {
    check_sensors();
    output.p = input.gyro_x, output.q = input.gyro_y, output.r = input.gyro_z;
    if (input.gps_new)
      output.pn = input.gps_n, output.pe = input.gps_e, output.chi = input.gps_course;
    if (input.diff_new && rho_ > 0.0F)
      output.va = std::sqrt(2.0F * std::max(input.diff_pres, 0.0F) / rho_);
  }
};

/// A line from waypoint to waypoint, each at the altitude of its end, then an orbit around the last. Without waypoints an orbit
/// around the origin.
class OwnPathManager : public rosplane::PathManagerROS {
  void manage(const Input& input, Output& output) override {
    const auto radius = static_cast<float>(params_.get_double("R_min"));
    output.va_d = static_cast<float>(params_.get_double("default_airspeed"));
    if (waypoints_.empty())
      return orbit(0.0F, 0.0F, static_cast<float>(-params_.get_double("default_altitude")), output);
    for (; idx_a_ + 1 < num_waypoints_; ++idx_a_) {
      const Waypoint& from = waypoints_[static_cast<std::size_t>(idx_a_)];
      const Waypoint& to = waypoints_[static_cast<std::size_t>(idx_a_) + 1];
      const float north = to.w[0] - from.w[0], east = to.w[1] - from.w[1];
      const float length = std::max(std::hypot(north, east), 1.0F);
      output.q[0] = north / length, output.q[1] = east / length;
      const float left_to_go =
          output.q[0] * (to.w[0] - input.pn) + output.q[1] * (to.w[1] - input.pe);
      if (left_to_go < radius / 2.0F) continue;
      std::copy(std::begin(to.w), std::end(to.w), output.r);
      output.va_d = to.va_d;
      return;
    }
    const auto& last = waypoints_.back().w;
    orbit(last[0], last[1], last[2], output);
  }

  void orbit(float north, float east, float down, Output& output) const {
    output.flag = false;
    output.c[0] = north, output.c[1] = east, output.c[2] = down;
    output.rho = static_cast<float>(params_.get_double("R_min"));
    output.lamda = 1;
  }
};

/// The vector field of R. Beard, T. McLain, Small Unmanned Aircraft, 2012, sec. 10.1 and 10.2.
class OwnPathFollower : public rosplane::PathFollowerROS {
  void follow(const Input& input, Output& output) override {
    output.va_c = input.va_d;
    if (input.p_type == rosplane::PathType::LINE) {
      const double chi_q = std::atan2(input.q_path[1], input.q_path[0]);
      const double beside = -std::sin(chi_q) * (input.pn - input.r_path[0]) +
                            std::cos(chi_q) * (input.pe - input.r_path[1]);
      output.chi_c = chi_q - params_.get_double("chi_infty") * 2.0 / kPi *
                                 std::atan(params_.get_double("k_path") * beside);
      output.h_c = -input.r_path[2];
      return;
    }
    const double north = input.pn - input.c_orbit[0], east = input.pe - input.c_orbit[1];
    const double outside = (std::hypot(north, east) - input.rho_orbit) / input.rho_orbit;
    output.chi_c =
        std::atan2(east, north) +
        input.lam_orbit * (kPi / 2.0 + std::atan(params_.get_double("k_orbit") * outside));
    output.h_c = -input.c_orbit[2];
    output.phi_ff = input.lam_orbit * std::atan(input.va * input.va /
                                                (params_.get_double("gravity") * input.rho_orbit));
  }
};

/// Roll from the course, pitch from the altitude, throttle from the airspeed.
class OwnController : public rosplane::ControllerStateMachine {
 public:
  OwnController() {
    params_.declare_double("climb_pitch", 0.2);  // [rad]
    params_.declare_double("max_roll", 0.6);     // [rad]
    params_.declare_double("trim_throttle", 0.5);
  }

 private:
  void take_off(const Input& input, Output& output) override {
    output.delta_t = 1.0F;
    fly(input, 0.0F, static_cast<float>(params_.get_double("climb_pitch")), output);
  }

  void climb(const Input& input, Output& output) override { take_off(input, output); }

  void altitude_hold(const Input& input, Output& output) override {
    const float error = input.h_c - input.h;
    sum_ = std::clamp(sum_ + 0.002F * error * input.Ts, -0.15F, 0.15F);
    const float turn =
        static_cast<float>(std::remainder(static_cast<double>(input.chi_c - input.chi), 2.0 * kPi));
    const auto max_roll = static_cast<float>(params_.get_double("max_roll"));
    const float pitch = std::clamp(0.02F * error, -0.2F, 0.2F) + sum_;
    const auto trim = static_cast<float>(params_.get_double("trim_throttle"));
    output.delta_t = std::clamp(trim + 0.1F * (input.va_c - input.va) + pitch, 0.0F, 1.0F);
    fly(input, std::clamp(input.phi_ff + 1.2F * turn, -max_roll, max_roll), pitch, output);
  }

  void fly(const Input& input, float roll, float pitch, Output& output) const {
    output.phi_c = roll;
    output.theta_c = pitch;
    output.delta_a = std::clamp(1.1F * (roll - input.phi) - 0.06F * input.p, -1.0F, 1.0F);
    output.delta_e = std::clamp(1.8F * (pitch - input.theta) - 0.15F * input.q, -1.0F, 1.0F);
  }

  void take_off_exit() override { RCLCPP_INFO(get_logger(), "left the ground"); }
  void climb_exit() override { sum_ = 0.0F; }
  void altitude_hold_exit() override {}

  float sum_{0.0F};
};

}  // namespace

int main(int argc, char** argv) {
  return run(argc, argv,
             {{"estimator", [] { return std::make_shared<OwnEstimator>(); }},
              {"path_manager", [] { return std::make_shared<OwnPathManager>(); }},
              {"path_follower", [] { return std::make_shared<OwnPathFollower>(); }},
              {"controller", [] { return std::make_shared<OwnController>(); }}});
}
