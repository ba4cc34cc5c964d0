// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sensors/read_config.hpp"

#include <cmath>
#include <string_view>

#include "sim/sensors/presets.hpp"

namespace rosflight::sim::sensors {
namespace {

using config::Range;
using config::Section;
using config::Table;
using config::Whole;

constexpr Whole kMicroseconds{0, 10'000'000};  // of a phase or delay
constexpr double kMaxRate_Hz = 10'000.0;
constexpr double kMaxError = 1e9;  // of an error, in any unit
constexpr double kFinestResolution = 1e-12;
constexpr double kMinDropout_s = 0.01;
constexpr Range kBias = Range::between(-kMaxError, kMaxError);
constexpr Range kSize = Range::between(0.0, kMaxError);

template <class S>
S& self(S& s) {
  return s;
}

/// Errors in the unit u of their section's name.
Table<ErrorParameters> law_table() {
  using E = ErrorParameters;
  using R = config::Row<E>;
  return {{"turn_on_bias", &E::turn_on_bias, "u", kSize, "largest bias drawn at the start"},
          {"noise_density", &E::noise_density, "u/sqrt(Hz)", kSize, "white noise"},
          {"noise_sigma", &E::noise_sigma, "u", kSize, "white noise of each sample, at any rate"},
          {"bias_walk", &E::bias_walk, "u/sqrt(s)", kSize, "random walk of the bias"},
          {"drift_sigma", &E::drift_sigma, "u", kSize, "bias that wanders about zero"},
          R{"drift_time_s", &E::drift_time_s, "s", kSize, "its time constant"}.must(
              "a number > 0 beside a drift_sigma",
              [](const E& e) { return e.drift_sigma <= 0.0 || e.drift_time_s > 0.0; }),
          R{"resolution", &E::resolution, "u", kSize, "step of the reading; 0: none"}.only(
              "0 or a number from 1e-12 to 1e+09",
              [](double x) { return x == 0.0 || x >= kFinestResolution; }),
          {"limit", &E::limit, "u", kSize, "largest reading; 0: none"}};
}

Table<ErrorParameters> error_table() {
  using E = ErrorParameters;
  return {{"fixed_bias", &E::fixed_bias, "u", kBias, "the same in every run"},
          {"", self<E>, law_table()}};
}

}  // namespace

/// Given as a rate, kept as a period of whole microseconds.
Table<Timing> timing_table() {
  using T = Timing;
  using R = config::Row<T>;
  const auto has_whole_period = [](double rate_Hz) {
    const double period_us = 1e6 / rate_Hz;
    return period_us <= static_cast<double>(kMicroseconds.high) &&
           std::abs(period_us - std::round(period_us)) <= 1e-9 * period_us;
  };
  return {
      {"enabled", &T::enabled, "false: the board finds no such sensor"},
      R{"rate_Hz", [](const T& t) { return 1e6 / static_cast<double>(t.period.count()); },
        [](T& t, double rate_Hz) { t.period = Time{std::llround(1e6 / rate_Hz)}; }, "Hz",
        Range::positive_up_to(kMaxRate_Hz), "samples per second"}
          .only("a rate of at least 0.1 whose period is a whole number of microseconds, such as "
                "50 or 400",
                has_whole_period),
      {"phase_us", &T::phase, "us", kMicroseconds, "of the first sample"},
      {"delay_us", &T::delay, "us", kMicroseconds, "from measurement to delivery"}};
}

Table<VectorErrorParameters> vector_error_table() {
  using E = VectorErrorParameters;
  return {{"fixed_bias", &E::fixed_bias, "u", kBias, "the same in every run"},
          {"", &E::axis, law_table()}};
}

namespace {

template <class C>
config::Row<C> timing() {
  return {"", &C::timing, timing_table()};
}

template <class C>
config::Row<C> errors(std::string_view key, ErrorParameters C::*member) {
  return {key, member, error_table()};
}

template <class C>
config::Row<C> errors(std::string_view key, VectorErrorParameters C::*member) {
  return {key, member, vector_error_table()};
}

template <class C>
config::Row<C> position() {
  return {"position_m", &C::position_m, "m", Range::between(-100.0, 100.0),
          "from the centre of mass, body axes"};
}

template <class C>
config::Row<C> rotation() {
  return {"rotation_deg", &C::rotation_deg, "deg", Range::between(-360.0, 360.0),
          "of the mounting: the firmware parameters of roll, pitch and yaw that undo it"};
}

template <class C>
config::Row<C> temperature() {
  return {"temperature_rise_K", config::at(&C::temperature, &Temperature::rise_K), "K",
          Range::between(0.0, 100.0), "above the air"};
}

Table<Imu::Config> imu_table() {
  using C = Imu::Config;
  constexpr Range kShare = Range::between(0.0, 1.0);
  constexpr Range kPerK = Range::between(-1.0, 1.0);
  return {timing<C>(),
          errors("gyro_rad_s", &C::gyro_rad_s),
          errors("accel_m_s2", &C::accel_m_s2),
          position<C>(),
          rotation<C>(),
          {"gyro_vibration", &C::gyro_vibration, "", kShare, "noise per rotor speed"},
          {"accel_vibration", &C::accel_vibration_m_s_rad, "m/s^2 per rad/s", kShare,
           "noise per rotor speed"},
          {"gyro_lines", &C::gyro_lines, "", kShare,
           "the same on boards whose parts are modelled, as lines at the frequencies of rotors and "
           "blades"},
          {"blades", &C::blades, "", Whole{1, 12}, "of a propeller, for these lines"},
          {"gyro_bias_per_K", &C::gyro_temperature_rad_s_K, "rad/s/K", kPerK, "from 298.15 K"},
          {"accel_bias_per_K", &C::accel_temperature_m_s2_K, "m/s^2/K", kPerK, "from 298.15 K"},
          temperature<C>(),
          {"warm_up_s", &C::warm_up_s, "s", Range::between(0.0, 1e5),
           "time constant of temperature_rise_K; 0: warm from the start"}};
}

Table<Magnetometer::Config> mag_table() {
  using C = Magnetometer::Config;
  using R = config::Row<C>;
  return {timing<C>(), errors("field_T", &C::field_T), rotation<C>(), temperature<C>(),
          R{"soft_iron", 9,
            [](const C& c) {
              const Eigen::Matrix3d by_columns = c.soft_iron.transpose();
              return std::vector<double>(by_columns.data(), by_columns.data() + 9);
            },
            [](C& c, const std::vector<double>& rows) {
              c.soft_iron = Eigen::Map<const Eigen::Matrix3d>(rows.data()).transpose();
            },
            "", Range::between(-10.0, 10.0), "matrix, row by row"}
              .must("nine numbers, row by row, of a matrix that can be inverted",
                    [](const C& c) { return std::abs(c.soft_iron.determinant()) > 1e-6; })};
}

Table<Barometer::Config> baro_table() {
  using C = Barometer::Config;
  return {timing<C>(),
          errors("pressure_Pa", &C::pressure_Pa),
          temperature<C>(),
          {"dynamic_pressure_share", &C::dynamic_pressure_share, "", Range::between(-2.0, 2.0),
           "of the dynamic pressure, added to the static one"}};
}

Table<PitotTube::Config> diff_pressure_table() {
  using C = PitotTube::Config;
  return {timing<C>(), errors("pressure_Pa", &C::pressure_Pa), temperature<C>()};
}

Table<Rangefinder::Config> range_table() {
  using C = Rangefinder::Config;
  using R = config::Row<C>;
  return {timing<C>(),
          errors("range_m", &C::range_m),
          position<C>(),
          {"min_m", &C::min_m, "m", kSize, "nearest distance that is measured"},
          R{"max_m", &C::max_m, "m", Range::positive_up_to(kMaxError),
            "farthest distance that is measured"}
              .must("a number > min_m", [](const C& c) { return c.min_m < c.max_m; }),
          {"max_tilt_deg", &C::max_tilt_deg, "deg", Range::between(0.0, 89.0), "no echo beyond it"},
          {"kind",
           &C::kind,
           {{"sonar", hal::RangeKind::kSonar}, {"lidar", hal::RangeKind::kLidar}},
           "as the message says"}};
}

Table<Gnss::Config> gnss_table() {
  using C = Gnss::Config;
  using R = config::Row<C>;
  const auto long_enough = [](double C::*duration_s) {
    return [duration_s](const C& c) {
      return c.dropout_interval_s <= 0.0 || c.*duration_s >= kMinDropout_s;
    };
  };
  constexpr std::string_view kLongEnough = "a number >= 0.01 where there are drop-outs";
  return {
      timing<C>(),
      errors("horizontal_m", &C::horizontal_m),
      errors("vertical_m", &C::vertical_m),
      errors("velocity_m_s", &C::velocity_m_s),
      position<C>(),
      {"horizontal_accuracy_m", &C::horizontal_accuracy_m, "m", kSize, "as reported"},
      {"vertical_accuracy_m", &C::vertical_accuracy_m, "m", kSize, "as reported"},
      {"speed_accuracy_m_s", &C::speed_accuracy_m_s, "m/s", kSize, "as reported"},
      {"satellites", &C::satellites, "", Whole{0, 255}, "as reported"},
      {"first_fix_s", &C::first_fix_s, "s", Range::between(0.0, 1e5), "from the start"},
      R{"dropout_interval_s", &C::dropout_interval_s, "s", Range::between(0.0, 1e6),
        "mean time between drop-outs; 0: none"}
          .must(kLongEnough, long_enough(&C::dropout_interval_s)),
      R{"dropout_duration_s", &C::dropout_duration_s, "s", Range::between(0.0, 1e6), "mean"}.must(
          kLongEnough, long_enough(&C::dropout_duration_s))};
}

Table<BatteryMonitor::Config> battery_table() {
  using C = BatteryMonitor::Config;
  return {timing<C>(), errors("voltage_V", &C::voltage_V), errors("current_A", &C::current_A)};
}

SensorsConfig read_preset(const Section& section) {
  using Preset = SensorsConfig (*)();
  const Section::Choices<Preset> presets{
      {"current", current_hardware}, {"reference", reference}, {"ideal", ideal}};
  return section.choice<Preset>("preset", presets, current_hardware)();
}

}  // namespace

Table<SensorsConfig> sensor_tables() {
  using C = SensorsConfig;
  return {{"imu", &C::imu, imu_table()},
          {"mag", &C::mag, mag_table()},
          {"baro", &C::baro, baro_table()},
          {"diff_pressure", &C::diff_pressure, diff_pressure_table()},
          {"range", &C::range, range_table()},
          {"gnss", &C::gnss, gnss_table()},
          {"battery", &C::battery, battery_table()}};
}

SensorsConfig read_sensors(const Section& section) {
  static_cast<void>(section.choice<bool>("module", {{"standard", true}}, true));
  SensorsConfig c = read_preset(section);
  static const Table<SensorsConfig> tables = sensor_tables();
  tables.read(section, c);
  section.finish();
  return c;
}

}  // namespace rosflight::sim::sensors
