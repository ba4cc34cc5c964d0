// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/estimation/read_estimator.hpp"

#include "config/table.hpp"

namespace rosflight::autonomy::estimation {
namespace {

using config::kDeg;
using config::Range;
using config::Row;
using config::Table;

constexpr Range kSigma = Range::positive();
constexpr Range kNotNegative = Range::at_least(0.0);
constexpr Range kPosition_m = Range::between(-10.0, 10.0);
constexpr Range kGate = Range::between(1.0, 1000.0);

Table<ProcessNoise> noise_table() {
  using N = ProcessNoise;
  return {
      {"gyro_rad_s_rtHz", &N::gyro_rad_s_rtHz, "rad/s/sqrt(Hz)", kSigma, "white noise"},
      {"accel_m_s2_rtHz", &N::accel_m_s2_rtHz, "m/s^2/sqrt(Hz)", kSigma, "white noise"},
      {"gyro_bias_rad_s_rts", &N::gyro_bias_rad_s_rts, "rad/s/sqrt(s)", kNotNegative,
       "random walk"},
      {"accel_bias_m_s2_rts", &N::accel_bias_m_s2_rts, "m/s^2/sqrt(s)", kNotNegative,
       "random walk"},
      {"baro_bias_m_rts", &N::baro_bias_m_rts, "m/sqrt(s)", kNotNegative, "random walk"},
      {"wind_m_s_rts", &N::wind_m_s_rts, "m/s/sqrt(s)", kNotNegative, "random walk in still air"},
      {"mag_bias_T_rts", &N::mag_bias_T_rts, "T/sqrt(s)", kNotNegative, "random walk"},
      {"air_scale_rts", &N::air_scale_rts, "1/sqrt(s)", kNotNegative, "random walk"},
      {"gust_down_m_s", &N::gust_down_m_s, "m/s", kNotNegative,
       "fixed wing: vertical gusts in still air: standard deviation"},
      {"lift_offset_rad_rts", &N::lift_offset_rad_rts, "rad/sqrt(s)", kNotNegative,
       "fixed wing: random walk of the error of the lift, as an angle of attack"},
      {"gnss_slow_horizontal_m", &N::gnss_slow_horizontal_m, "m", kNotNegative,
       "slow error of the satellites, each axis: standard deviation"},
      {"gnss_slow_altitude_m", &N::gnss_slow_altitude_m, "m", kNotNegative,
       "slow error of the satellites: standard deviation"},
      {"gnss_slow_time_s", &N::gnss_slow_time_s, "s", Range::positive(),
       "slow error of the satellites: correlation time"}};
}

Table<EstimatorConfig> sigma_table() {
  using E = EstimatorConfig;
  return {
      {"gnss_horizontal_m", &E::gnss_horizontal_sigma_m, "m", kSigma, "position, from fix to fix"},
      {"gnss_altitude_m", &E::gnss_altitude_sigma_m, "m", kSigma, "altitude, from fix to fix"},
      {"gnss_velocity_m_s", &E::gnss_velocity_sigma_m_s, "m/s", kSigma, "velocity"},
      {"gnss_position_m", &E::gnss_position_sigma_m, "m", kNotNegative,
       "position of the antenna: turning adds to the noise of the velocity"},
      {"gnss_time_s", &E::gnss_time_sigma_s, "s", kNotNegative,
       "stamp of a fix: accelerating adds to the noise of the velocity"},
      {"baro_m", &E::baro_sigma_m, "m", kSigma, "barometric altitude"},
      {"mag_T", &E::mag_sigma_T, "T", kSigma, "each axis of the magnetometer"},
      {"heading_deg", &E::heading_sigma_rad, kDeg, Range::between(0.0, 90.0),
       "besides mag_T: declination"},
      {"range_m", &E::range_sigma_m, "m", kSigma, "range sensor"},
      {"pitot_Pa", &E::pitot_sigma_Pa, "Pa", kSigma, "differential pressure"},
      {"sideslip_m_s", &E::sideslip_sigma_m_s, "m/s", kSigma, "lateral airspeed of a fixed wing"},
      {"air_force_m_s2", &E::air_force_sigma_m_s2, "m/s^2", kSigma,
       "specific force of the air, besides initial_air_scale"},
      {"air_force_turning_m_s", &E::air_force_turning_m_s, "m/s", kNotNegative,
       "fixed wing: side force of rudder, ailerons and turning, times the rate of turning"},
      {"lift_m_s2", &E::lift_sigma_m_s2, "m/s^2", kSigma, "fixed wing: specific force of the lift"},
      {"lift_turning_m_s", &E::lift_turning_m_s, "m/s", kNotNegative,
       "fixed wing: lift of elevator and turning, times the rate of turning"},
      {"pose_position_m", &E::pose_position_sigma_m, "m", kSigma,
       "each axis of the position of motion capture"},
      {"pose_heading_deg", &E::pose_heading_sigma_rad, kDeg, Range::between(0.01, 90.0),
       "heading of motion capture"},
      {"rest_m_s", &E::rest_sigma_m_s, "m/s", kSigma, "velocity while at rest"}};
}

}  // namespace

Table<EstimatorConfig> parameters() {
  using E = EstimatorConfig;
  return {
      {"lag_s", &E::lag_s, "s", Range::between(0.0, 0.5),
       "how late a sample may be and still be fused at its own time"},
      {"max_lag_s", &E::max_lag_s, "s", Range::between(0.0, 1.0),
       "to which GNSS that comes later may raise lag_s"},
      {"increment_s", &E::increment_s, "s", Range::between(0.005, 0.05),
       "IMU samples are summed over this"},
      {"imu_position_m", &E::imu_position_B, "m", kPosition_m,
       "from the body's origin: front, right, down"},
      {"gnss_position_m", &E::gnss_position_B, "m", kPosition_m,
       "from the body's origin: front, right, down"},
      {"range_position_m", &E::range_position_B, "m", kPosition_m,
       "from the body's origin: front, right, down"},
      {"process_noise", &E::noise, noise_table(), "of the model"},
      {"sigma", [](E& e) -> E& { return e; }, sigma_table(), "standard deviation of one sample"},
      {"mag_interval_s", &E::mag_interval_s, "s", kNotNegative,
       "samples sooner than this after the last are left out"},
      {"baro_interval_s", &E::baro_interval_s, "s", kNotNegative,
       "samples sooner than this after the last are left out"},
      {"pitot_interval_s", &E::pitot_interval_s, "s", kNotNegative,
       "samples sooner than this after the last are left out"},
      {"air_force_interval_s", &E::air_force_interval_s, "s", kNotNegative,
       "specific force is averaged over this before it is used"},
      {"range_delay_s", &E::range_delay_s, "s", kNotNegative,
       "subtracted from the stamp of an echo"},
      {"gate_sigma", &E::gate_sigma, "sigma", kGate,
       "innovation gate: outside, a sample is rejected"},
      {"heading_gate_sigma", &E::heading_gate_sigma, "sigma", kGate,
       "innovation gate of the heading"},
      {"use_pose", &E::use_pose, "use the pose of motion capture, if there is one"},
      {"use_range", &E::use_range, "use the range sensor, over level ground"},
      {"range_max_tilt_deg", &E::range_max_tilt_rad, kDeg, Range::between(0.0, 80.0),
       "with more tilt the range sensor is not used"},
      {"min_airspeed_m_s", &E::min_airspeed_m_s, "m/s", Range::positive(),
       "below this, differential pressure and sideslip are not used"},
      {"share_attitude", &E::share_attitude,
       "the attitude goes to the flight controller's estimator"},
      {"use_sideslip", &E::use_sideslip, "fixed wing: assume no sideslip"},
      {"initial_gyro_bias_rad_s", &E::initial_gyro_bias_rad_s, "rad/s", kSigma,
       "standard deviation at the start"},
      {"initial_accel_bias_m_s2", &E::initial_accel_bias_m_s2, "m/s^2", kSigma,
       "standard deviation at the start"},
      {"initial_wind_m_s", &E::initial_wind_m_s, "m/s", kSigma, "standard deviation at the start"},
      {"initial_mag_bias_T", &E::initial_mag_bias_T, "T", kSigma,
       "iron of the vehicle, each axis: standard deviation at the start"},
      {"initial_air_scale", &E::initial_air_scale, "", kNotNegative,
       "relative error of the drag and side force in this file: standard deviation at the start"},
      {"initial_lift_offset_rad", &E::initial_lift_offset_rad, "rad", kNotNegative,
       "fixed wing: error of the lift in this file, as an angle of attack: standard deviation at "
       "the start"},
      {"initial_window_s", &E::initial_window_s, "s", Range::between(0.1, 60.0),
       "averaged before the start"},
      Row<E>{"declination_deg", &E::declination_rad, kDeg, Range::between(-180.0, 180.0),
             "east, instead of the magnetic model"}
          .if_absent("WMM2025"),
      Row<E>{"gnss_rejected_s", &E::gnss_rejected_s, "s", kSigma,
             "velocity rejected for this long: the IMU may have changed"}
          .formerly("gnss_doubt_s"),
      {"gnss_reset_s", &E::gnss_reset_s, "s", kSigma,
       "GNSS rejected for this long: the estimate is reset to GNSS"},
      {"pose_reset_s", &E::pose_reset_s, "s", kSigma,
       "motion capture rejected for this long: the position is set to it"},
      {"max_wind_noise_m_s_rts", &E::max_wind_noise_m_s_rts, "m/s/sqrt(s)", kSigma,
       "to which gusts may raise process_noise.wind_m_s_rts; at the start"},
      {"pitot_relearn_s", &E::pitot_relearn_s, "s", kSigma,
       "differential pressure rejected for this long, not blocked: the wind has another speed"},
      {"gnss_jump_s", &E::gnss_jump_s, "s", kSigma,
       "position alone rejected for this long: the error of the satellites is estimated again"},
      {"baro_relearn_s", &E::baro_relearn_s, "s", kSigma,
       "barometer rejected for this long: its bias is estimated again"},
      {"range_relearn_s", &E::range_relearn_s, "s", kSigma,
       "range rejected for this long: the ground has another altitude"},
      {"jump_speed_m_s", &E::jump_speed_m_s, "m/s", kSigma,
       "at which a reset of the position is shown when GNSS returns"},
      {"dead_reckoning_s", &E::dead_reckoning_s, "s", kSigma,
       "without GNSS for this long the position is not valid"}};
}

EstimatorConfig read_estimator(const config::Section& in, const EstimatorConfig& defaults) {
  EstimatorConfig config = defaults;
  static const Table<EstimatorConfig> table = parameters();
  table.read(in, config);
  in.finish();
  return config;
}

}  // namespace rosflight::autonomy::estimation
