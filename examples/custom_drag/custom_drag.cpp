// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdio>

#include "sim/multirotor/multirotor.hpp"
#include "sim/registry.hpp"

namespace {

using rosflight::sim::ForcesAndMoments;
using rosflight::sim::Vector3;

/// The project's multirotor and a force  F_k = -b_k v_k  along each body axis, v the velocity
/// through the air.
class LinearDragQuadrotor final : public ForcesAndMoments {
 public:
  explicit LinearDragQuadrotor(const rosflight::config::Section& vehicle)
      : rotors_(rosflight::sim::read_multirotor(vehicle)) {
    const auto drag = vehicle.section("linear_drag");
    const auto b =
        drag.numbers("coefficient_N_s_m", 3, rosflight::config::Range::between(0.0, 100.0));
    coefficient_N_s_m_ = {b[0], b[1], b[2]};
  }

  std::size_t state_size() const override { return rotors_.state_size(); }
  void initial_state(std::span<double> x) const override { rotors_.initial_state(x); }
  void evaluate(const Input& in, std::span<const double> x, rosflight::sim::Wrench& wrench,
                std::span<double> x_dot) const override {
    rotors_.evaluate(in, x, wrench, x_dot);
    wrench.force_B -= coefficient_N_s_m_.cwiseProduct(in.v_air_B);
  }
  void limit_state(std::span<double> x) const override { rotors_.limit_state(x); }
  void report(const Input& in, std::span<const double> x,
              rosflight::sim::Truth& truth) const override {
    rotors_.report(in, x, truth);
  }
  void set_thrust_factor(std::size_t rotor, double factor) override {
    rotors_.set_thrust_factor(rotor, factor);
  }

 private:
  rosflight::sim::Multirotor rotors_;
  Vector3 coefficient_N_s_m_;
};

/// Tells at the end of a flight how fast the vehicle was.
class PeakSpeed final : public rosflight::sim::Visualiser {
 public:
  PeakSpeed() = default;
  PeakSpeed(const PeakSpeed&) = delete;
  PeakSpeed& operator=(const PeakSpeed&) = delete;
  ~PeakSpeed() override { std::fprintf(stderr, "peak speed %.2f m/s\n", peak_m_s_); }

  void step(const rosflight::sim::Truth& truth,
            const rosflight::hal::OutputValues& /*outputs*/) override {
    peak_m_s_ = std::max(peak_m_s_, truth.body.v_B.norm());
  }

 private:
  double peak_m_s_{0.0};
};

}  // namespace

extern "C" void rosflight_register(rosflight::sim::Registry& registry) {
  registry.forces.add("linear_drag", [](const rosflight::sim::Vehicle& vehicle,
                                        const rosflight::sim::RandomSource&) {
    return std::make_unique<LinearDragQuadrotor>(vehicle.root());
  });
  registry.visualisers.add("peak_speed",
                           [](const rosflight::sim::Vehicle&, const rosflight::sim::RandomSource&) {
                             return std::make_unique<PeakSpeed>();
                           });
}
