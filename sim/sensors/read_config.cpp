// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sensors/read_config.hpp"

#include <cmath>
#include <string>

#include "sim/sensors/presets.hpp"

namespace rosflight::sim::sensors {
namespace {
using config::Range;
using config::Section;

constexpr std::int64_t kLongest_us = 10'000'000;  // of a phase or delay
constexpr double kMaxRate_Hz = 10'000.0;
constexpr double kLargest = 1e9;  // of an error, in any unit
constexpr double kFinestResolution = 1e-12;
constexpr double kShortestDropout_s = 0.01;
constexpr Range kBias = Range::between(-kLargest, kLargest);

void read_vector(const Section& in, std::string_view key, Range allowed, Vector3& v) {
  const auto values = in.numbers(key, 3, allowed, {v.x(), v.y(), v.z()});
  v = {values[0], values[1], values[2]};
}

void read_position(const Section& in, Vector3& position_m) {
  read_vector(in, "position_m", Range::between(-100.0, 100.0), position_m);
}

void read_rotation(const Section& in, Vector3& rotation_deg) {
  read_vector(in, "rotation_deg", Range::between(-360.0, 360.0), rotation_deg);
}

/// Given as a rate, kept as a period of whole microseconds.
void read_timing(const Section& in, Timing& timing) {
  timing.enabled = in.boolean("enabled", timing.enabled);
  const double old_rate_Hz = 1e6 / static_cast<double>(timing.period.count());
  const double rate_Hz = in.number("rate_Hz", Range::positive_up_to(kMaxRate_Hz), old_rate_Hz);
  if (in.has("rate_Hz")) {
    const double period_us = 1e6 / rate_Hz;
    if (!(period_us <= static_cast<double>(kLongest_us)) ||
        std::abs(period_us - std::round(period_us)) > 1e-9 * period_us) {
      throw in.error(
          "rate_Hz", in.raw("rate_Hz"),
          "a rate of at least 0.1 whose period is a whole number of microseconds, such as "
          "50 or 400");
    }
    timing.period = Time{std::llround(period_us)};
  }
  timing.phase = Time{in.integer("phase_us", 0, kLongest_us, timing.phase.count())};
  timing.delay = Time{in.integer("delay_us", 0, kLongest_us, timing.delay.count())};
}

void read_error_laws(const Section& in, ErrorParameters& p) {
  const Range size = Range::between(0.0, kLargest);
  p.turn_on_bias = in.number("turn_on_bias", size, p.turn_on_bias);
  p.noise_density = in.number("noise_density", size, p.noise_density);
  p.noise_sigma = in.number("noise_sigma", size, p.noise_sigma);
  p.bias_walk = in.number("bias_walk", size, p.bias_walk);
  p.drift_sigma = in.number("drift_sigma", size, p.drift_sigma);
  p.drift_time_s = in.number("drift_time_s", size, p.drift_time_s);
  if (p.drift_sigma > 0.0 && p.drift_time_s <= 0.0) {
    throw in.error("drift_time_s", in.raw("drift_time_s"), "a number > 0 beside a drift_sigma");
  }
  p.resolution = in.number("resolution", size, p.resolution);
  if (p.resolution > 0.0 && p.resolution < kFinestResolution) {
    throw in.error("resolution", in.raw("resolution"), "0 or a number from 1e-12 to 1e+09");
  }
  p.limit = in.number("limit", size, p.limit);
}

void read_errors(const Section& in, std::string_view key, ErrorParameters& p) {
  const auto section = in.optional_section(key);
  if (!section) return;
  p.fixed_bias = section->number("fixed_bias", kBias, p.fixed_bias);
  read_error_laws(*section, p);
}

void read_errors(const Section& in, std::string_view key, VectorErrorParameters& p) {
  const auto section = in.optional_section(key);
  if (!section) return;
  read_vector(*section, "fixed_bias", kBias, p.fixed_bias);
  read_error_laws(*section, p.axis);
}

void read_temperature(const Section& in, Temperature& temperature) {
  temperature.rise_K =
      in.number("temperature_rise_K", Range::between(0.0, 100.0), temperature.rise_K);
}

void read_imu(const Section& in, Imu::Config& imu) {
  read_timing(in, imu.timing);
  read_errors(in, "gyro_rad_s", imu.gyro_rad_s);
  read_errors(in, "accel_m_s2", imu.accel_m_s2);
  read_position(in, imu.position_m);
  read_rotation(in, imu.rotation_deg);
  imu.gyro_vibration = in.number("gyro_vibration", Range::between(0.0, 1.0), imu.gyro_vibration);
  imu.accel_vibration_m_s_rad =
      in.number("accel_vibration", Range::between(0.0, 1.0), imu.accel_vibration_m_s_rad);
  read_vector(in, "gyro_bias_per_K", Range::between(-1.0, 1.0), imu.gyro_temperature_rad_s_K);
  read_vector(in, "accel_bias_per_K", Range::between(-1.0, 1.0), imu.accel_temperature_m_s2_K);
  read_temperature(in, imu.temperature);
  imu.warm_up_s = in.number("warm_up_s", Range::between(0.0, 1e5), imu.warm_up_s);
}

void read_mag(const Section& in, Magnetometer::Config& mag) {
  read_timing(in, mag.timing);
  read_errors(in, "field_T", mag.field_T);
  read_rotation(in, mag.rotation_deg);
  read_temperature(in, mag.temperature);
  if (!in.has("soft_iron")) return;
  const auto a = in.numbers("soft_iron", 9, Range::between(-10.0, 10.0));
  mag.soft_iron << a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8];
  if (!(std::abs(mag.soft_iron.determinant()) > 1e-6)) {
    throw in.error("soft_iron", "a singular matrix",
                   "nine numbers, row by row, that can be inverted");
  }
}

void read_baro(const Section& in, Barometer::Config& baro) {
  read_timing(in, baro.timing);
  read_errors(in, "pressure_Pa", baro.pressure_Pa);
  read_temperature(in, baro.temperature);
  baro.dynamic_pressure_share =
      in.number("dynamic_pressure_share", Range::between(-2.0, 2.0), baro.dynamic_pressure_share);
}

void read_diff_pressure(const Section& in, PitotTube::Config& pitot) {
  read_timing(in, pitot.timing);
  read_errors(in, "pressure_Pa", pitot.pressure_Pa);
  read_temperature(in, pitot.temperature);
}

void read_range(const Section& in, Rangefinder::Config& range) {
  read_timing(in, range.timing);
  read_errors(in, "range_m", range.range_m);
  read_position(in, range.position_m);
  range.min_m = in.number("min_m", Range::between(0.0, kLargest), range.min_m);
  range.max_m = in.number("max_m", Range::positive_up_to(kLargest), range.max_m);
  if (!(range.min_m < range.max_m)) {
    throw in.error("max_m", in.raw("max_m"),
                   "a number > min_m (" + config::number_text(range.min_m) + ")");
  }
  range.max_tilt_deg = in.number("max_tilt_deg", Range::between(0.0, 89.0), range.max_tilt_deg);
  const Section::Choices<hal::RangeKind> kinds{{"sonar", hal::RangeKind::kSonar},
                                               {"lidar", hal::RangeKind::kLidar}};
  range.kind = in.choice("kind", kinds, range.kind);
}

void read_gnss(const Section& in, Gnss::Config& gnss) {
  const Range at_least_0 = Range::between(0.0, kLargest);
  read_timing(in, gnss.timing);
  read_errors(in, "horizontal_m", gnss.horizontal_m);
  read_errors(in, "vertical_m", gnss.vertical_m);
  read_errors(in, "velocity_m_s", gnss.velocity_m_s);
  read_position(in, gnss.position_m);
  gnss.horizontal_accuracy_m =
      in.number("horizontal_accuracy_m", at_least_0, gnss.horizontal_accuracy_m);
  gnss.vertical_accuracy_m = in.number("vertical_accuracy_m", at_least_0, gnss.vertical_accuracy_m);
  gnss.speed_accuracy_m_s = in.number("speed_accuracy_m_s", at_least_0, gnss.speed_accuracy_m_s);
  gnss.satellites = static_cast<int>(in.integer("satellites", 0, 255, gnss.satellites));
  gnss.first_fix_s = in.number("first_fix_s", Range::between(0.0, 1e5), gnss.first_fix_s);
  gnss.dropout_interval_s =
      in.number("dropout_interval_s", Range::between(0.0, 1e6), gnss.dropout_interval_s);
  gnss.dropout_duration_s =
      in.number("dropout_duration_s", Range::between(0.0, 1e6), gnss.dropout_duration_s);
  const auto check_dropout = [&in, &gnss](std::string_view key, double seconds) {
    if (gnss.dropout_interval_s > 0.0 && seconds < kShortestDropout_s) {
      throw in.error(key, in.raw(key), "a number >= 0.01 where there are drop-outs");
    }
  };
  check_dropout("dropout_interval_s", gnss.dropout_interval_s);
  check_dropout("dropout_duration_s", gnss.dropout_duration_s);
}

void read_battery(const Section& in, BatteryMonitor::Config& battery) {
  read_timing(in, battery.timing);
  read_errors(in, "voltage_V", battery.voltage_V);
  read_errors(in, "current_A", battery.current_A);
}

SensorsConfig read_preset(const Section& section) {
  using Preset = SensorsConfig (*)();
  const Section::Choices<Preset> presets{
      {"current", current_hardware}, {"reference", reference}, {"ideal", ideal}};
  return section.choice<Preset>("preset", presets, current_hardware)();
}
}  // namespace

SensorsConfig read_sensors(const Section& section) {
  static_cast<void>(section.choice<bool>("module", {{"standard", true}}, true));
  SensorsConfig c = read_preset(section);
  if (const auto in = section.optional_section("imu")) read_imu(*in, c.imu);
  if (const auto in = section.optional_section("mag")) read_mag(*in, c.mag);
  if (const auto in = section.optional_section("baro")) read_baro(*in, c.baro);
  if (const auto in = section.optional_section("diff_pressure")) {
    read_diff_pressure(*in, c.diff_pressure);
  }
  if (const auto in = section.optional_section("range")) read_range(*in, c.range);
  if (const auto in = section.optional_section("gnss")) read_gnss(*in, c.gnss);
  if (const auto in = section.optional_section("battery")) read_battery(*in, c.battery);
  section.finish();
  return c;
}

}  // namespace rosflight::sim::sensors
