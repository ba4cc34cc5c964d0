// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <utility>

#include "config/table.hpp"
#include "sim/sensors/sampling.hpp"
#include "sim/world_sensors/world_sensor.hpp"

namespace rosflight::sim {

/// Clock and delay as keys of a section: enabled, rate_Hz, phase_us, delay_us.
config::Table<Timing> timing_table();
/// position_m and rotation_deg.
config::Table<Mounting> mounting_table();
/// @throws config::Error  a rate above that of the simulation, at `rate_Hz` of the section.
void check_rate(const WorldSensorSite& site, const Timing& timing);

/// A factory for an instrument, which is a class with
///
///     struct Config { Timing timing; Mounting mounting; ... };   // no mounting: not on the vehicle
///     static config::Table<Config> parameters();                 // what it has besides these two
///     using Sample = ...;                                        // one of WorldSample
///     Instrument(const Config&, const WorldSensorSite&);
///     bool measure(const Truth&, Sample&);                       // false: no sample this time
///
/// Its registration is one line: registry.world_sensors.add("name", world_sensor<Instrument>()).
/// docs/simulation/new-sensor.md is a worked example.
template <class Instrument>
WorldSensorFactory world_sensor();

namespace detail {

template <class Config>
constexpr bool kIsMounted = requires(Config c) { c.mounting; };

template <class Instrument>
class ScheduledWorldSensor final : public WorldSensor {
 public:
  using Config = typename Instrument::Config;
  ScheduledWorldSensor(const Config& config, const WorldSensorSite& site)
      : config_{config}, scheduled_{config.timing, Instrument{config, site}} {}

  const WorldSample* step(const Truth& truth) override {
    auto& sample = std::get<typename Instrument::Sample>(sample_);
    return scheduled_.step(truth, sample) ? &sample_ : nullptr;
  }
  const Mounting* mounting() const override {
    if constexpr (kIsMounted<Config>) {
      return &config_.mounting;
    } else {
      return nullptr;
    }
  }

 private:
  Config config_;
  sensors::Scheduled<Instrument> scheduled_;
  WorldSample sample_{typename Instrument::Sample{}};
};

}  // namespace detail

template <class Instrument>
WorldSensorFactory world_sensor() {
  return [](const WorldSensorSite& site) -> std::unique_ptr<WorldSensor> {
    using Config = typename Instrument::Config;
    Config config;
    timing_table().read(site.section, config.timing);
    if constexpr (detail::kIsMounted<Config>) mounting_table().read(site.section, config.mounting);
    Instrument::parameters().read(site.section, config);
    site.section.finish();
    check_rate(site, config.timing);
    return std::make_unique<detail::ScheduledWorldSensor<Instrument>>(config, site);
  };
}

}  // namespace rosflight::sim
