// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "sim/fixedwing/aerodynamics.hpp"
#include "sim/modules.hpp"
#include "sim/multirotor/multirotor.hpp"

namespace rosflight::sim {

/// One servo with its control surface.
struct SurfaceParameters {
  std::size_t output{};  ///< Channel of the firmware that drives it: 0..1, 0.5 in the centre.
  double travel_rad{};   ///< Deflection at either end.
  /// Aileron, elevator and rudder that a deflection of 1 rad amounts to.
  Vector3 effect{Vector3::Zero()};
};

struct FixedWingParameters {
  AirframeParameters airframe;
  MultirotorParameters propulsion;
  std::vector<SurfaceParameters> surfaces;
  double servo_time_constant_s{};  ///< 0: deflections follow at once.
  double servo_rate_limit_rad_s{};
};

/// Reads sections `aero`, `surfaces`, `rotors` and `battery` of a vehicle file. Throws
/// config::Error.
FixedWingParameters read_fixed_wing(const config::Section& vehicle);

/// Forces and moments of an aircraft with fixed wings: airframe (aerodynamics.hpp), propulsion
/// (multirotor.hpp: propellers, motors, battery in any number and direction) and servos.
///
/// A servo follows its command c (travel times 2 output - 1) with a lag and a limit of its rate:
///
///     d delta/dt = max(-r, min(r, (c - delta)/tau))                                           (1)
///     (aileron, elevator, rudder) = sum over surfaces  effect delta                            (2)
///
/// (2) serves any layout: on an inverted V-tail both surfaces act as elevator (-1, +1) and as
/// rudder (+1, +1), elevons as elevator and aileron. A servo whose output is NaN keeps its position.
///
/// With the aerodynamics of ROSflight 2.x only thrust acts below 2 m/s, and none below 1 % throttle.
///
/// States: rotor speeds [rad/s], charge [A s], deflections [rad]. No heap in a step.
class FixedWing final : public ForcesAndMoments {
 public:
  /// @param parameters  as read_fixed_wing() checks them.
  explicit FixedWing(const FixedWingParameters& parameters);

  std::size_t state_size() const override { return propulsion_size_ + parameters_.surfaces.size(); }
  void initial_state(std::span<double> x) const override;
  void evaluate(const Input& in, std::span<const double> x, Wrench& wrench,
                std::span<double> x_dot) const override;
  void limit_state(std::span<double> x) const override;
  void report(const Input& in, std::span<const double> x, Truth& truth) const override;
  void set_thrust_factor(std::size_t rotor, double factor) override;
  void set_surface_stuck(std::size_t surface, bool stuck) override;
  void set_charge_limit(double share) override { propulsion_.set_charge_limit(share); }

  const FixedWingParameters& parameters() const { return parameters_; }
  const Airframe& airframe() const { return airframe_; }
  /// (2) at states x.
  Deflection deflection(const hal::OutputValues& outputs, std::span<const double> x) const;

 private:
  /// Angle of servo i: its state or, without a lag, its command.
  double servo_rad(std::size_t i, const hal::OutputValues& outputs,
                   std::span<const double> x) const;

  FixedWingParameters parameters_;
  Airframe airframe_;
  Multirotor propulsion_;
  std::size_t propulsion_size_;
  std::vector<bool> stuck_;  ///< By surface; without a lag a stuck one is at its centre.
};

}  // namespace rosflight::sim
