// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/quadplane/controller.hpp"

#include <algorithm>
#include <cmath>

#include "autonomy/common/angles.hpp"

namespace rosflight::autonomy::quadplane {
namespace {

constexpr double kMaxVertical_m_s2 = 4.0;
constexpr double kForceIntegral_1_s2 = 0.5;
constexpr double kMaxForceIntegral_m_s2 = 3.0;
constexpr double kTorqueIntegral_1_s3 = 12.0;
constexpr double kMaxTorqueIntegral_rad_s2 = 4.0;
constexpr double kMinAlpha_rad = -5.0 * kRadPerDeg;
const Vector3 kMaxAngular_rad_s2{10.0, 8.0, 3.0};
constexpr double kSurfacesFrom_m_s = 5.0;  // below it they do little
constexpr double kSurfacesAll_m_s = 8.0;
constexpr double kAlphaMargin_rad = 3.0 * kRadPerDeg;
constexpr double kMaxGust_rad = 10.0 * kRadPerDeg;  // 2.8 m/s at 16 m/s: 3.5 sigma of W20 = 8 m/s
constexpr double kMaxDive_rad = 15.0 * kRadPerDeg;
constexpr double kNoseTakes_s = 0.5;  // to where it should be
constexpr double kLiftAverage_s = 0.08;
constexpr double kPusherShare = 0.95;
constexpr double kSpareLift = 0.1;  // of the weight: less is not worth starting rotors in cruise

double ramp(double x, double low, double high) {
  return std::clamp((x - low) / (high - low), 0.0, 1.0);
}

/// A rotor at the same speed lifts more where it meets fresh air. Half of its hover's share at 2 v_h, about 9 m/s,
/// by momentum theory with the blades' slope (sim/multirotor/inflow.hpp); the loops correct the rest.
double translational(double forward_m_s) {
  constexpr double kAtHigh = 0.45;
  constexpr double kHalf_m_s = 8.0;
  const double v_sq = forward_m_s * forward_m_s;
  return 1.0 + kAtHigh * v_sq / (v_sq + kHalf_m_s * kHalf_m_s);
}

Quaternion attitude(double roll, double pitch, double yaw) {
  return Quaternion(Eigen::AngleAxisd(yaw, Vector3::UnitZ()) *
                    Eigen::AngleAxisd(pitch, Vector3::UnitY()) *
                    Eigen::AngleAxisd(roll, Vector3::UnitX()));
}

/// Small rotation from the present to the wanted attitude, in B.
Vector3 attitude_error(const StateEstimate& state, const Quaternion& wanted) {
  Quaternion error = state.q_WB.conjugate() * wanted;
  if (error.w() < 0.0) error.coeffs() *= -1.0;
  return 2.0 * error.vec();
}

}  // namespace

void Controller::reset(const StateEstimate& state) {
  force_integral_.setZero();
  torque_integral_.setZero();
  air_force_N_ = air(state).lift_force_N;
  nose_force_N_ = 0.0;
  heading_rad_ = heading_of(state.q_WB);
}

Controller::Air Controller::air(const StateEstimate& state) const {
  const VehicleFacts& f = config_.vehicle;
  const Vector3 v_B = state.q_WB.conjugate() * (state.v_W - state.wind_W);
  Air out;
  out.forward_m_s = v_B.x();
  const double in_plane_sq = v_B.x() * v_B.x() + v_B.z() * v_B.z();
  if (v_B.x() < 1.0) return out;  // nothing on the wing counts yet
  out.alpha_rad = std::atan2(v_B.z(), v_B.x());
  out.pressure_force_N = 0.5 * f.density_kg_m3 * f.wing_area_m2 * in_plane_sq;
  out.share = ramp(out.forward_m_s, kBlendLow_m_s, kBlendHigh_m_s);
  const double k = f.stall_sharpness_1_rad;
  const double beyond = 1.0 / (1.0 + std::exp(-k * (out.alpha_rad - f.stall_alpha_rad)));
  const double below = 1.0 / (1.0 + std::exp(k * (out.alpha_rad + f.stall_alpha_rad)));
  const double separated = 1.0 - (1.0 - beyond) * (1.0 - below);
  out.attached = 1.0 - separated;
  const double sine = std::sin(out.alpha_rad);
  const double plate = 2.0 * sine * std::abs(sine);
  const double attached = f.lift_zero + f.lift_alpha_1_rad * out.alpha_rad;
  const double lift = (1.0 - separated) * attached + separated * plate * std::cos(out.alpha_rad);
  const double drag = f.drag_parasitic + (1.0 - separated) * f.drag_induced * attached * attached +
                      separated * plate * sine;
  out.lift_force_N = out.pressure_force_N * lift;
  // Less lift than any gust leaves is a wing that has stalled: its moment is that of the angle that is known.
  const double met_rad = (air_force_N_ / out.pressure_force_N - f.lift_zero) / f.lift_alpha_1_rad;
  const double gust_rad = std::clamp(met_rad - out.alpha_rad, -kMaxGust_rad, kMaxGust_rad);
  const double stalled = ramp(out.alpha_rad - met_rad, kMaxGust_rad, 1.5 * kMaxGust_rad);
  out.met_rad = out.alpha_rad + (1.0 - stalled) * gust_rad;
  out.drag_force_N = out.pressure_force_N * drag;
  return out;
}

/// What the accelerometer shows along body z and the rotors do not explain. Both are averaged over the same time.
void Controller::measure_lift(const StateEstimate& state, double dt_s) {
  const double share = std::min(1.0, dt_s / kLiftAverage_s);
  const double whole_force_N = -config_.vehicle.mass_kg * state.a_B.z();
  air_force_N_ += share * (whole_force_N - out_.lift_force_N - air_force_N_);
}

/// (1), in W.
Vector3 Controller::wanted_force(const StateEstimate& state, const Command& in, double dt_s) {
  const FlightConfig& c = config_;
  const Vector3 gain{c.velocity_1_s, c.velocity_1_s, c.vertical_speed_1_s};
  const Vector3 error = in.v_W - state.v_W;
  if (in.on_ground) {
    force_integral_.setZero();
  } else {
    force_integral_ += kForceIntegral_1_s2 * dt_s * error;
    force_integral_ =
        force_integral_.cwiseMax(-kMaxForceIntegral_m_s2).cwiseMin(kMaxForceIntegral_m_s2);
  }
  Vector3 a_W = in.a_ff_W + gain.cwiseProduct(error) + force_integral_;
  const double g = c.vehicle.gravity_m_s2;
  const double largest = g * std::tan(c.max_bank_rad);
  const double horizontal = a_W.head<2>().norm();
  if (horizontal > largest) a_W.head<2>() *= largest / horizontal;
  a_W.z() = std::clamp(a_W.z(), -kMaxVertical_m_s2, kMaxVertical_m_s2);
  return c.vehicle.mass_kg * (a_W - g * Vector3::UnitZ());
}

/// Moves the commanded heading. @returns its rate.
double Controller::turn_heading(double heading_rad, double dt_s) {
  const double most = config_.yaw_rate_rad_s * dt_s;
  const double step = std::clamp(wrap_angle(heading_rad - heading_rad_), -most, most);
  heading_rad_ = wrap_angle(heading_rad_ + step);
  return dt_s > 0.0 ? step / dt_s : 0.0;
}

void Controller::integrate_attitude(const StateEstimate& state, const Quaternion& wanted,
                                    bool on_ground, double dt_s) {
  if (on_ground) {
    torque_integral_.setZero();
    return;
  }
  torque_integral_ += kTorqueIntegral_1_s3 * dt_s * attitude_error(state, wanted);
  torque_integral_ =
      torque_integral_.cwiseMax(-kMaxTorqueIntegral_rad_s2).cwiseMin(kMaxTorqueIntegral_rad_s2);
}

Vector3 Controller::torque(const StateEstimate& state, const Quaternion& wanted, double turn_rad_s,
                           const Air& air) const {
  const FlightConfig& c = config_;
  const VehicleFacts& f = c.vehicle;
  const Vector3 e = attitude_error(state, wanted);
  const Vector3 k{c.roll_pitch_1_s, c.roll_pitch_1_s, c.yaw_1_s};
  const Vector3 k_rate{c.roll_pitch_rate_1_s, c.roll_pitch_rate_1_s, c.yaw_rate_1_s};
  const Vector3 turn_B = state.q_WB.conjugate() * Vector3(0.0, 0.0, turn_rad_s);
  Vector3 angular = k_rate.cwiseProduct(k.cwiseProduct(e) + turn_B - state.w_B) + torque_integral_;
  angular = angular.cwiseMax(-kMaxAngular_rad_s2).cwiseMin(kMaxAngular_rad_s2);
  const Vector3 spin = state.w_B.cross(f.inertia_kg_m2 * state.w_B);
  Vector3 by_air = Vector3::Zero();
  if (air.forward_m_s > kBlendLow_m_s) {
    const double half = 0.5 / air.forward_m_s;
    by_air.x() = air.pressure_force_N * f.span_m * f.roll_p * state.w_B.x() * f.span_m * half;
    by_air.y() = air.pressure_force_N * f.chord_m *
                 (f.pitch_zero + f.pitch_alpha_1_rad * air.met_rad +
                  f.pitch_q * state.w_B.y() * f.chord_m * half);
    by_air.z() = air.pressure_force_N * f.span_m * f.yaw_r * state.w_B.z() * f.span_m * half;
  }
  return f.inertia_kg_m2 * angular + spin - air.share * air.attached * by_air;
}

void Controller::allocate(const Vector3& torque_B, const Air& air) {
  const VehicleFacts& f = config_.vehicle;
  const double share = ramp(air.forward_m_s, kSurfacesFrom_m_s, kSurfacesAll_m_s);
  const Vector3 full =
      air.pressure_force_N * Vector3(f.span_m, f.chord_m, f.span_m).cwiseProduct(f.surface);
  const double weight_N = f.mass_kg * f.gravity_m_s2;
  const double rotors = ramp(out_.lift_force_N, 0.05 * weight_N, 0.3 * weight_N);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const double surface = share > 0.0 ? share * std::clamp(torque_B(i) / full(i), -1.0, 1.0) : 0.0;
    out_.command.u[6 + k] = static_cast<float>(surface);
    out_.command.u[3 + k] = static_cast<float>(rotors * (torque_B(i) - surface * full(i)));
  }
}

/// The static thrust of the speed at which the pusher gives this thrust in flight.
double Controller::static_thrust(double thrust_N, double forward_m_s) const {
  const VehicleFacts& f = config_.vehicle;
  if (!(thrust_N > 0.0)) return 0.0;
  const double d = f.pusher_diameter_m;
  const double scale = f.density_kg_m3 * d * d * d * d;
  const double u = std::max(forward_m_s, 0.0) / d;
  const auto& c = f.pusher_thrust;
  const double b = 0.5 * c[1] * u / c[0];
  const double n = -b + std::sqrt(std::max(0.0, b * b + (thrust_N / scale - c[2] * u * u) / c[0]));
  return scale * c[0] * n * n;
}

const Controller::Output& Controller::step(const StateEstimate& state, const Command& in,
                                           double dt_s) {
  const FlightConfig& c = config_;
  const double weight_N = c.vehicle.mass_kg * c.vehicle.gravity_m_s2;
  measure_lift(state, dt_s);
  out_ = Output{};
  const double turn_rad_s = turn_heading(in.heading_rad, dt_s);
  const Air now = air(state);
  out_.airspeed_m_s = now.forward_m_s;
  const Vector3 f_W = wanted_force(state, in, dt_s);
  const double heading = heading_of(state.q_WB);
  const double forward_force_N = f_W.x() * std::cos(heading) + f_W.y() * std::sin(heading);
  const double right_force_N = f_W.y() * std::cos(heading) - f_W.x() * std::sin(heading);
  const double up_force_N = -f_W.z();
  const double roll =
      std::clamp(std::atan2(right_force_N, up_force_N), -c.max_bank_rad, c.max_bank_rad);

  const double normal_force_N = up_force_N / std::cos(roll);
  double alpha = 0.0;
  if (now.share > 0.0) {
    alpha =
        (normal_force_N / now.pressure_force_N - c.vehicle.lift_zero) / c.vehicle.lift_alpha_1_rad;
    alpha = std::clamp(alpha, kMinAlpha_rad, c.max_alpha_rad);
  }
  double for_wing = 0.0;
  const double pitch_now = RollPitch::of(state.q_WB).pitch_rad;
  if (now.share > 0.0) {
    const double climb = std::atan2(-in.v_W.z(), now.forward_m_s);
    const double climbs = std::atan2(-state.v_W.z(), now.forward_m_s);
    // The limit is a guard: a vehicle that sinks in air at rest, or meets a gust from below, is not pitched up into the
    // stall. Beyond the stall the measured lift shows too small an angle; what is known of the path limits it then.
    const double flow_rad = std::max(-kMaxDive_rad, std::min(climbs, pitch_now - now.met_rad));
    const double highest = flow_rad + c.max_alpha_rad + kAlphaMargin_rad;
    for_wing = now.share * std::min(alpha + climb, highest);
  }
  const double rotor_force_N = std::max(normal_force_N - air_force_N_, 0.0);
  // The pusher only pushes: what is too much without it, the rotors brake.
  const double excess_force_N =
      std::max(0.0, -now.drag_force_N - rotor_force_N * std::sin(for_wing) - forward_force_N);
  const double brake = ramp(rotor_force_N, 0.0, 0.5 * weight_N) *
                       std::atan2(excess_force_N, std::max(rotor_force_N, 0.2 * weight_N));
  const double pitch = std::max(for_wing, std::min(for_wing + brake, c.max_hover_tilt_rad));

  // Air forces act along and across the flow in the plane of symmetry.
  const double ca = std::cos(now.alpha_rad);
  const double sa = std::sin(now.alpha_rad);
  const Vector3 air_B(now.lift_force_N * sa - now.drag_force_N * ca, 0.0, -air_force_N_);
  const Vector3 rest_B = state.q_WB.conjugate() * f_W - air_B;
  // On the wing alone the rotors add what the wing cannot, not what it lacks for a moment: the lift that comes with the
  // nose still on its way. A wing that does not lift where its nose should be has stalled.
  const double wing_only_m_s = c.vehicle.stall_speed_m_s() * c.wing_only_stalls;
  const double wing_only = now.attached * ramp(now.forward_m_s, wing_only_m_s - 1.0, wing_only_m_s);
  const double slope_force_N = now.pressure_force_N * c.vehicle.lift_alpha_1_rad;
  const double lacks_force_N =
      now.pressure_force_N * c.vehicle.lift_zero + slope_force_N * alpha - air_force_N_;
  const double nose_force_N = std::max(0.0, slope_force_N * (pitch - pitch_now));
  nose_force_N_ += std::min(1.0, dt_s / kNoseTakes_s) * (nose_force_N - nose_force_N_);
  const double coming_force_N =
      std::max(0.0, std::min(lacks_force_N, nose_force_N - nose_force_N_));
  const double lift_force_N = -rest_B.z() - wing_only * (coming_force_N + kSpareLift * weight_N);
  out_.lift_force_N = std::clamp(lift_force_N, 0.0, c.vehicle.max_lift_force_N);
  out_.pusher_thrust_N = std::max(rest_B.x(), 0.0);
  if (in.lift_force_N) out_.lift_force_N = *in.lift_force_N, out_.pusher_thrust_N = 0.0;

  const Quaternion wanted =
      in.lift_force_N ? attitude(0.0, 0.0, heading_rad_) : attitude(roll, pitch, heading_rad_);
  integrate_attitude(state, wanted, in.on_ground, dt_s);
  allocate(torque(state, wanted, turn_rad_s, now), now);
  out_.command.mode = FirmwareMode::kPassThrough;
  out_.command.ignore = 0;
  // Beyond its throttle the firmware would scale all motors down, the lifting ones too.
  const double max_thrust_N = kPusherShare * c.vehicle.max_pusher_thrust_N * in.supply * in.supply;
  out_.command.u[0] = static_cast<float>(
      std::min(static_thrust(out_.pusher_thrust_N, now.forward_m_s), max_thrust_N));
  out_.command.u[2] = static_cast<float>(-out_.lift_force_N / translational(now.forward_m_s));
  return out_;
}

}  // namespace rosflight::autonomy::quadplane
