// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a vehicle file: refused with one line, or built, with sensors whose readings are
// numbers.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "sim/sensors/register.hpp"

namespace {
using namespace rosflight;

void check(bool good) {
  if (!good) std::abort();
}

void check_numbers(const sim::SensorSamples& s) {
  for (const float x : s.imu.gyro_rad_s) check(std::isfinite(x));
  for (const float x : s.imu.accel_m_s2) check(std::isfinite(x));
  for (const float x : s.mag.field_T) check(std::isfinite(x));
  check(std::isfinite(s.baro.pressure_Pa) && std::isfinite(s.diff_pressure.pressure_Pa));
  check(std::isfinite(s.range.range_m));
  check(std::isfinite(s.gnss.latitude_deg) && std::isfinite(s.gnss.longitude_deg));
  check(std::isfinite(s.battery.voltage_V) && std::isfinite(s.battery.current_A));
}

void build_and_run(const std::string& text) {
  sim::Registry registry;
  sim::register_physics(registry);
  sim::sensors::register_sensors(registry);
  const sim::RandomSource random{1};
  const sim::Vehicle vehicle(config::Document::from_text(text, "fuzz"));
  const auto sensors = sim::sensors::make_sensors(registry, vehicle, random);
  const auto forces = registry.make_forces(vehicle, random);
  sim::Truth truth;
  sim::SensorSamples samples;
  for (int i = 0; i < 100; ++i) {
    truth.time = sim::Time{2500 * i};
    sensors->step(truth, samples);
  }
  check_numbers(samples);
}
}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    build_and_run(std::string(data, data + size));
  } catch (const config::Error& error) {
    check(std::string_view(error.what()).find('\n') == std::string_view::npos);
  }
  return 0;
}
