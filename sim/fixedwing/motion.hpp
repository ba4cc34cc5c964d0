// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <span>

#include "sim/fixedwing/trim.hpp"

/// The equations of motion in the air as a function, for trim.cpp and modes.cpp.
namespace rosflight::sim::detail {

struct Motion {
  Vector3 v_B;
  Vector3 w_B;
  double roll_rad;
  double pitch_rad;
};

struct Acceleration {
  Vector3 v_dot_B;
  Vector3 w_dot_B;
  Wrench wrench;
};

/// Heading north.
Quaternion attitude(double roll_rad, double pitch_rad);

/// dv/dt and dw/dt in still air; dx/dt of the module into x_dot.
Acceleration accelerate(const TrimVehicle& vehicle, const Air& air, const Motion& motion,
                        const hal::OutputValues& outputs, std::span<const double> x,
                        std::span<double> x_dot);

}  // namespace rosflight::sim::detail
