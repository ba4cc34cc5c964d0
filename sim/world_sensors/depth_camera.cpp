// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world_sensors/depth_camera.hpp"

#include "sim/portable_math.hpp"

namespace rosflight::sim {

config::Table<DepthCamera::Config> DepthCamera::parameters() {
  using C = Config;
  constexpr config::Whole kPixels{1, 2000};
  return {{"width_px", &C::width_px, "px", kPixels, "of the image"},
          {"height_px", &C::height_px, "px", kPixels, "of the image"},
          {"fov_deg", &C::fov_rad, config::kDeg, config::Range::between(1.0, 170.0),
           "field of view, horizontal"},
          {"", &C::beam, beam_error_table()}};
}

DepthCamera::DepthCamera(const Config& config, const WorldSensorSite& site)
    : config_{config},
      shapes_{site.shapes},
      position_B_{site.from_centre_of_mass(config.mounting)},
      errors_{config.beam, site.random, "world_sensors/" + site.name} {
  const auto [sine, cosine] = portable::sin_cos(0.5 * config.fov_rad);
  focal_px_ = 0.5 * config.width_px * cosine / sine;
  const Matrix3 R = R_BS(config.mounting);
  const double center_u = 0.5 * (config.width_px - 1);
  const double center_v = 0.5 * (config.height_px - 1);
  for (int v = 0; v < config.height_px; ++v) {
    for (int u = 0; u < config.width_px; ++u) {
      const Vector3 d_S(1.0, (u - center_u) / focal_px_, (v - center_v) / focal_px_);
      pixels_.push_back({R * d_S / d_S.norm(), 1.0 / d_S.norm()});
    }
  }
}

bool DepthCamera::measure(const Truth& truth, Sample& sample) {
  const Matrix3 R_WB = truth.body.q_WB.toRotationMatrix();
  const Vector3 origin_W = truth.body.p_W + R_WB * position_B_;
  sample.stamp = truth.time;
  sample.width_px = config_.width_px;
  sample.height_px = config_.height_px;
  sample.focal_px = focal_px_;
  sample.depths_m.clear();
  for (const Pixel& pixel : pixels_) {
    const auto hit =
        shapes_.cast({origin_W, R_WB * pixel.direction_B}, errors_.reach_m() / pixel.cosine);
    sample.depths_m.push_back(errors_.apply(hit.distance_m * pixel.cosine));
  }
  return true;
}

}  // namespace rosflight::sim
