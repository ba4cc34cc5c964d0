// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "config/strict_yaml.hpp"
#include "sim/types.hpp"

namespace rosflight::sim {

enum class GroundModel {
  kContact,            ///< Landing gear on a plane with friction.
  kFrictionlessPlane,  ///< ROSflight 2.x: acts on the centre of mass and only stops the fall.
  kNone
};

struct GroundParameters {
  GroundModel model{GroundModel::kNone};
  /// Points of the gear that may touch [m]; the last `wheels` of them roll along body x.
  std::vector<Vector3> contacts_B;
  std::size_t wheels{0};
  double stiffness_N_m{};  ///< Normal stiffness of each contact; likewise the next three.
  double damping_N_s_m{};
  double friction_stiffness_N_m{};  ///< Tangential, while it sticks.
  double friction_damping_N_s_m{};
  double friction{};          ///< Coulomb's coefficient; of a wheel, across its direction.
  double rolling_friction{};  ///< Friction of a wheel along its direction.
};

/// Reads section `ground`. Throws config::Error.
GroundParameters read_ground(const config::Section& section);

/// Flat ground at z_W = 0 under several points of the body.
///
/// On a point at depth d > 0 with velocity v (downwards v_z, in the plane v_t) act a spring and damper
/// that cannot pull, and friction:
///
///     N = max(0, k d + c v_z)                                                         (1)
///     F = -(k_t (p - a) + c_t v_t), cut to |F| <= mu N                                (2)
///
/// (2) holds the point at its anchor a, the position where it stuck, so a vehicle at rest does not
/// creep under a steady load, as it would with friction that depends on speed. A cut force means
/// sliding: end_step() moves a until (2) gives exactly mu N (return mapping of elasto-plasticity, J. Simo
/// and T. Hughes, "Computational Inelasticity", 1998, ch. 1). Anchors are fixed within a step, so
/// the right-hand side is smooth for the integrator.
///
/// A wheel rolls in the ground's plane along the body's x axis: there and across it (2) is cut each
/// by itself, at mu_r N and at mu N. Wheels neither turn nor brake.
///
/// A mass m on one contact rebounds from a hard fall with the fraction (3) of its speed; (2) stops a
/// slide after v^2/(2 mu g).
///
///     e = exp(-2 z/sqrt(1 - z^2) atan(sqrt(1 - z^2)/z)),   z = c/(2 sqrt(k m))        (3)
class GroundContact {
 public:
  /// @param parameters  as read_ground() checks them.
  explicit GroundContact(const GroundParameters& parameters);

  /// No point can touch while the centre of mass is higher than this [m].
  double reach_m() const { return reach_m_; }
  /// Height of the centre of mass of a level body of this weight at rest [m].
  double rest_height_m(double weight_N) const;
  /// Depth of the deepest point; negative in the air [m].
  double depth_m(const BodyState& body) const;

  /// Adds force and torque of all contacts.
  void add_wrench(const BodyState& body, const Matrix3& R_WB, Wrench& wrench) const;
  /// Moves anchors after a step. @returns whether any point touches.
  bool end_step(const BodyState& body, const Matrix3& R_WB);
  /// Clears all anchors.
  void lift() { anchors_.assign(anchors_.size(), Anchor{}); }

 private:
  struct Anchor {
    bool set{false};
    double x{};
    double y{};
  };
  /// Friction in the plane [N].
  struct Grip {
    double x_N;
    double y_N;
    bool slides;
  };
  struct Touch {
    double depth_m;
    double normal_N;
    double pull_x_N;  ///< (2) before the cut.
    double pull_y_N;
    double position_x;
    double position_y;
    double speed_x;
    double speed_y;
  };
  /// @returns false for a point in the air.
  bool touch(std::size_t i, const BodyState& body, const Matrix3& R_WB, Touch& t) const;
  /// (2), cut.
  Grip grip(std::size_t i, const Matrix3& R_WB, const Touch& t) const;

  GroundParameters parameters_;
  std::vector<Anchor> anchors_;
  double reach_m_{0.0};
};

}  // namespace rosflight::sim
