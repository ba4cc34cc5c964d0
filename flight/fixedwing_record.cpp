// SPDX-License-Identifier: BSD-3-Clause
#include "flight/fixedwing_record.hpp"

#include <algorithm>
#include <cmath>

#include "autonomy/common/angles.hpp"

namespace rosflight::flight {

namespace fixedwing = autonomy::fixedwing;

bool FixedWingRecord::captured(const fixedwing::FlightOutput& output) {
  const fixedwing::Segment& now = output.path.segment;
  const bool new_segment =
      now.start.p_m != segment_.start.p_m || now.start.course_rad != segment_.start.course_rad;
  if (new_segment) {
    after_corner_ = segment_.corner_rad != 0.0;
    segment_ = now;
  }
  return !after_corner_ || output.path.progress_m > kCapture * radius_m_;
}

void FixedWingRecord::step(const sim::Truth& truth, const sim::Vector3& seen_W,
                           const fixedwing::FlightOutput& output) {
  const sim::Vector3 v_W = truth.body.q_WB * truth.body.v_B;
  const double through_air = (v_W - truth.air.wind_W).norm();
  const auto attitude = autonomy::RollPitch::of(truth.body.q_WB);
  const fixedwing::Segment& segment = output.path.segment;
  const bool counts = output.tracking && captured(output);
  if (output.tracking && !counts) corner.add(segment.cross_track_m(seen_W.head<2>()));
  if (counts) {
    ErrorStatistics& seen = segment.straight() ? straight : arc;
    ErrorStatistics& total = segment.straight() ? straight_total : arc_total;
    seen.add(segment.cross_track_m(seen_W.head<2>()));
    total.add(segment.cross_track_m(truth.body.p_W.head<2>()));
    height.add(output.path.height_m + seen_W.z());
    height_total.add(output.path.height_m + truth.body.p_W.z());
    airspeed.add(output.wanted.airspeed_m_s - through_air);
  }
  const bool flying =
      output.phase != fixedwing::Phase::kDisarmed && output.phase != fixedwing::Phase::kTakeoff &&
      output.phase != fixedwing::Phase::kRollout && output.phase != fixedwing::Phase::kLanded;
  if (flying && !truth.on_ground) {
    roll.add(attitude.roll_rad);
    if (output.phase != fixedwing::Phase::kFlare) {
      lowest_airspeed_m_s = std::min(lowest_airspeed_m_s, through_air);
    }
  }
  if (was_in_air_ && truth.on_ground && !touchdown_) {
    const sim::Vector3 away = truth.body.p_W - aim_W_;
    const double course = std::atan2(v_W.y(), v_W.x());
    touchdown_ = Touchdown{sim::to_seconds(truth.time),
                           away.head<2>().norm(),
                           away.head<2>().dot(fixedwing::along(course)),
                           sink_m_s_,
                           attitude.roll_rad,
                           attitude.pitch_rad};
  }
  const bool coming_down =
      output.phase == fixedwing::Phase::kApproach || output.phase == fixedwing::Phase::kGlide ||
      output.phase == fixedwing::Phase::kFlare || output.phase == fixedwing::Phase::kDescent ||
      output.phase == fixedwing::Phase::kRollout;
  was_in_air_ = coming_down && !truth.on_ground;
  sink_m_s_ = v_W.z();
}

}  // namespace rosflight::flight
