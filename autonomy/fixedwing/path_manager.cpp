// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/path_manager.hpp"

#include <utility>

namespace rosflight::autonomy::fixedwing {
namespace {

constexpr int kMaxPerStep = 4;

}  // namespace

void PathManager::set_waypoints(std::vector<Waypoint> waypoints, bool cycle) {
  waypoints_ = std::move(waypoints);
  cycle_ = cycle;
  started_ = done_ = false;
}

std::optional<PlanFault> PathManager::start(const PathStart& from, std::size_t first) {
  started_ = done_ = false;
  index_ = 0;
  progress_m_ = 0.0;
  if (auto fault = planner_.plan(from, waypoints_, cycle_, first, plan_)) return fault;
  started_ = !plan_.segments.empty();
  return {};
}

bool PathManager::over(const Segment& segment, const Vector2& p_m) const {
  if (segment.corner_rad == 0.0) return progress_m_ >= segment.length_m;
  // The plane of a sharp corner lies along the leg: it is only used near its end.
  if (progress_m_ < segment.length_m - planner_.config().radius_m) return false;
  const Vector2 beyond = p_m - segment.point_at(segment.length_m);
  return beyond.dot(along(segment.course_at(segment.length_m) + 0.5 * segment.corner_rad)) > 0.0;
}

/// The segment after the present one; the present one at the end.
std::size_t PathManager::next() const {
  if (index_ + 1 < plan_.segments.size()) return index_ + 1;
  return plan_.loop_to == Plan::kNoLoop ? index_ : plan_.loop_to;
}

const PathManager::Output& PathManager::step(const Vector3& p_W, double lead_m) {
  out_.path.valid = false;
  out_.passed.reset();
  out_.done = done_;
  if (!started_) return out_;
  const Vector2 p_m = p_W.head<2>();
  for (int k = 0; k < kMaxPerStep; ++k) {
    const Segment& segment = plan_.segments[index_];
    progress_m_ = segment.progress(p_m, progress_m_);
    if (!over(segment, p_m) || done_) break;
    if (segment.passes_waypoint) {
      out_.passed = segment.waypoint;
      out_.passed_at_m = (waypoints_[segment.waypoint].p_W.head<2>() - p_m).norm();
    }
    if (next() == index_) {
      out_.done = done_ = true;
      break;
    }
    progress_m_ = segment.corner_rad == 0.0 ? progress_m_ - segment.length_m : 0.0;
    index_ = next();
  }
  const Segment& segment = plan_.segments[index_];
  out_.segment = segment;
  out_.progress_m = progress_m_;
  const double ahead_m = progress_m_ + lead_m - segment.length_m;
  if (ahead_m > 0.0 && segment.corner_rad == 0.0) {
    out_.path = plan_.segments[next()].path_at(ahead_m);
  } else {
    out_.path = segment.path_at(progress_m_);
  }
  out_.height_m = segment.height_at(progress_m_);
  out_.cross_track_m = segment.cross_track_m(p_m);
  out_.waypoint = segment.waypoint;
  return out_;
}

}  // namespace rosflight::autonomy::fixedwing
