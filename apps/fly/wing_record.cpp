// SPDX-License-Identifier: BSD-3-Clause
#include "apps/fly/wing_record.hpp"

#include <algorithm>
#include <cmath>

#include "autonomy/common/angles.hpp"

namespace rosflight::apps {

namespace wing = autonomy::fixedwing;

bool WingRecord::captured(const wing::FlightOutput& output) {
  const wing::Segment& now = output.path.segment;
  const bool new_segment =
      now.start.p_m != segment_.start.p_m || now.start.course_rad != segment_.start.course_rad;
  if (new_segment) {
    after_corner_ = segment_.corner_rad != 0.0;
    segment_ = now;
  }
  return !after_corner_ || output.path.progress_m > kCapture * radius_m_;
}

void WingRecord::step(const sim::Truth& truth, const sim::Vector3& seen_N,
                      const wing::FlightOutput& output) {
  const sim::Vector3 v_N = truth.body.q_NB * truth.body.v_B;
  const double through_air = (v_N - truth.air.wind_N).norm();
  const auto attitude = autonomy::RollPitch::of(truth.body.q_NB);
  const wing::Segment& segment = output.path.segment;
  const bool counts = output.tracking && captured(output);
  if (output.tracking && !counts) corner.add(segment.cross_track_m(seen_N.head<2>()));
  if (counts) {
    Tracking& seen = segment.straight() ? straight : arc;
    Tracking& total = segment.straight() ? straight_total : arc_total;
    seen.add(segment.cross_track_m(seen_N.head<2>()));
    total.add(segment.cross_track_m(truth.body.p_N.head<2>()));
    height.add(output.path.height_m + seen_N.z());
    height_total.add(output.path.height_m + truth.body.p_N.z());
    airspeed.add(output.wanted.airspeed_m_s - through_air);
  }
  const bool flying = output.phase != wing::Phase::kDisarmed &&
                      output.phase != wing::Phase::kTakeoff &&
                      output.phase != wing::Phase::kRollout && output.phase != wing::Phase::kLanded;
  if (flying && !truth.on_ground) {
    roll.add(attitude.roll_rad);
    if (output.phase != wing::Phase::kFlare) {
      lowest_airspeed_m_s = std::min(lowest_airspeed_m_s, through_air);
    }
  }
  if (was_in_air_ && truth.on_ground && !touchdown_) {
    const sim::Vector3 away = truth.body.p_N - aim_N_;
    const double course = std::atan2(v_N.y(), v_N.x());
    touchdown_ = Touchdown{static_cast<double>(truth.time.count()) * 1e-6,
                           away.head<2>().norm(),
                           away.head<2>().dot(wing::along(course)),
                           sink_m_s_,
                           attitude.roll_rad,
                           attitude.pitch_rad};
  }
  const bool coming_down =
      output.phase == wing::Phase::kApproach || output.phase == wing::Phase::kGlide ||
      output.phase == wing::Phase::kFlare || output.phase == wing::Phase::kRollout;
  was_in_air_ = coming_down && !truth.on_ground;
  sink_m_s_ = v_N.z();
}

report::Wing wing_sample(const wing::FlightOutput& output, const sim::Truth& truth,
                         const sim::Vector3& seen_N) {
  const auto single = [](double x) { return static_cast<float>(x); };
  const sim::Vector3 v_N = truth.body.q_NB * truth.body.v_B;
  const sim::Vector3& wind_N = truth.air.wind_N;
  report::Wing out;
  out.wind_N_m_s = {single(wind_N.x()), single(wind_N.y())};
  out.airspeed_m_s = single((v_N - wind_N).norm());
  constexpr double kMoving_m_s = 2.0;  // Slower, a course is noise.
  if (v_N.head<2>().norm() > kMoving_m_s) out.course_rad = single(std::atan2(v_N.y(), v_N.x()));
  if (output.phase == wing::Phase::kDisarmed) return out;
  const wing::Surfaces& surfaces = output.control.surfaces;
  out.surfaces = {single(surfaces.aileron), single(surfaces.elevator), single(surfaces.rudder)};
  if (output.wanted.valid) {
    out.airspeed_command_m_s = single(output.wanted.airspeed_m_s);
    out.course_command_rad = single(output.wanted.course_rad);
  }
  if (output.tracking) {
    const wing::Segment& segment = output.path.segment;
    out.cross_track_m = single(segment.cross_track_m(seen_N.head<2>()));
    out.cross_track_total_m = single(segment.cross_track_m(truth.body.p_N.head<2>()));
    out.height_error_m = single(-truth.body.p_N.z() - output.path.height_m);
  }
  return out;
}

}  // namespace rosflight::apps
