// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/dynamics/rigid_body.hpp"
#include "sim/multirotor/multirotor.hpp"
#include "sim/registry.hpp"

/// What the tests of the physics share.
namespace rosflight::sim::test {

inline const std::string kVehicleFile =
    "vehicles/multirotor.yaml";  // tests run in the root of the project

/// The options of ROSflight 2.x's simulator.
inline std::vector<std::string> reference_options() {
  return {"rotors.motor.model=instant",
          "rotors.flow=reference",
          "rotors.layout.0.position_m=[0.1767767, 0.1767767, 0]",
          "rotors.layout.1.position_m=[-0.1767767, 0.1767767, 0]",
          "rotors.layout.2.position_m=[-0.1767767, -0.1767767, 0]",
          "rotors.layout.3.position_m=[0.1767767, -0.1767767, 0]",
          "battery.model=constant",
          "battery.constant_voltage_V=24",
          "aero.ground_effect=polynomial",
          "aero.ground_effect_polynomial=[-55.3516, 181.8265, -203.9874, 85.3735, -7.6619]",
          "ground.model=frictionless_plane",
          "body.integration=frozen_forces",
          "environment.gravity_m_s2=9.81",
          "environment.atmosphere.model=constant",
          "environment.atmosphere.density_kg_m3=1.225"};
}

/// The default quadrotor with options, flying.
struct World {
  explicit World(const std::vector<std::string>& options = {}, std::uint64_t seed = 1)
      : vehicle{Vehicle::from_file(kVehicleFile, options)},
        random{seed},
        forces{read_multirotor(vehicle.root())},
        dynamics{vehicle.body(), vehicle.ground(), vehicle.environment(), forces, random} {}

  void run(double duration_s, const hal::OutputValues& outputs,
           Time step = hal::microseconds(2500)) {
    const Time end = dynamics.truth().time + hal::microseconds(std::llround(duration_s * 1e6));
    while (dynamics.truth().time < end)
      dynamics.step(std::min(dynamics.truth().time + step, end), outputs);
  }

  Vehicle vehicle;
  RandomSource random;
  Multirotor forces;
  RigidBody dynamics;
};

inline hal::OutputValues all_motors(double duty) {
  hal::OutputValues outputs{};
  for (std::size_t i = 0; i < 4; ++i) outputs[i] = static_cast<float>(duty);
  return outputs;
}

/// One evaluation of a forces-and-moments module at a given motion.
struct Evaluation {
  Wrench wrench;
  std::vector<double> rate;
  Truth truth;
};

inline Evaluation evaluate(const ForcesAndMoments& forces, const hal::OutputValues& outputs,
                           const std::vector<double>& states, const BodyState& body = {},
                           double height_m = 1000.0, const Air& air = {}) {
  Evaluation e;
  e.rate.resize(forces.state_size());
  const Matrix3 R_WB = body.q_WB.toRotationMatrix();
  const Vector3 v_air_B = body.v_B - R_WB.transpose() * air.wind_W;
  const ForcesAndMoments::Input in{body, R_WB, v_air_B, air, outputs, height_m};
  forces.evaluate(in, states, e.wrench, e.rate);
  forces.report(in, states, e.truth);
  return e;
}

inline std::vector<double> initial_states(const ForcesAndMoments& forces) {
  std::vector<double> x(forces.state_size());
  forces.initial_state(x);
  return x;
}

/// A module whose wrench is any function of the motion.
class Push final : public ForcesAndMoments {
 public:
  using Law = std::function<Wrench(const Input&)>;
  explicit Push(Law law = [](const Input&) { return Wrench{}; }) : law_{std::move(law)} {}
  std::size_t state_size() const override { return 0; }
  void initial_state(std::span<double>) const override {}
  void evaluate(const Input& in, std::span<const double>, Wrench& wrench,
                std::span<double>) const override {
    wrench = law_(in);
  }

 private:
  Law law_;
};

inline BodyParameters body(const Vector3& principal = {0.08, 0.10, 0.15}) {
  BodyParameters b;
  b.mass_kg = 2.0;
  b.inertia_kg_m2 = principal.asDiagonal();
  return b;
}

inline EnvironmentParameters environment(double gravity = 9.80665) {
  EnvironmentParameters e;
  e.gravity_m_s2 = gravity;
  return e;
}

/// Steps with all outputs at zero.
inline void run(RigidBody& dynamics, double duration_s, std::int64_t step_us = 2500) {
  const Time end = dynamics.truth().time + hal::microseconds(std::llround(duration_s * 1e6));
  while (dynamics.truth().time < end)
    dynamics.step(dynamics.truth().time + hal::microseconds(step_us), {});
}

inline constexpr RandomSource kRandom{1};

}  // namespace rosflight::sim::test
