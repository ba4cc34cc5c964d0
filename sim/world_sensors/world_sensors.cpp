// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world_sensors/world_sensors.hpp"

#include <algorithm>
#include <utility>

#include "base/constants.hpp"
#include "sim/portable_math.hpp"
#include "sim/sensors/read_config.hpp"
#include "sim/world_sensors/depth_camera.hpp"
#include "sim/world_sensors/lidar.hpp"
#include "sim/world_sensors/motion_capture.hpp"

namespace rosflight::sim {
namespace {

/// A part of a topic.
bool is_topic_name(const std::string& name) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  return !name.empty() && name[0] >= 'a' && name[0] <= 'z' &&
         std::all_of(name.begin(), name.end(), fits);
}

}  // namespace

Matrix3 R_BS(const Mounting& mounting) {
  const Vector3& rotation_deg = mounting.rotation_deg;
  const auto [sr, cr] = portable::sin_cos(rotation_deg.x() * base::kRadPerDeg);
  const auto [sp, cp] = portable::sin_cos(rotation_deg.y() * base::kRadPerDeg);
  const auto [sy, cy] = portable::sin_cos(rotation_deg.z() * base::kRadPerDeg);
  Matrix3 R;
  R << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,   //
      -sp, cp * sr, cp * cr;
  return R;
}

config::Table<Timing> timing_table() {
  return sensors::timing_table();
}

config::Table<Mounting> mounting_table() {
  using config::Range;
  return {{"position_m", &Mounting::position_m, "m", Range::between(-100.0, 100.0),
           "from the origin of the vehicle file, body axes"},
          {"rotation_deg", &Mounting::rotation_deg, "deg", Range::between(-360.0, 360.0),
           "roll, pitch, yaw: turns the body's axes into the sensor's"}};
}

config::Table<BeamErrorParameters> beam_error_table() {
  using E = BeamErrorParameters;
  using R = config::Row<E>;
  using config::Range;
  constexpr double kMaxRange_m = 1e5;
  constexpr Range kError = Range::between(0.0, 1000.0);
  return {{"min_m", &E::min_m, "m", Range::between(0.0, kMaxRange_m),
           "nearest distance that is measured"},
          R{"max_m", &E::max_m, "m", Range::positive_up_to(kMaxRange_m),
            "farthest distance that is measured"}
              .must("a number > min_m", [](const E& e) { return e.min_m < e.max_m; }),
          {"turn_on_bias_m", &E::turn_on_bias_m, "m", kError, "largest bias drawn at the start"},
          {"noise_sigma_m", &E::noise_sigma_m, "m", kError, "white noise of each beam"},
          {"noise_share", &E::noise_share, "", Range::between(0.0, 1.0),
           "of the distance, added to it in power"},
          {"resolution_m", &E::resolution_m, "m", kError, "step of the reading; 0: none"},
          {"dropout_share", &E::dropout_share, "", Range::between(0.0, 1.0),
           "of the beams gives no reading"}};
}

void check_rate(const WorldSensorSite& site, const Timing& timing) {
  if (timing.period >= site.step) return;
  const double max_Hz = 1e6 / static_cast<double>(site.step.count());
  throw site.section.error(
      "rate_Hz", site.section.raw("rate_Hz"),
      "a number up to " + config::number_text(max_Hz) + ", the rate of the simulation");
}

void register_world_sensors(Registry& registry) {
  registry.world_sensors.add("lidar", world_sensor<Lidar>());
  registry.world_sensors.add("depth_camera", world_sensor<DepthCamera>());
  registry.world_sensors.add("motion_capture", world_sensor<MotionCapture>());
}

WorldSensors::WorldSensors(const Registry& registry, const Vehicle& vehicle,
                           const world::WorldShapes& shapes, const RandomSource& random,
                           Time step) {
  const config::Section& all = vehicle.world_sensors();
  for (const std::string& name : all.keys()) {
    const config::Section section = all.section(name);
    if (!is_topic_name(name))
      throw section.error("the name " + name, "small letters, digits and _, a letter first");
    const std::string type = section.text("type");
    if (!registry.world_sensors.has(type)) {
      std::string known;
      for (const auto& one : registry.world_sensors.names())
        known += (known.empty() ? "" : ", ") + one;
      throw section.error("type", type, known);
    }
    const WorldSensorSite site{section, name, shapes, random, vehicle.body().centre_of_mass_B,
                               step};
    entries_.push_back({name, registry.world_sensors.at(type)(site)});
  }
}

}  // namespace rosflight::sim
