// SPDX-License-Identifier: BSD-3-Clause
#include "flight/flight_analysis.hpp"

namespace rosflight::flight {
namespace {

namespace fixedwing = autonomy::fixedwing;

void add_fixedwing(const fixedwing::FlightOutput& output, const sim::Truth& truth,
                   const sim::Vector3& seen_W, AnalysisMoment& moment) {
  if (output.phase == fixedwing::Phase::kDisarmed) return;
  const fixedwing::Surfaces& surfaces = output.control.surfaces;
  moment.aileron = surfaces.aileron;
  moment.elevator = surfaces.elevator;
  moment.rudder = surfaces.rudder;
  if (output.wanted.valid) {
    moment.airspeed_command_m_s = output.wanted.airspeed_m_s;
    moment.course_command_rad = output.wanted.course_rad;
  }
  if (output.tracking) {
    const fixedwing::Segment& segment = output.path.segment;
    moment.cross_track_m = segment.cross_track_m(seen_W.head<2>());
    moment.cross_track_total_m = segment.cross_track_m(truth.body.p_W.head<2>());
    moment.height_error_m = -truth.body.p_W.z() - output.path.height_m;
  }
}

}  // namespace

AnalysisMoment analysis_moment(const Flight& flight, const sim::Truth& truth) {
  AnalysisMoment moment;
  moment.t_s = sim::to_seconds(truth.time);
  const sim::Vector3 seen_W = flight.seen_position_W();
  if (flight.setup().choice.state != "truth") {
    moment.drift_north_m = seen_W.x() - truth.body.p_W.x();
    moment.drift_east_m = seen_W.y() - truth.body.p_W.y();
  }
  if (const auto* guidance = dynamic_cast<const FixedWingGuidance*>(&flight.guidance()))
    add_fixedwing(guidance->details(), truth, seen_W, moment);
  return moment;
}

}  // namespace rosflight::flight
