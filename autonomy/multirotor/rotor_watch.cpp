// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/rotor_watch.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace rosflight::autonomy::multirotor {
namespace {

constexpr double kFilter_s = 0.1;
constexpr double kWindow_s = 0.2;
constexpr double kBias_s = 8.0;
constexpr double kSettling_s = 1.0;  // of filters and bias after an interruption
constexpr double kLostShare = 0.6;
constexpr double kExplained = 0.72;
constexpr double kConfirm_s = 0.2;
// In (3) a live rotor keeps this share of its hover thrust, and no output is nearer to its end.
constexpr double kMinShare = 0.25;
constexpr double kMaxOutput = 0.95;

double share(double dt_s, double tau_s) {
  return dt_s / (tau_s + dt_s);
}

/// Lift, and torques [N m], per newton of thrust.
Eigen::Vector4d effect(const RotorWatchConfig::Rotor& rotor, double drag_per_thrust_m) {
  const Vector3 torque = rotor.p_B.cross(rotor.e_B) + drag_per_thrust_m * rotor.spin * rotor.e_B;
  return {-rotor.e_B.z(), torque.x(), torque.y(), torque.z()};
}

}  // namespace

RotorWatch::RotorWatch(const RotorWatchConfig& config) {
  if (config.rotors.empty()) return;
  model_ = ThrustModel(config.curve, {});
  inertia_ = config.inertia_kg_m2;
  inertia_inverse_ = inertia_.inverse();
  rotor_drag_s_m_ = config.rotor_drag_s_m;
  thrust_gain_ = config.thrust_gain_N_s2;
  rotor_inertia_kg_m2_ = config.rotor_inertia_kg_m2;
  const double hover_thrust_N = config.weight_N / static_cast<double>(config.rotors.size());
  Vector3 largest = Vector3::Zero();
  for (std::size_t i = 0; i < config.rotors.size(); ++i) {
    Rotor rotor;
    rotor.output = config.rotors[i].output;
    rotor.p_B = config.rotors[i].p_B;
    rotor.e_B = config.rotors[i].e_B;
    rotor.spin = config.rotors[i].spin;
    rotor.turn = inertia_inverse_ * effect(config.rotors[i], config.drag_per_thrust_m).tail<3>();
    rotors_.push_back(rotor);
    largest = largest.cwiseMax(hover_thrust_N * rotor.turn.cwiseAbs());
    yaw_without_.push_back(solve_yaw(config, i));
  }
  scale_ = largest.cwiseInverse();
}

bool RotorWatch::solve_yaw(const RotorWatchConfig& config, std::size_t j) const {
  const auto n = static_cast<Eigen::Index>(config.rotors.size());
  Eigen::MatrixXd B(4, n);
  Eigen::MatrixXd K(n, 4);
  for (Eigen::Index i = 0; i < n; ++i) {
    const RotorWatchConfig::Rotor& rotor = config.rotors[static_cast<std::size_t>(i)];
    B.col(i) = effect(rotor, config.drag_per_thrust_m);
    K.row(i) = Eigen::Map<const Eigen::RowVector4d>(rotor.gain.data());
  }
  B.col(static_cast<Eigen::Index>(j)).setZero();
  const Eigen::Matrix4d A = B * K;
  const Eigen::FullPivLU<Eigen::Matrix4d> lu(A);
  if (!lu.isInvertible()) return false;
  const Eigen::VectorXd thrust_N = K * lu.solve(Eigen::Vector4d(config.weight_N, 0.0, 0.0, 0.0));
  const double hover_thrust_N = config.weight_N / static_cast<double>(n);
  const double hover_output = model_.throttle(config.weight_N);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double ratio = thrust_N(i) / hover_thrust_N;
    const bool alive = static_cast<std::size_t>(i) != j;
    if ((alive && ratio < kMinShare) || ratio * hover_output > kMaxOutput) return false;
  }
  return true;
}

void RotorWatch::interrupt() {
  running_s_ = suspected_s_ = rr_ = 0.0;
  for (Rotor& rotor : rotors_) rotor.gg = rotor.rg = 0.0;
}

bool RotorWatch::step(const Input& in) {
  if (rotors_.empty() || lost_) return false;
  if (in.outputs.empty() || !(in.dt_s > 0.0)) {
    interrupt();
    return false;
  }
  const bool fresh = running_s_ == 0.0;
  running_s_ += in.dt_s;
  const double filter = fresh ? 1.0 : share(in.dt_s, kFilter_s);
  const double count = static_cast<double>(rotors_.size());
  Vector3 promised = -(inertia_inverse_ * in.w_B.cross(inertia_ * in.w_B));
  Vector3 momentum = Vector3::Zero();
  for (Rotor& rotor : rotors_) {
    const double output =
        rotor.output < in.outputs.size() ? static_cast<double>(in.outputs[rotor.output]) : 0.0;
    const double thrust_N = model_.thrust_N(output, in.voltage_V) / count;
    const Vector3 turn = thrust_N * rotor.turn;
    const Vector3 v_B = in.v_B + in.w_B.cross(rotor.p_B);
    const Vector3 across_B = v_B - v_B.dot(rotor.e_B) * rotor.e_B;
    promised += turn - rotor_drag_s_m_ * thrust_N * (inertia_inverse_ * rotor.p_B.cross(across_B));
    momentum += rotor_inertia_kg_m2_ * rotor.spin * std::sqrt(thrust_N / thrust_gain_) * rotor.e_B;
    rotor.g += filter * (turn - rotor.g);
  }
  momentum_slow_ += filter * (momentum - momentum_slow_);
  promised_ += filter * (promised - promised_);
  w_slow_B_ += filter * (in.w_B - w_slow_B_);
  if (fresh) {
    bias_.setZero();
    return false;
  }
  const Vector3 residual = (in.w_B - w_slow_B_) / kFilter_s - promised_ -
                           inertia_inverse_ * (momentum - momentum_slow_) / kFilter_s;
  const double turned = in.w_B.z() * in.dt_s;
  bias_ += Vector3(turned * bias_.y(), -turned * bias_.x(), 0.0);
  bias_ += share(in.dt_s, std::min(running_s_, kBias_s)) * (residual - bias_);
  if (running_s_ < kSettling_s) return false;
  const Vector3 r = scale_.cwiseProduct(residual - bias_);
  const double window = share(in.dt_s, kWindow_s);
  rr_ += window * (r.squaredNorm() - rr_);
  for (Rotor& rotor : rotors_) {
    const Vector3 g = scale_.cwiseProduct(rotor.g);
    rotor.gg += window * (g.squaredNorm() - rotor.gg);
    rotor.rg += window * (r.dot(g) - rotor.rg);
  }
  judge(in.dt_s);
  if (suspected_s_ < kConfirm_s) return false;
  lost_ = suspect_;
  return true;
}

/// The rotor whose loss explains most of the residual, and for how long it has.
void RotorWatch::judge(double dt_s) {
  std::size_t best = 0;
  double explained = 0.0;
  for (std::size_t i = 0; i < rotors_.size(); ++i) {
    const Rotor& rotor = rotors_[i];
    if (!(-rotor.rg > kLostShare * rotor.gg)) continue;
    const double part = rotor.rg * rotor.rg / (rr_ * rotor.gg);
    if (part > explained) {
      explained = part;
      best = i;
    }
  }
  suspected_s_ = explained > kExplained ? suspected_s_ + dt_s : 0.0;
  suspect_ = best;
}

}  // namespace rosflight::autonomy::multirotor
