// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

#include "sim/lanes.hpp"
#include "sim/modules.hpp"
#include "sim/multirotor/multirotor_parameters.hpp"

namespace rosflight::sim {

/// Forces and moments of a vehicle with fixed-pitch rotors anywhere, in any direction.
///
/// Rotor with thrust direction e; air velocity at its hub v = v_air + w x p, along it V = v.e,
/// across it v' = v - V e; rotor speed O and u = 2 pi V/D:
///
///     T = rho D^4/(4 pi^2) (CT0 O^2 + CT1 O u + CT2 u^2)                              (1)
///     Q = rho D^5/(4 pi^2) (CQ0 O^2 + CQ1 O u + CQ2 u^2)                              (2)
///     F = k T e - C_r max(T, 0) v'                                                    (3)
///
/// (1), (2) are C_T(J), C_Q(J) with J = u/O multiplied out, so they hold at O = 0. In descent
/// (u < 0) the square is left out, a continuation along the tangent, and u stops at
/// -descent_limit O. The second part of (3) is the rotor's H-force. k is the ground effect,
/// 1/(1 - (R/4z)^2) with z >= R/2 (I. C. Cheeseman, W. E. Bennett, ARC R&M 3021, 1955).
///
/// With the momentum inflow (inflow.hpp), a thrust T of (1), its induced velocity v_a in axial flight and v
/// in the flight at hand, A the disc:
///
///     T' = T + rho a O (v_a - v)        Q' = Q + (T' (V + v) - T (V + v_a))/O         (7)
/// with the lift slope a of inflow.hpp. In axial flight (7) is (1), (2). Flapping tilts the disc back by
///
///     a1 = mu (4 theta_t - 2 lambda)/(1 - mu^2/2),   mu = |v'|/(O R),   lambda = (V + v)/(O R)     (8)
///
/// (P. Pounds, R. Mahony, P. Corke, "Modelling and control of a large quadrotor robot", Control Eng.
/// Practice 18, 2010, sec. 3; ideally twisted blades). It adds T a1 against v', and k a1 about e x -v'.
/// The lateral tilt b1 is left out. Beyond mu 0.5, where the retreating blade stalls, a1 fades with the
/// square of the rotor's speed; a rotor at rest does not flap.
///
/// Motor and ESC, duty d, battery voltage V_b, K_Q = K_V in SI:
///
///     I = (d V_b - K_V O)/R        tau_m = K_Q (I - I0)        J_r dO/dt = tau_m - Q  (4)
///     V_b = U0(charge) - R_b I_b   I_b = sum d I + I_avionics                         (5)
///
/// (4) and (5) are solved together, being linear in V_b; limits of the current are applied
/// afterwards. d = 0 lets the rotor wheel freely: no current, and its friction K_Q I0 and Q stop
/// it.
///
/// On the body act F, p x F, the motors' reaction spin e (Q + J_r dO/dt), the gyroscopic torque
/// -w x h with h = -sum spin J_r O e, and the drag -1/2 rho |v| (C_D A)_k v_k along each axis k.
/// Rotor model after ROSflight 2.x (simulator, multirotor forces) and R. Beard, T. McLain, "Small
/// Unmanned Aircraft", suppl. 4.3; options reproduce its steady state, its flow and its ground
/// effect exactly.
///
/// A tilting rotor's direction e is turned by the angle delta of its servo, which follows its command
/// c = travel (2 output - 1) as a control surface does (FixedWing):
///
///     d delta/dt = max(-r, min(r, (c - delta)/tau))                                   (6)
///
/// A servo whose output is NaN keeps its angle. The torque that turns the spinning rotor is left out.
///
/// States: rotor speeds [rad/s], charge [A s], then tilt angles [rad]. No heap in a step; about 550 instructions an
/// evaluation of four rotors on a processor with AVX2.
class Multirotor final : public ForcesAndMoments {
 public:
  /// @param parameters  as read_multirotor() checks them.
  explicit Multirotor(const MultirotorParameters& parameters);

  std::size_t state_size() const override { return rotors_ + 1 + tilts_.size(); }
  void initial_state(std::span<double> x) const override;
  void evaluate(const Input& in, std::span<const double> x, Wrench& wrench,
                std::span<double> x_dot) const override;
  void limit_state(std::span<double> x) const override;
  void report(const Input& in, std::span<const double> x, Truth& truth) const override;
  /// Thrust and torque of the propeller shrink alike; at 0 the ESC is dead and the rotor runs down.
  void set_thrust_factor(std::size_t rotor, double factor) override;
  void set_charge_limit(double share) override { charge_limit_ = share; }
  /// Surface i is the i-th tilting rotor.
  void set_surface_stuck(std::size_t surface, bool stuck) override;

 private:
  /// Rotors are worked on four at a time; missing ones have no thrust, torque or current.
  static constexpr std::size_t kLanes = 4;
  static constexpr std::size_t kGroups = (kMaxRotors + kLanes - 1) / kLanes;
  using PerRotor = std::array<Lanes, kGroups>;

  struct Group {
    Vector3Lanes p_B, e_B, p_cross_e_B;
    Lanes spin;
    Lanes factor;  ///< Factor of thrust and torque; 1 if dead.
    Lanes alive;   ///< 1, or 0: no output reaches the ESC.
    std::array<std::size_t, kLanes> output;
  };
  struct Tilt {
    std::size_t rotor;
    Vector3 p_B, e_B;
    TiltParameters servo;
    bool stuck;
  };
  using Groups = std::array<Group, kGroups>;
  /// Electric side of one moment.
  struct Supply {
    PerRotor duty;
    PerRotor current_A;
    double voltage_V;
    double current_sum_A;  ///< At the battery.
  };
  struct Blades {
    Lanes thrust_N;
    Lanes torque_Nm;
  };

  // What evaluate() and report() do; GCC does not compile a virtual function twice.
  void compute(const Input& in, std::span<const double> x, Wrench& wrench,
               std::span<double> x_dot) const;
  void fill_truth(const Input& in, std::span<const double> x, Truth& truth) const;
  template <std::size_t kFixed>
  void compute_groups(const Input& in, std::span<const double> x, Wrench& wrench,
                      std::span<double> x_dot) const;
  template <std::size_t kFixed>
  std::size_t group_count() const {
    return kFixed != 0 ? kFixed : groups_;
  }

  static void aim(Group& group, std::size_t lane, const Vector3& p_B, const Vector3& e_B);
  /// The rotors with the directions that the tilt angles of x give them; `turned` holds them if any tilts.
  const Groups& directed(std::span<const double> x, Groups& turned) const;
  template <std::size_t kFixed>
  void load(std::span<const double> x, PerRotor& speed) const;
  template <std::size_t kFixed>
  void supply(const hal::OutputValues& outputs, const PerRotor& speed, double charge_As,
              Supply& now) const;
  Vector3Lanes hub_velocity(const Input& in, const Group& group) const;
  /// Air velocity along the thrust direction.
  Lanes inflow(const Input& in, const Group& group, const Vector3Lanes& hub) const;
  Blades blades(const Lanes& speed, const Lanes& u, double density, const Lanes& factor) const;
  Lanes steady_speed(const Lanes& drive_V, const Lanes& speed, const Lanes& u, double density,
                     const Lanes& factor) const;
  /// (7), and the coefficient of the drag that (8) adds [s/m].
  struct Disc {
    Blades blades;
    Lanes flapping_s_m;
  };
  Disc disc(const Blades& axial, const Lanes& speed, const Lanes& along, const Lanes& across_sq,
            double density, const Lanes& factor) const;
  Lanes ground_factor(const Input& in, const Group& group) const;
  Lanes acceleration(const Lanes& speed, const Lanes& current_A, const Lanes& torque_Nm) const;

  Groups group_;
  std::vector<Tilt> tilts_;
  std::size_t rotors_;
  std::size_t groups_;
  double charge_limit_{1.0};
  double extent_m_{0.0};  ///< No hub is farther from the centre of mass.
  PropellerParameters propeller_;
  MotorParameters motor_;
  bool reference_flow_;
  bool airspeed_flow_;
  bool momentum_;
  bool off_centre_;  ///< The drag has an arm.
  Battery battery_;
  AeroParameters aero_;
  double thrust_per_density_;  ///< D^4/(4 pi^2)
  double flow_per_speed_;      ///< 2 pi/D
  double per_resistance_;
  double per_inertia_;
  double disc_m2_;
  double lift_slope_;  ///< a of (7) [m^3].
};

}  // namespace rosflight::sim
