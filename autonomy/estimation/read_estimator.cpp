// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/estimation/read_estimator.hpp"

namespace rosflight::autonomy::estimation {
namespace {

using config::Range;
using config::Section;

void position(const Section& in, std::string_view key, Vector3& value) {
  const auto n = in.numbers(key, 3, Range::between(-10.0, 10.0), {value.x(), value.y(), value.z()});
  value = {n[0], n[1], n[2]};
}

void sigma(const Section& in, std::string_view key, double& value) {
  value = in.number(key, Range::positive(), value);
}

void not_negative(const Section& in, std::string_view key, double& value) {
  value = in.number(key, Range::at_least(0.0), value);
}

void degrees(const Section& in, std::string_view key, Range allowed, double& value_rad) {
  value_rad = in.number(key, allowed, value_rad / kRadPerDeg) * kRadPerDeg;
}

void read_noise(const Section& in, ProcessNoise& noise) {
  sigma(in, "gyro_rad_s_rtHz", noise.gyro_rad_s_rtHz);
  sigma(in, "accel_m_s2_rtHz", noise.accel_m_s2_rtHz);
  not_negative(in, "gyro_bias_rad_s_rts", noise.gyro_bias_rad_s_rts);
  not_negative(in, "accel_bias_m_s2_rts", noise.accel_bias_m_s2_rts);
  not_negative(in, "baro_bias_m_rts", noise.baro_bias_m_rts);
  not_negative(in, "wind_m_s_rts", noise.wind_m_s_rts);
}

void read_sigmas(const Section& in, EstimatorConfig& c) {
  sigma(in, "gnss_horizontal_m", c.gnss_horizontal_sigma_m);
  sigma(in, "gnss_altitude_m", c.gnss_altitude_sigma_m);
  sigma(in, "gnss_velocity_m_s", c.gnss_velocity_sigma_m_s);
  sigma(in, "baro_m", c.baro_sigma_m);
  sigma(in, "mag_T", c.mag_sigma_T);
  degrees(in, "heading_deg", Range::between(0.0, 90.0), c.heading_sigma_rad);
  sigma(in, "range_m", c.range_sigma_m);
  sigma(in, "pitot_Pa", c.pitot_sigma_Pa);
  sigma(in, "sideslip_m_s", c.sideslip_sigma_m_s);
  sigma(in, "rest_m_s", c.rest_sigma_m_s);
}

}  // namespace

EstimatorConfig read_estimator(const Section& in, const EstimatorConfig& defaults) {
  EstimatorConfig c = defaults;
  c.lag_s = in.number("lag_s", Range::between(0.0, 0.5), c.lag_s);
  c.increment_s = in.number("increment_s", Range::between(0.005, 0.05), c.increment_s);
  position(in, "imu_position_m", c.imu_position_B);
  position(in, "gnss_position_m", c.gnss_position_B);
  position(in, "range_position_m", c.range_position_B);
  if (const auto noise = in.optional_section("process_noise")) read_noise(*noise, c.noise);
  if (const auto sigmas = in.optional_section("sigma")) read_sigmas(*sigmas, c);
  not_negative(in, "mag_interval_s", c.mag_interval_s);
  not_negative(in, "baro_interval_s", c.baro_interval_s);
  not_negative(in, "pitot_interval_s", c.pitot_interval_s);
  not_negative(in, "range_delay_s", c.range_delay_s);
  c.gate_sigma = in.number("gate_sigma", Range::between(1.0, 1000.0), c.gate_sigma);
  c.heading_gate_sigma =
      in.number("heading_gate_sigma", Range::between(1.0, 1000.0), c.heading_gate_sigma);
  c.use_range = in.boolean("use_range", c.use_range);
  degrees(in, "range_max_tilt_deg", Range::between(0.0, 80.0), c.range_max_tilt_rad);
  c.min_airspeed_m_s = in.number("min_airspeed_m_s", Range::positive(), c.min_airspeed_m_s);
  c.share_attitude = in.boolean("share_attitude", c.share_attitude);
  c.use_sideslip = in.boolean("use_sideslip", c.use_sideslip);
  sigma(in, "initial_gyro_bias_rad_s", c.initial_gyro_bias_rad_s);
  sigma(in, "initial_accel_bias_m_s2", c.initial_accel_bias_m_s2);
  sigma(in, "initial_wind_m_s", c.initial_wind_m_s);
  c.initial_window_s = in.number("initial_window_s", Range::between(0.1, 60.0), c.initial_window_s);
  if (in.has("declination_deg")) {
    c.declination_rad = in.number("declination_deg", Range::between(-180.0, 180.0)) * kRadPerDeg;
  }
  sigma(in, "gnss_doubt_s", c.gnss_doubt_s);
  sigma(in, "gnss_reset_s", c.gnss_reset_s);
  sigma(in, "baro_relearn_s", c.baro_relearn_s);
  sigma(in, "range_relearn_s", c.range_relearn_s);
  sigma(in, "jump_speed_m_s", c.jump_speed_m_s);
  sigma(in, "dead_reckoning_s", c.dead_reckoning_s);
  in.finish();
  return c;
}

}  // namespace rosflight::autonomy::estimation
