// SPDX-License-Identifier: BSD-3-Clause
#include "sim/dynamics/ground_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rosflight::sim {
namespace {
/// Horizontal part of body x below which a wheel has no direction and acts as any point.
constexpr double kMinHeading = 0.1;
}  // namespace

GroundContact::GroundContact(const GroundParameters& parameters)
    : parameters_{parameters}, anchors_(parameters.contacts_B.size()) {
  for (const auto& p : parameters_.contacts_B) reach_m_ = std::max(reach_m_, p.norm());
}

double GroundContact::rest_height_m(double weight_N) const {
  // The lowest points carry the weight; those that lie higher than the dent they make stay out.
  std::vector<double> depth;
  depth.reserve(parameters_.contacts_B.size());
  for (const auto& p : parameters_.contacts_B) depth.push_back(p.z());
  std::sort(depth.rbegin(), depth.rend());
  double height = depth.front();
  double sum = 0.0;
  for (std::size_t n = 1; n <= depth.size(); ++n) {
    sum += depth[n - 1];
    height = (sum - weight_N / parameters_.stiffness_N_m) / static_cast<double>(n);
    if (n == depth.size() || height >= depth[n]) break;
  }
  return height;
}

double GroundContact::depth_m(const BodyState& body) const {
  double deepest = -std::numeric_limits<double>::infinity();
  for (const auto& p : parameters_.contacts_B) {
    deepest = std::max(deepest, (body.p_W + body.q_WB * p).z());
  }
  return deepest;
}

bool GroundContact::touch(std::size_t i, const BodyState& body, const Matrix3& R_WB,
                          Touch& t) const {
  const Vector3& p_B = parameters_.contacts_B[i];
  const Vector3 p_W = body.p_W + R_WB * p_B;
  if (p_W.z() <= 0.0) return false;
  const Vector3 v_W = R_WB * (body.v_B + body.w_B.cross(p_B));
  t.depth_m = p_W.z();
  t.normal_N =
      std::max(0.0, parameters_.stiffness_N_m * t.depth_m + parameters_.damping_N_s_m * v_W.z());
  t.position_x = p_W.x();
  t.position_y = p_W.y();
  t.speed_x = v_W.x();
  t.speed_y = v_W.y();
  const Anchor& anchor = anchors_[i];
  const double away_x = anchor.set ? p_W.x() - anchor.x : 0.0;
  const double away_y = anchor.set ? p_W.y() - anchor.y : 0.0;
  t.pull_x_N =
      -parameters_.friction_stiffness_N_m * away_x - parameters_.friction_damping_N_s_m * v_W.x();
  t.pull_y_N =
      -parameters_.friction_stiffness_N_m * away_y - parameters_.friction_damping_N_s_m * v_W.y();
  return true;
}

GroundContact::Grip GroundContact::grip(std::size_t i, const Matrix3& R_WB, const Touch& t) const {
  const double limit = parameters_.friction * t.normal_N;
  const double heading = std::sqrt(R_WB(0, 0) * R_WB(0, 0) + R_WB(1, 0) * R_WB(1, 0));
  const bool wheel = i + parameters_.wheels >= anchors_.size();
  if (!wheel || heading < kMinHeading) {
    const double pull = std::sqrt(t.pull_x_N * t.pull_x_N + t.pull_y_N * t.pull_y_N);
    if (pull <= limit) return {t.pull_x_N, t.pull_y_N, false};
    const double share = limit / pull;
    return {share * t.pull_x_N, share * t.pull_y_N, true};
  }
  const double north = R_WB(0, 0) / heading;
  const double east = R_WB(1, 0) / heading;
  const double along = t.pull_x_N * north + t.pull_y_N * east;
  const double across = t.pull_y_N * north - t.pull_x_N * east;
  const double rolling = parameters_.rolling_friction * t.normal_N;
  const double a = std::clamp(along, -rolling, rolling);
  const double b = std::clamp(across, -limit, limit);
  return {a * north - b * east, a * east + b * north, a != along || b != across};
}

void GroundContact::add_wrench(const BodyState& body, const Matrix3& R_WB, Wrench& wrench) const {
  for (std::size_t i = 0; i < anchors_.size(); ++i) {
    Touch t;
    if (!touch(i, body, R_WB, t)) continue;
    const Grip held = grip(i, R_WB, t);
    const Vector3 force_B = R_WB.transpose() * Vector3(held.x_N, held.y_N, -t.normal_N);
    wrench.force_B += force_B;
    wrench.torque_B += parameters_.contacts_B[i].cross(force_B);
  }
}

bool GroundContact::end_step(const BodyState& body, const Matrix3& R_WB) {
  bool any = false;
  for (std::size_t i = 0; i < anchors_.size(); ++i) {
    Anchor& anchor = anchors_[i];
    Touch t;
    if (!touch(i, body, R_WB, t)) {
      anchor.set = false;
      continue;
    }
    any = true;
    if (!anchor.set) anchor = {true, t.position_x, t.position_y};
    const Grip held = grip(i, R_WB, t);
    if (!held.slides) continue;
    // Sliding: k_t (p - a) + c_t v_t = -F with the cut force.
    const double k = parameters_.friction_stiffness_N_m;
    const double c = parameters_.friction_damping_N_s_m;
    anchor.x = t.position_x + (held.x_N + c * t.speed_x) / k;
    anchor.y = t.position_y + (held.y_N + c * t.speed_y) / k;
  }
  return any;
}

}  // namespace rosflight::sim
