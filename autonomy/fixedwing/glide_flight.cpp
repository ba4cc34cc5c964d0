// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/glide_flight.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "autonomy/common/angles.hpp"

namespace rosflight::autonomy::fixedwing {
namespace {

constexpr double kAgain_s = 0.5;   // between two plans
constexpr double kBeyond_m = 2.0;  // aimed beyond the field: short of it nothing helps
constexpr double kShort_m = 0.5;   // height that may be missing before another path is looked for
constexpr double kFaster = 2.0;    // share of airspeed per share of height left over
constexpr double kMaxSpeedRatio = 1.4;  // of the airspeed that sinks least
constexpr double kSlow_m = 3.0;         // here it is back at that
constexpr double kNearKey_m = 20.0;     // closer to its key it is on the final part
constexpr double kCommit_m = 90.0;      // closer to the field a path is not replaced
constexpr double kReserve = 0.05;       // share of the glide ratio that a path does not count on
constexpr double kFits_m = 1.5;         // height left over with which a path is kept
// A vehicle a bit outside of its turn would need a whole turn more with the radius of the path.
constexpr double kTight = 0.8;       // share of the radius that it flies then,
constexpr double kExtraTurn = 0.25;  // seen by so much more height of one turn

Vector2 wind_of(const StateEstimate& state) {
  return state.wind_valid ? Vector2(state.wind_W.head<2>()) : Vector2(Vector2::Zero());
}

/// Height that the airspeed is worth beyond that of the settings.
double stored_m(const GlideFlight::Input& in) {
  if (!in.state.air_valid) return 0.0;
  const double v = in.state.airspeed_m_s;
  const double v0 = in.airspeed_m_s;
  return (v * v - v0 * v0) / (2.0 * in.config.controller.airframe.gravity_m_s2);
}

/// s of (1).
double left_over_m(const GlideFlight::Input& in, const GlidePath& glide, double needed_m) {
  return glide.aim_W.z() - in.state.p_W.z() + stored_m(in) - needed_m;
}

/// What the flare adds to the distance in still air: its own, (2) of LandingPath, less that of the
/// glide from the height where it begins.
double flare_gain_m(const FlightConfig& config, double airspeed_m_s, double ratio) {
  const LandingConfig& landing = config.landing;
  const double v = airspeed_m_s;
  const double b = landing.flare_time_s * landing.touchdown_m_s;
  const double height_m = std::max(landing.flare_time_s * v / ratio - b, 0.0);
  return v * landing.flare_time_s * std::log((height_m + b) / b) - height_m * ratio;
}

bool on_final(const GlidePath& glide, const Vector2& p_m) {
  const Vector2 to_key = glide.key.p_m - p_m;
  return to_key.dot(along(glide.key.course_rad)) < kNearKey_m &&
         std::abs(to_key.dot(right_of(glide.key.course_rad))) < kNearKey_m;
}

}  // namespace

void GlideFlight::begin(const Input& in, PathManager& path) {
  glide_.reset();
  path.stop();
  began_s_ = in.t_s;
  planned_s_ = in.t_s - kAgain_s;
  ratio_ = in.config.safety.glide_ratio;
}

/// The ratio that the vehicle has straight on: its speed over the loss of energy per weight.
void GlideFlight::learn_ratio(const Input& in) {
  constexpr double kSettle_s = 3.0;
  constexpr double kAverage_s = 20.0;
  constexpr double kRange = 1.4;  // of the settings, either way
  constexpr double kSameSpeed = 1.1;
  constexpr double kStraight_rad = 10.0 * kRadPerDeg;
  if (in.t_s - began_s_ < kSettle_s || !in.state.air_valid) return;
  if (in.state.airspeed_m_s > kSameSpeed * in.airspeed_m_s) return;
  const double gravity_m_s2 = in.config.controller.airframe.gravity_m_s2;
  const RollPitch attitude = RollPitch::of(in.state.q_WB);
  if (std::abs(attitude.roll_rad) > kStraight_rad) return;
  const double rate_m_s2 = in.state.a_B.x() - gravity_m_s2 * std::sin(attitude.pitch_rad);
  const double v = in.state.airspeed_m_s;
  const double sink_m_s = in.state.v_W.z() - v * rate_m_s2 / gravity_m_s2;
  const double known = in.config.safety.glide_ratio;
  const double ratio = sink_m_s > 0.0 ? v / sink_m_s : kRange * known;
  const double share = std::clamp(in.dt_s / kAverage_s, 0.0, 1.0);
  // Sink is what averages, not its inverse.
  const double mean = 1.0 / ((1.0 - share) / ratio_ + share / std::max(ratio, 1.0));
  ratio_ = std::clamp(mean, known / kRange, known * kRange);
}

double GlideFlight::airspeed_m_s(const Input& in) const {
  const double v0 = in.airspeed_m_s;
  if (!glide_ || in.position_lost || !in.state.air_valid) return v0;
  const double height_m = std::max(glide_->aim_W.z() - in.state.p_W.z(), kSlow_m);
  const double g = in.config.controller.airframe.gravity_m_s2;
  const double most =
      std::min(kMaxSpeedRatio, std::sqrt(1.0 + g * (height_m - kSlow_m) / (v0 * v0)));
  return v0 * std::clamp(1.0 + kFaster * spare_m_ / height_m, 1.0, most);
}

void GlideFlight::plan(const Input& in, PathManager& path) {
  if (in.t_s - planned_s_ < kAgain_s || in.position_lost) return;
  planned_s_ = in.t_s;
  const Vector2 p_m = in.state.p_W.head<2>();
  GlideConfig glide;
  glide.airspeed_m_s = in.airspeed_m_s;
  glide.ratio = (1.0 - kReserve) * ratio_;
  glide.radius_m = in.radius_m;
  glide.gravity_m_s2 = in.config.controller.airframe.gravity_m_s2;
  glide.flare_m = flare_gain_m(in.config, in.airspeed_m_s, glide.ratio);
  glide.beyond_m = kBeyond_m;
  const GlidePlanner planner(glide);
  const Vector2 wind_m_s = wind_of(in.state);
  const Pose from{p_m, in.state.course_rad};
  if (glide_) {
    bool committed = false;
    double needed_m = 0.0;
    if (on_final(*glide_, p_m)) {
      const double course_rad = glide_->key.course_rad;
      const double left_m = (glide_->aim_W.head<2>() - p_m).dot(along(course_rad));
      needed_m = planner.final_height_m(left_m, course_rad, wind_m_s);
      committed = left_m < kCommit_m;
    } else {
      GlideConfig tight = glide;
      tight.radius_m *= kTight;
      needed_m = planner.height_needed_m(from, glide_->key, glide_->final_m, wind_m_s);
      const double tight_m =
          GlidePlanner(tight).height_needed_m(from, glide_->key, glide_->final_m, wind_m_s);
      if (needed_m - tight_m > kExtraTurn * planner.turn_height_m()) needed_m = tight_m;
    }
    spare_m_ = left_over_m(in, *glide_, needed_m);
    if (committed || (spare_m_ > -kShort_m && spare_m_ < kFits_m)) return;
  }
  const double up_m = -in.state.p_W.z() + stored_m(in);
  auto found = planner.plan(from, up_m + in.landing.aim_W.z(), in.landing, wind_m_s);
  if (!found && planner.out_of_reach(from, up_m + in.landing.aim_W.z(), in.landing, wind_m_s)) {
    found = planner.plan(from, up_m + in.start.aim_W.z(), in.start, wind_m_s);
  }
  if (!found || (glide_ && spare_m_ > 0.0 && found->spare_m > spare_m_)) return;
  PlannerConfig plan = in.config.plan;
  plan.radius_m = in.radius_m;
  constexpr double kAnySlope = 1e3;  // pitch holds the airspeed, not the height of the path
  plan.climb_slope = plan.descent_slope = kAnySlope;
  Waypoint key;
  key.p_W << found->key.p_m, in.state.p_W.z();
  key.passing = Passing::kDubins;
  key.course_rad = found->key.course_rad;
  key.airspeed_m_s = glide.airspeed_m_s;
  Waypoint aim = key;
  aim.p_W = found->aim_W;
  aim.passing = Passing::kLine;
  PathManager next(plan);
  next.set_waypoints({key, aim}, false);
  if (next.start({from, -in.state.p_W.z()}, 0)) return;
  path = std::move(next);
  glide_ = found;
  spare_m_ = left_over_m(in, *found, found->height_needed_m);
}

CurrentPath GlideFlight::step(const Input& in, PathManager& path) {
  learn_ratio(in);
  plan(in, path);
  if (glide_ && path.started()) {
    return path.step(in.state.p_W, in.config.lead_s * in.state.v_W.head<2>().norm()).path;
  }
  CurrentPath out;
  out.valid = true;
  out.airspeed_m_s = in.airspeed_m_s;
  const Vector2 to_field = (in.landing.aim_W - in.state.p_W).head<2>();
  const double height_m = in.landing.aim_W.z() - in.state.p_W.z();
  if (to_field.norm() < height_m * ratio_) {
    out.circle = true;
    out.radius_m = in.radius_m;
    out.c_W = in.landing.aim_W;
  } else {  // as near as it gets
    out.r_W = in.state.p_W;
    out.q_W << along(course_of(to_field)), 0.0;
  }
  return out;
}

}  // namespace rosflight::autonomy::fixedwing
