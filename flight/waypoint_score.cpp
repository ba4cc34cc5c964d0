// SPDX-License-Identifier: BSD-3-Clause
#include "flight/waypoint_score.hpp"

namespace rosflight::flight {
namespace {

/// Distance from the planned path: that from the setpoint, across its velocity.
double path_distance_m(const sim::Vector3& p_W, const autonomy::multirotor::Trajectory& setpoint) {
  const sim::Vector3 error_W = p_W - setpoint.p_W;
  constexpr double kAtRest_m_s = 0.05;  // then the path has no direction
  const double speed_m_s = setpoint.v_W.norm();
  if (speed_m_s < kAtRest_m_s) return error_W.norm();
  const sim::Vector3 along = setpoint.v_W / speed_m_s;
  return (error_W - error_W.dot(along) * along).norm();
}

}  // namespace

const char* measure_name(PassMeasure measure) {
  switch (measure) {
    case PassMeasure::kPoint:
      return "point";
    case PassMeasure::kFlyBy:
      return "fly_by";
    case PassMeasure::kFigure:
      return "figure";
  }
  return "";
}

WaypointScore::WaypointScore(const std::vector<Target>& targets) {
  for (const Target& target : targets) passes_.push_back({target, false, {}, {}});
}

void WaypointScore::follow(Nearest& nearest, const Target& target, double t_s,
                           const sim::Vector3& p_W, const GuidanceOutput& output) {
  if (!p_W.allFinite()) return;
  const double to_point_m = (p_W - target.p_W).norm();
  if (target.measure == PassMeasure::kFigure) {
    const double from_path_m = path_distance_m(p_W, output.setpoint);
    if (from_path_m <= nearest.measured_m) return;
    nearest = {to_point_m, from_path_m, t_s};
  } else if (to_point_m < nearest.to_point_m) {
    const bool point = target.measure == PassMeasure::kPoint;
    nearest = {to_point_m, point ? to_point_m : path_distance_m(p_W, output.setpoint), t_s};
  }
}

void WaypointScore::step(double t_s, const sim::Vector3& truth_W, const sim::Vector3& estimate_W,
                         const GuidanceOutput& output) {
  if (output.waypoint != target_ || output.mission_done) {
    if (target_ < passes_.size()) passes_[target_].behind = true;
    target_ = output.waypoint;
  }
  if (!output.tracking || target_ >= passes_.size()) return;
  Pass& pass = passes_[target_];
  follow(pass.truth, pass.target, t_s, truth_W, output);
  follow(pass.estimate, pass.target, t_s, estimate_W, output);
}

std::vector<WaypointPass> WaypointScore::passes() const {
  std::vector<WaypointPass> out;
  for (const Pass& pass : passes_) {
    WaypointPass one;
    one.measure = pass.target.measure;
    if (pass.behind || one.measure == PassMeasure::kPoint) {
      one.truth_distance_m = pass.truth.measured_m;
      one.estimate_distance_m = pass.estimate.measured_m;
      one.t_s = pass.truth.t_s;
    }
    out.push_back(one);
  }
  return out;
}

}  // namespace rosflight::flight
