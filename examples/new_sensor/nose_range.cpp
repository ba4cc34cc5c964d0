// SPDX-License-Identifier: BSD-3-Clause
#include "sim/registry.hpp"
#include "sim/world_sensors/make_world_sensor.hpp"

namespace {

namespace config = rosflight::config;
namespace sim = rosflight::sim;

/// Distance along the nose to the nearest shape of the world.
class NoseRange {
 public:
  using Sample = rosflight::hal::RangeSample;

  struct Config {
    sim::Timing timing{true, sim::Time{50'000}, sim::Time{0}, sim::Time{0}};
    sim::Mounting mounting;
    double max_m{20.0};
  };
  static config::Table<Config> parameters() {
    return {
        {"max_m", &Config::max_m, "m", config::Range::positive_up_to(1000.0), "no echo beyond"}};
  }

  NoseRange(const Config& config, const sim::WorldSensorSite& site)
      : config_(config),
        position_B_(site.from_centre_of_mass(config.mounting)),
        shapes_(site.shapes) {}

  bool measure(const sim::Truth& truth, Sample& sample) {
    const sim::Quaternion& q_WB = truth.body.q_WB;
    const sim::world::Ray nose{truth.body.p_W + q_WB * position_B_, q_WB * sim::Vector3::UnitX()};
    const auto hit = shapes_.cast(nose, config_.max_m);
    sample.stamp = truth.time;
    sample.range_m = static_cast<float>(hit.distance_m);
    sample.max_m = static_cast<float>(config_.max_m);
    return hit.shape != nullptr;
  }

 private:
  Config config_;
  sim::Vector3 position_B_;
  const sim::world::WorldShapes& shapes_;
};

}  // namespace

extern "C" void rosflight_register(sim::Registry& registry) {
  registry.world_sensors.add("nose_range", sim::world_sensor<NoseRange>());
}
