// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sensors/read_config.hpp"

#include <gtest/gtest.h>

#include <string>

#include "sim/sensors/presets.hpp"

namespace rosflight::sim::sensors {
namespace {

SensorsConfig read(const std::string& text) {
  return read_sensors(config::Document::from_text(text, "v.yaml").root().section("sensors"));
}

std::string message_of(const std::string& text) {
  try {
    static_cast<void>(read(text));
  } catch (const config::Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(ReadSensors, NothingGivenIsCurrentHardware) {
  const SensorsConfig c = read("sensors: {}\n");
  EXPECT_EQ(c.imu.gyro_rad_s.axis.noise_density,
            current_hardware().imu.gyro_rad_s.axis.noise_density);
  EXPECT_GT(c.imu.gyro_rad_s.axis.noise_density, 0.0);
}

TEST(ReadSensors, PresetsAreChosenByName) {
  EXPECT_EQ(read("sensors: {preset: ideal}\n").imu.gyro_rad_s.axis.noise_density, 0.0);
  EXPECT_EQ(read("sensors: {preset: current}\n").range.min_m, 0.2);
  EXPECT_TRUE(read("sensors: {preset: reference}\n").imu.quiet_without_rotors);
  EXPECT_EQ(message_of("sensors: {preset: perfect}\n"),
            "v.yaml:1: sensors.preset: found perfect, allowed current, reference, ideal");
}

TEST(ReadSensors, EveryKeyIsRead) {
  const SensorsConfig c = read(R"(
sensors:
  preset: ideal
  imu:
    enabled: true
    rate_Hz: 1000
    phase_us: 100
    delay_us: 2510
    gyro_rad_s: {fixed_bias: [0.1, 0.2, 0.3], turn_on_bias: 1, noise_density: 2, noise_sigma: 3, bias_walk: 4,
                 drift_sigma: 5, drift_time_s: 6, resolution: 7, limit: 8}
    accel_m_s2: {noise_sigma: 9}
    position_m: [1, 2, 3]
    rotation_deg: [4, 5, 6]
    gyro_vibration: 0.1
    accel_vibration: 0.2
    gyro_lines: 0.3
    blades: 4
    gyro_bias_per_K: [0.1, 0.2, 0.3]
    accel_bias_per_K: [0.4, 0.5, 0.6]
    temperature_rise_K: 7
    warm_up_s: 8
  mag:
    field_T: {fixed_bias: [1, 2, 3]}
    rotation_deg: [7, 8, 9]
    soft_iron: [1, 2, 3, 0, 1, 4, 0, 0, 1]
    temperature_rise_K: 1
  baro:
    pressure_Pa: {fixed_bias: 10}
    dynamic_pressure_share: -0.3
    temperature_rise_K: 2
  diff_pressure:
    enabled: false
    pressure_Pa: {limit: 11}
    temperature_rise_K: 3
  range:
    range_m: {noise_sigma: 12}
    position_m: [0, 0, 0.1]
    min_m: 0.5
    max_m: 40
    max_tilt_deg: 60
    kind: lidar
  gnss:
    horizontal_m: {noise_sigma: 13}
    vertical_m: {noise_sigma: 14}
    velocity_m_s: {noise_sigma: 15}
    position_m: [0, 0, -0.1]
    horizontal_accuracy_m: 16
    vertical_accuracy_m: 17
    speed_accuracy_m_s: 18
    satellites: 19
    first_fix_s: 20
    dropout_interval_s: 21
    dropout_duration_s: 22
  battery:
    rate_Hz: 20
    voltage_V: {noise_sigma: 23}
    current_A: {noise_sigma: 24}
)");
  EXPECT_EQ(c.imu.timing.period, Time{1000});
  EXPECT_EQ(c.imu.timing.phase, Time{100});
  EXPECT_EQ(c.imu.timing.delay, Time{2510});
  const ErrorParameters& gyro = c.imu.gyro_rad_s.axis;
  EXPECT_EQ(c.imu.gyro_rad_s.fixed_bias, Vector3(0.1, 0.2, 0.3));
  EXPECT_EQ(gyro.turn_on_bias, 1.0);
  EXPECT_EQ(gyro.noise_density, 2.0);
  EXPECT_EQ(gyro.noise_sigma, 3.0);
  EXPECT_EQ(gyro.bias_walk, 4.0);
  EXPECT_EQ(gyro.drift_sigma, 5.0);
  EXPECT_EQ(gyro.drift_time_s, 6.0);
  EXPECT_EQ(gyro.resolution, 7.0);
  EXPECT_EQ(gyro.limit, 8.0);
  EXPECT_EQ(c.imu.accel_m_s2.axis.noise_sigma, 9.0);
  EXPECT_EQ(c.imu.position_m, Vector3(1.0, 2.0, 3.0));
  EXPECT_EQ(c.imu.rotation_deg, Vector3(4.0, 5.0, 6.0));
  EXPECT_EQ(c.imu.gyro_vibration, 0.1);
  EXPECT_EQ(c.imu.accel_vibration_m_s_rad, 0.2);
  EXPECT_EQ(c.imu.gyro_lines, 0.3);
  EXPECT_EQ(c.imu.blades, 4);
  EXPECT_EQ(c.imu.gyro_temperature_rad_s_K, Vector3(0.1, 0.2, 0.3));
  EXPECT_EQ(c.imu.accel_temperature_m_s2_K, Vector3(0.4, 0.5, 0.6));
  EXPECT_EQ(c.imu.temperature.rise_K, 7.0);
  EXPECT_EQ(c.imu.warm_up_s, 8.0);
  EXPECT_EQ(c.mag.field_T.fixed_bias, Vector3(1.0, 2.0, 3.0));
  EXPECT_EQ(c.mag.rotation_deg, Vector3(7.0, 8.0, 9.0));
  EXPECT_EQ(c.mag.soft_iron(0, 2), 3.0);
  EXPECT_EQ(c.mag.soft_iron(1, 2), 4.0);
  EXPECT_EQ(c.mag.temperature.rise_K, 1.0);
  EXPECT_EQ(c.baro.pressure_Pa.fixed_bias, 10.0);
  EXPECT_EQ(c.baro.dynamic_pressure_share, -0.3);
  EXPECT_EQ(c.baro.temperature.rise_K, 2.0);
  EXPECT_FALSE(c.diff_pressure.timing.enabled);
  EXPECT_EQ(c.diff_pressure.pressure_Pa.limit, 11.0);
  EXPECT_EQ(c.diff_pressure.temperature.rise_K, 3.0);
  EXPECT_EQ(c.range.range_m.noise_sigma, 12.0);
  EXPECT_EQ(c.range.position_m.z(), 0.1);
  EXPECT_EQ(c.range.min_m, 0.5);
  EXPECT_EQ(c.range.max_m, 40.0);
  EXPECT_EQ(c.range.max_tilt_deg, 60.0);
  EXPECT_EQ(c.range.kind, hal::RangeKind::kLidar);
  EXPECT_EQ(c.gnss.horizontal_m.noise_sigma, 13.0);
  EXPECT_EQ(c.gnss.vertical_m.noise_sigma, 14.0);
  EXPECT_EQ(c.gnss.velocity_m_s.axis.noise_sigma, 15.0);
  EXPECT_EQ(c.gnss.position_m.z(), -0.1);
  EXPECT_EQ(c.gnss.horizontal_accuracy_m, 16.0);
  EXPECT_EQ(c.gnss.vertical_accuracy_m, 17.0);
  EXPECT_EQ(c.gnss.speed_accuracy_m_s, 18.0);
  EXPECT_EQ(c.gnss.satellites, 19);
  EXPECT_EQ(c.gnss.first_fix_s, 20.0);
  EXPECT_EQ(c.gnss.dropout_interval_s, 21.0);
  EXPECT_EQ(c.gnss.dropout_duration_s, 22.0);
  EXPECT_EQ(c.battery.timing.period, Time{50'000});
  EXPECT_EQ(c.battery.voltage_V.noise_sigma, 23.0);
  EXPECT_EQ(c.battery.current_A.noise_sigma, 24.0);
}

TEST(ReadSensors, WhatIsNotGivenComesFromThePreset) {
  const SensorsConfig c = read("sensors: {imu: {gyro_rad_s: {noise_density: 0.5}}}\n");
  const SensorsConfig preset = current_hardware();
  EXPECT_EQ(c.imu.gyro_rad_s.axis.noise_density, 0.5);
  EXPECT_EQ(c.imu.gyro_rad_s.axis.resolution, preset.imu.gyro_rad_s.axis.resolution);
  EXPECT_EQ(c.imu.timing.period, preset.imu.timing.period);
}

TEST(ReadSensors, PeriodsAreWholeMicroseconds) {
  EXPECT_EQ(read("sensors: {mag: {rate_Hz: 0.1}}\n").mag.timing.period, Time{10'000'000});
  EXPECT_EQ(read("sensors: {mag: {rate_Hz: 62.5}}\n").mag.timing.period, Time{16'000});
  EXPECT_EQ(message_of("sensors: {mag: {rate_Hz: 30}}\n"),
            "v.yaml:1: sensors.mag.rate_Hz: found 30, allowed a rate of at least 0.1 whose period "
            "is a whole "
            "number of microseconds, such as 50 or 400");
  EXPECT_NE(message_of("sensors: {mag: {rate_Hz: 0.05}}\n"), "no error");
  EXPECT_EQ(message_of("sensors: {mag: {rate_Hz: 0}}\n"),
            "v.yaml:1: sensors.mag.rate_Hz: found 0, allowed a number > 0 and <= 10000");
}

TEST(ReadSensors, MistakesHaveTheirLineAndWhatIsAllowed) {
  EXPECT_EQ(message_of("sensors:\n  imu:\n    gyro: {}\n"),
            "v.yaml:3: sensors.imu.gyro: found an unknown key, allowed enabled, rate_Hz, phase_us, "
            "delay_us, "
            "gyro_rad_s, accel_m_s2, position_m, rotation_deg, gyro_vibration, accel_vibration, "
            "gyro_lines, blades, gyro_bias_per_K, accel_bias_per_K, temperature_rise_K, warm_up_s");
  EXPECT_EQ(
      message_of("sensors: {sonar: {}}\n"),
      "v.yaml:1: sensors.sonar: found an unknown key, allowed module, preset, imu, mag, baro, "
      "diff_pressure, range, gnss, battery");
  EXPECT_EQ(
      message_of("sensors: {imu: {gyro_rad_s: {noise_sigma: -1}}}\n"),
      "v.yaml:1: sensors.imu.gyro_rad_s.noise_sigma: found -1, allowed a number from 0 to 1e+09");
  EXPECT_EQ(message_of("sensors: {preset: ideal, baro: {pressure_Pa: {drift_sigma: 1}}}\n"),
            "v.yaml:1: sensors.baro.pressure_Pa.drift_time_s: found nothing, allowed a number > 0 "
            "beside a "
            "drift_sigma");
  EXPECT_EQ(message_of("sensors: {baro: {pressure_Pa: {resolution: 1e-13}}}\n"),
            "v.yaml:1: sensors.baro.pressure_Pa.resolution: found 1e-13, allowed 0 or a number "
            "from 1e-12 to "
            "1e+09");
  EXPECT_EQ(message_of("sensors: {range: {min_m: 8}}\n"),
            "v.yaml:1: sensors.range.max_m: found nothing, allowed a number > min_m");
  EXPECT_EQ(message_of("sensors: {gnss: {dropout_interval_s: 8}}\n"),
            "v.yaml:1: sensors.gnss.dropout_duration_s: found nothing, allowed a number >= 0.01 "
            "where there are "
            "drop-outs");
  EXPECT_EQ(message_of("sensors: {mag: {soft_iron: [1, 1, 1, 1, 1, 1, 1, 1, 1]}}\n"),
            "v.yaml:1: sensors.mag.soft_iron: found [1, 1, 1, 1, 1, 1, 1, 1, 1], allowed nine "
            "numbers, row "
            "by row, of a matrix that can be inverted");
  EXPECT_EQ(message_of("sensors: {mag: {soft_iron: [1, 0, 0]}}\n"),
            "v.yaml:1: sensors.mag.soft_iron: found a list of 3, allowed a list of 9 numbers, each "
            "a number "
            "from -10 to 10");
  EXPECT_EQ(message_of("sensors: {range: {kind: radar}}\n"),
            "v.yaml:1: sensors.range.kind: found radar, allowed sonar, lidar");
  EXPECT_EQ(message_of("sensors: {imu: {enabled: yes}}\n"),
            "v.yaml:1: sensors.imu.enabled: found yes, allowed true or false");
  EXPECT_EQ(message_of("sensors: {imu: {delay_us: 1.5}}\n"),
            "v.yaml:1: sensors.imu.delay_us: found 1.5, allowed an integer from 0 to 10000000");
  EXPECT_EQ(message_of("sensors: {imu: 5}\n"), "v.yaml:1: sensors.imu: found 5, allowed a map");
}

}  // namespace
}  // namespace rosflight::sim::sensors
