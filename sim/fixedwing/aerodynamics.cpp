// SPDX-License-Identifier: BSD-3-Clause
#include "sim/fixedwing/aerodynamics.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "sim/portable_math.hpp"

namespace rosflight::sim {
namespace {

/// 1/(1 + e^-x)
double logistic(double x) {
  return 1.0 / (1.0 + portable::exp(-x));
}

/// C_L, C_D and C_m as functions of the angle of attack alone.
struct Polar {
  double lift;
  double drag;
  double pitch;
};

Polar polar(const AirframeParameters& p, double alpha, double sine, double cosine, double separated,
            double induced) {
  const double attached = 1.0 - separated;
  const double lift = p.lift.zero + p.lift.alpha * alpha;
  const double aspect = p.span_m * p.span_m / p.area_m2;
  const double plate = 2.0 * sine * std::abs(sine);  // normal to it
  return {attached * lift + separated * plate * cosine,
          p.drag.parasitic + induced * attached * lift * lift / (base::kPi * p.oswald * aspect) +
              separated * plate * sine,
          attached * (p.pitch.zero + p.pitch.alpha * alpha) +
              separated * plate * p.pitch.alpha / p.lift.alpha};
}

/// A lateral coefficient times V^2; `damping` is b V/2.
double lateral(const LateralDerivatives& c, double v_squared, double beta, double damping,
               const Vector3& w_B, const Deflection& d) {
  return v_squared *
             (c.zero + c.beta * beta + c.aileron * d.aileron_rad + c.rudder * d.rudder_rad) +
         damping * (c.p * w_B.x() + c.r * w_B.z());
}

}  // namespace

double Airframe::separation(double alpha) const {
  if (p_.model == AeroModel::kReference) return 0.0;
  const double beyond = logistic(p_.stall_sharpness * (alpha - p_.stall_angle_rad));
  const double below = logistic(-p_.stall_sharpness * (alpha + p_.stall_angle_rad));
  return 1.0 - (1.0 - beyond) * (1.0 - below);
}

double Airframe::induced_share(double height_m) const {
  if (p_.ground_effect == WingGroundEffect::kNone) return 1.0;
  const double ratio = 16.0 * std::max(height_m, 0.0) / p_.span_m;
  return ratio * ratio / (1.0 + ratio * ratio);
}

double Airframe::lift_coefficient(double alpha) const {
  const portable::SinCos a = portable::sin_cos(alpha);
  return polar(p_, alpha, a.sin, a.cos, separation(alpha), 1.0).lift;
}

void Airframe::add_wrench(const Vector3& v_air_B, const Vector3& w_B, double density_kg_m3,
                          const Deflection& d, Wrench& wrench, double height_m) const {
  const double v_squared = v_air_B.squaredNorm();
  const double speed = std::sqrt(v_squared);
  const double in_plane = std::sqrt(v_air_B.x() * v_air_B.x() + v_air_B.z() * v_air_B.z());
  const double alpha = portable::atan2(v_air_B.z(), v_air_B.x());
  const double beta = portable::atan2(v_air_B.y(), in_plane);
  const double sine = in_plane > 0.0 ? v_air_B.z() / in_plane : 0.0;
  const double cosine = in_plane > 0.0 ? v_air_B.x() / in_plane : 1.0;
  const double scale = 0.5 * density_kg_m3 * p_.area_m2;
  const double q_damping = 0.5 * p_.chord_m * speed * w_B.y();
  const double span_damping = 0.5 * p_.span_m * speed;

  const Polar c = polar(p_, alpha, sine, cosine, separation(alpha), induced_share(height_m));
  const double lift =
      scale * (v_squared * (c.lift + p_.lift.elevator * d.elevator_rad) + q_damping * p_.lift.q);
  const double drag =
      scale * (v_squared * (c.drag + p_.drag.elevator * d.elevator_rad) + q_damping * p_.drag.q);
  const double pitch =
      v_squared * (c.pitch + p_.pitch.elevator * d.elevator_rad) + q_damping * p_.pitch.q;
  const Vector3 force_B(lift * sine - drag * cosine,
                        scale * lateral(p_.side, v_squared, beta, span_damping, w_B, d),
                        -drag * sine - lift * cosine);
  wrench.force_B += force_B;
  if (!p_.centre_B.isZero(0.0)) wrench.torque_B += p_.centre_B.cross(force_B);
  wrench.torque_B +=
      scale * Vector3(p_.span_m * lateral(p_.roll, v_squared, beta, span_damping, w_B, d),
                      p_.chord_m * pitch,
                      p_.span_m * lateral(p_.yaw, v_squared, beta, span_damping, w_B, d));
}

}  // namespace rosflight::sim
