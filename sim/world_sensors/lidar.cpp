// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world_sensors/lidar.hpp"

#include "sim/portable_math.hpp"

namespace rosflight::sim {
namespace {

double lidar_step_rad(const Lidar::Config& config) {
  if (config.rays < 2) return 0.0;
  return (config.angle_max_rad - config.angle_min_rad) / static_cast<double>(config.rays - 1);
}

}  // namespace

config::Table<Lidar::Config> Lidar::parameters() {
  using C = Config;
  using R = config::Row<C>;
  const config::Range turn = config::Range::between(-360.0, 360.0);
  return {{"rays", &C::rays, "", config::Whole{1, 100'000}, "of a scan"},
          {"angle_min_deg", &C::angle_min_rad, config::kDeg, turn, "of the first ray, to the left"},
          R{"angle_max_deg", &C::angle_max_rad, config::kDeg, turn, "of the last ray, to the left"}
              .must("a number > angle_min_deg",
                    [](const C& c) { return c.angle_max_rad > c.angle_min_rad; }),
          {"", &C::beam, beam_error_table()}};
}

Lidar::Lidar(const Config& config, const WorldSensorSite& site)
    : config_{config},
      shapes_{site.shapes},
      position_B_{site.from_centre_of_mass(config.mounting)},
      errors_{config.beam, site.random, "world_sensors/" + site.name} {
  const Matrix3 R = R_BS(config.mounting);
  directions_B_.reserve(static_cast<std::size_t>(config.rays));
  for (int i = 0; i < config.rays; ++i) {
    const auto [sine, cosine] =
        portable::sin_cos(config.angle_min_rad + static_cast<double>(i) * lidar_step_rad(config));
    directions_B_.push_back(R * Vector3(cosine, -sine, 0.0));
  }
}

bool Lidar::measure(const Truth& truth, Sample& sample) {
  const Matrix3 R_WB = truth.body.q_WB.toRotationMatrix();
  const Vector3 origin_W = truth.body.p_W + R_WB * position_B_;
  sample.stamp = truth.time;
  sample.angle_min_rad = config_.angle_min_rad;
  sample.angle_step_rad = lidar_step_rad(config_);
  sample.min_m = config_.beam.min_m;
  sample.max_m = config_.beam.max_m;
  sample.ranges_m.clear();
  for (const Vector3& direction_B : directions_B_) {
    const auto hit = shapes_.cast({origin_W, R_WB * direction_B}, errors_.reach_m());
    sample.ranges_m.push_back(errors_.apply(hit.distance_m));
  }
  return true;
}

}  // namespace rosflight::sim
