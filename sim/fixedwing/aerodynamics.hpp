// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "config/strict_yaml.hpp"
#include "sim/types.hpp"

namespace rosflight::sim {

/// Combined deflection of the control surfaces, each positive by its derivative's convention: aileron
/// rolls right, elevator pitches down (trailing edge down), rudder yaws left, where C_ell_delta_a >
/// 0, C_m_delta_e < 0 and C_n_delta_r < 0.
struct Deflection {
  double aileron_rad{};
  double elevator_rad{};
  double rudder_rad{};
};

/// Coefficients of one symmetric quantity (lift, pitch moment): per radian, q by q c/2V.
struct SymmetricDerivatives {
  double zero{};
  double alpha{};
  double q{};
  double elevator{};
};

/// Drag besides what lift induces.
struct DragDerivatives {
  double parasitic{};
  double q{};
  double elevator{};
};

/// Coefficients of one lateral quantity (side force, roll and yaw moment); p, r by p b/2V, r b/2V.
struct LateralDerivatives {
  double zero{};
  double beta{};
  double p{};
  double r{};
  double aileron{};
  double rudder{};
};

enum class WingGroundEffect {
  kNone,
  kMcCormick  ///< The ground weakens what the tip vortices induce: (8).
};

enum class AeroModel {
  kStall,     ///< Stall, and the whole model down to rest.
  kReference  ///< ROSflight 2.x: lift linear at any angle; only thrust below 2 m/s.
};

/// Section `aero` of a fixed wing.
struct AirframeParameters {
  AeroModel model{AeroModel::kStall};
  double area_m2{};          ///< S
  double span_m{};           ///< b
  double chord_m{};          ///< c
  double oswald{};           ///< e
  double stall_angle_rad{};  ///< alpha_0 of (4)
  double stall_sharpness{};  ///< M of (4) [1/rad]
  WingGroundEffect ground_effect{WingGroundEffect::kNone};
  Vector3 centre_B{Vector3::Zero()};  ///< Where (7) acts, from the centre of mass [m].
  SymmetricDerivatives lift;
  DragDerivatives drag;
  SymmetricDerivatives pitch;
  LateralDerivatives side;
  LateralDerivatives roll;
  LateralDerivatives yaw;
};

/// Reads section `aero` of a fixed wing and finishes it. Throws config::Error.
AirframeParameters read_airframe(const config::Section& section);

/// Air on a rigid airframe.
///
/// Velocity through the air v_a = (u, v, w), V = |v_a|, q_bar = rho V^2/2:
///
///     alpha = atan2(w, u)             beta = asin(v/V)                                         (1)
///     L/(q_bar S) = C_L(alpha) + C_Lq c q/2V + C_L_de de                                       (2)
///     C_L = (1 - s)(C_L0 + C_La alpha) + s 2 sgn(alpha) sin^2 alpha cos alpha                  (3)
///     s = 1 - 1/((1 + e^(M (alpha - a0)))(1 + e^(-M (alpha + a0))))                            (4)
///     D/(q_bar S) = C_Dp + (1 - s)(C_L0 + C_La alpha)^2/(pi e b^2/S) + s 2 |sin^3 alpha|
///                   + C_Dq c q/2V + C_D_de de                                                  (5)
///     C_m = (1 - s)(C_m0 + C_ma alpha) + s (C_ma/C_La) 2 sgn(alpha) sin^2 alpha                (6)
///     F = (-D cos a + L sin a, Y, -D sin a - L cos a)                                          (7)
///
/// with the ground effect the induced drag of (5), the second term, times
///
///     phi = (16 h/b)^2/(1 + (16 h/b)^2)                                                        (8)
///
/// h being the height of the centre of mass (B. McCormick, "Aerodynamics, Aeronautics, and Flight
/// Mechanics", 1979, ch. 7), and C_m, C_Y, C_ell, C_n linear in beta, rates and deflections besides. (1)-(4), (7): R. Beard,
/// T. McLain, "Small Unmanned Aircraft", 2012, sec. 4.2, eq. 4.8-4.10 and 4.15-4.20. The plate's
/// drag in (5) and moment in (6) belong to the same plate as its lift in (3): Newtonian pressure 2
/// sin^2 alpha normal to it, acting at the neutral point C_ma/C_La, so that beyond the stall a wing
/// neither pulls forwards nor keeps a moment that grows with the angle for ever.
///
/// All terms with rates are multiplied out, so nothing is divided by V and the model holds at rest.
class Airframe {
 public:
  static constexpr double kHigh_m = 1e9;  ///< Out of ground effect.

  /// @param parameters  as read_airframe() checks them.
  explicit Airframe(const AirframeParameters& parameters) : p_{parameters} {}

  const AirframeParameters& parameters() const { return p_; }

  /// Adds force and torque about the centre of mass.
  void add_wrench(const Vector3& v_air_B, const Vector3& w_B, double density_kg_m3,
                  const Deflection& deflection, Wrench& wrench, double height_m = kHigh_m) const;

  /// phi of (8); 1 without a ground effect.
  double induced_share(double height_m) const;
  /// s of (4); 0 for ROSflight 2.x's model.
  double separation(double alpha_rad) const;
  /// (3) without rates and elevator.
  double lift_coefficient(double alpha_rad) const;

 private:
  AirframeParameters p_;
};

}  // namespace rosflight::sim
