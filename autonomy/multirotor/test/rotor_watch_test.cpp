// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/rotor_watch.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <random>
#include <vector>

#include "autonomy/multirotor/test/plant.hpp"

namespace rosflight::autonomy::multirotor {
namespace {

constexpr double kDragPerThrust_m = 0.0187;
constexpr double kMass_kg = 4.0;

/// Rotors on arms at these angles, spins alternating; the mixer as the firmware's predefined ones: the
/// pseudo-inverse of [1/n, -sin, cos, yaw].
RotorWatchConfig frame(const std::vector<double>& angles_deg, double arm_m) {
  RotorWatchConfig config;
  const auto n = static_cast<Eigen::Index>(angles_deg.size());
  Eigen::MatrixXd M(4, n);
  for (std::size_t i = 0; i < angles_deg.size(); ++i) {
    const double angle = angles_deg[i] * kRadPerDeg;
    const double spin = i % 2 == 0 ? -1.0 : 1.0;
    M.col(static_cast<Eigen::Index>(i)) << 1.0 / static_cast<double>(n), -std::sin(angle),
        std::cos(angle), -spin;
    config.rotors.push_back({Vector3(arm_m * std::cos(angle), arm_m * std::sin(angle), -0.08),
                             -Vector3::UnitZ(),
                             spin,
                             i,
                             {}});
  }
  const Eigen::MatrixXd K = M.completeOrthogonalDecomposition().pseudoInverse();
  for (std::size_t i = 0; i < config.rotors.size(); ++i)
    for (Eigen::Index axis = 0; axis < 4; ++axis)
      config.rotors[i].gain[static_cast<std::size_t>(axis)] = K(static_cast<Eigen::Index>(i), axis);
  config.inertia_kg_m2 = Vector3(0.17, 0.17, 0.3).asDiagonal();
  RotorData rotors = test::default_rotors();
  rotors.count = static_cast<int>(config.rotors.size());
  config.curve = ThrustModel::curve_of(rotors);
  config.drag_per_thrust_m = kDragPerThrust_m;
  config.weight_N = kMass_kg * 9.81;
  return config;
}

RotorWatchConfig hexa() {
  return frame({0, 60, 120, 180, 240, 300}, 0.4);
}
RotorWatchConfig octo() {
  return frame({0, 45, 90, 135, 180, 225, 270, 315}, 0.5);
}
RotorWatchConfig y6() {
  return frame({60, 60, 180, 180, 300, 300}, 0.25);
}
RotorWatchConfig x8() {
  return frame({45, 45, 135, 135, 225, 225, 315, 315}, 0.25);
}

/// A body that turns freely under its rotors, all at the output that hovers, each with a share of its
/// thrust from 3 s on.
struct Flight {
  explicit Flight(RotorWatchConfig of) : config{std::move(of)}, watch{config} {
    const double output = ThrustModel(config.curve, {}).throttle(config.weight_N);
    outputs.assign(config.rotors.size(), static_cast<float>(output));
    factor.assign(config.rotors.size(), 1.0);
  }

  /// @returns when the loss was found, after 3 s [s]; NaN: never.
  double run(double until_s) {
    constexpr double dt_s = 0.01;
    const double hover_thrust_N = config.weight_N / static_cast<double>(config.rotors.size());
    std::mt19937 generator(7);
    std::normal_distribution<double> noise(0.0, gyro_noise_rad_s);
    double found = std::numeric_limits<double>::quiet_NaN();
    Vector3 w = Vector3::Zero();
    for (double t = 0.0; t < 3.0 + until_s; t += dt_s) {
      Vector3 torque = disturbance_Nm;
      for (std::size_t i = 0; i < config.rotors.size(); ++i) {
        const auto& rotor = config.rotors[i];
        const double thrust_N = hover_thrust_N * (t < 3.0 ? 1.0 : factor[i]);
        torque +=
            thrust_N * (rotor.p_B.cross(rotor.e_B) + kDragPerThrust_m * rotor.spin * rotor.e_B);
      }
      w += dt_s * config.inertia_kg_m2.inverse() * (torque - w.cross(config.inertia_kg_m2 * w));
      const Vector3 seen = w + Vector3(noise(generator), noise(generator), noise(generator));
      if (watch.step({outputs, seen, Vector3::Zero(), 0.0, dt_s}) && std::isnan(found))
        found = t - 3.0;
    }
    return found;
  }

  RotorWatchConfig config;
  RotorWatch watch;
  std::vector<float> outputs;
  std::vector<double> factor;
  Vector3 disturbance_Nm{Vector3::Zero()};
  double gyro_noise_rad_s{0.005};
};

TEST(RotorWatch, FindsEachDeadRotorSoon) {
  for (const RotorWatchConfig& config : {hexa(), octo(), y6(), x8()}) {
    for (std::size_t dead = 0; dead < config.rotors.size(); ++dead) {
      SCOPED_TRACE(testing::Message() << config.rotors.size() << " rotors, dead " << dead);
      Flight flight(config);
      flight.factor[dead] = 0.0;
      EXPECT_LT(flight.run(0.8), 0.7);
      ASSERT_TRUE(flight.watch.lost());
      EXPECT_EQ(*flight.watch.lost(), dead);
    }
  }
}

TEST(RotorWatch, IsSilentWithoutALoss) {
  for (const RotorWatchConfig& config : {hexa(), octo(), y6(), x8()}) {
    Flight weak(config);
    weak.factor[1] = 0.7;
    EXPECT_TRUE(std::isnan(weak.run(3.0))) << "a rotor with 0.7 of its thrust";
    Flight all(config);
    all.factor.assign(config.rotors.size(), 0.6);
    EXPECT_TRUE(std::isnan(all.run(3.0))) << "all of them weak, as on an empty battery";
    Flight noisy(config);
    noisy.gyro_noise_rad_s = 0.03;
    EXPECT_TRUE(std::isnan(noisy.run(10.0)));
  }
}

TEST(RotorWatch, ASteadyTorqueIsLearned) {
  Flight flight(hexa());
  flight.disturbance_Nm = {0.05, -0.05, 0.02};
  flight.factor[4] = 0.0;
  EXPECT_LT(flight.run(0.8), 0.7);
  EXPECT_EQ(flight.watch.lost(), 4U);
}

TEST(RotorWatch, WithoutOutputsNothingIsFound) {
  Flight flight(hexa());
  flight.factor[0] = 0.0;
  flight.outputs.clear();
  EXPECT_TRUE(std::isnan(flight.run(1.0)));
}

// A hexarotor with alternating spins cannot be held in yaw with one rotor lost (Du et al. 2015); eight
// rotors can. On a Y6 the mixer asks the dead rotor for three times the output of hover.
TEST(RotorWatch, SaysWhetherYawIsLeft) {
  for (std::size_t j = 0; j < 6; ++j) {
    EXPECT_FALSE(RotorWatch(hexa()).yaw_without(j)) << j;
    EXPECT_FALSE(RotorWatch(y6()).yaw_without(j)) << j;
  }
  for (std::size_t j = 0; j < 8; ++j) {
    EXPECT_TRUE(RotorWatch(octo()).yaw_without(j)) << j;
    EXPECT_TRUE(RotorWatch(x8()).yaw_without(j)) << j;
  }
}

}  // namespace
}  // namespace rosflight::autonomy::multirotor
