// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/zones.hpp"

#include "autonomy/common/angles.hpp"

namespace rosflight::autonomy::fixedwing {

void AltitudeZones::begin(const Input& in) {
  since_s_ = in.t_s;
  start_height_m_ = -in.state.p_W.z();
  start_course_rad_ = heading_of(in.state.q_WB);
}

std::optional<Controller::Direct> AltitudeZones::step(const Input& in, const FlightConfig& flight) {
  const double height_m = -in.state.p_W.z();
  if (!in.armed) {
    armed_ = false;
    zone_ = AltitudeZone::kTakeOff;
    return {};
  }
  const bool armed_now = !armed_;
  armed_ = true;
  if (armed_now && height_m > config_.takeoff_m) zone_ = AltitudeZone::kHold;
  if (armed_now || (in.pilot && zone_ == AltitudeZone::kTakeOff)) begin(in);
  if (zone_ == AltitudeZone::kTakeOff && height_m - start_height_m_ >= config_.takeoff_m) {
    zone_ = AltitudeZone::kClimb;
  }
  if (zone_ == AltitudeZone::kClimb && height_m >= in.wanted_height_m - config_.hold_m) {
    zone_ = AltitudeZone::kHold;
  }
  Controller::Direct out;
  if (zone_ == AltitudeZone::kTakeOff) {
    const double v = in.state.air_valid ? in.state.airspeed_m_s : in.state.v_W.head<2>().norm();
    out = takeoff_direct(flight, v, in.t_s - since_s_, start_course_rad_);
  } else if (zone_ == AltitudeZone::kClimb) {
    out.roll_rad = 0.0;
  }
  return out;
}

}  // namespace rosflight::autonomy::fixedwing
