// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world_sensors/motion_capture.hpp"

#include "sim/portable_math.hpp"
#include "sim/sensors/read_config.hpp"

namespace rosflight::sim {

DropOuts::DropOuts(const Parameters& parameters, RandomStream stream)
    : parameters_{parameters}, stream_{stream} {
  change_ = parameters.interval_s > 0.0 ? random_duration(parameters.interval_s) : Time::max();
}

Time DropOuts::random_duration(double mean_s) {
  const double seconds = -mean_s * portable::log(1.0 - stream_.uniform());
  return Time{static_cast<std::int64_t>(seconds * 1e6) + 1};
}

bool DropOuts::active(Time now) {
  while (now >= change_) {
    active_ = !active_;
    change_ += random_duration(active_ ? parameters_.duration_s : parameters_.interval_s);
  }
  return active_;
}

config::Table<MotionCapture::Config> MotionCapture::parameters() {
  using C = Config;
  using R = config::Row<C>;
  using config::Range;
  constexpr double kMinDropout_s = 0.01;
  return {{"position_m", &C::position_m, sensors::vector_error_table(),
           "errors along north, east, down"},
          {"attitude_rad", &C::attitude_rad, sensors::vector_error_table(),
           "errors about the body's axes"},
          {"max_m", &C::max_m, "m", Range::positive_up_to(1e5),
           "farther from the origin there is no sample"},
          {"dropout_interval_s", config::at(&C::dropouts, &DropOuts::Parameters::interval_s), "s",
           Range::between(0.0, 1e6), "mean time between drop-outs; 0: none"},
          R{"dropout_duration_s", config::at(&C::dropouts, &DropOuts::Parameters::duration_s), "s",
            Range::between(0.0, 1e6), "mean"}
              .must("a number >= 0.01 where there are drop-outs", [](const C& c) {
                return c.dropouts.interval_s <= 0.0 || c.dropouts.duration_s >= kMinDropout_s;
              })};
}

MotionCapture::MotionCapture(const Config& config, const WorldSensorSite& site)
    : config_{config},
      position_{config.position_m, config.timing.period, site.random,
                "world_sensors/" + site.name + "/position"},
      attitude_{config.attitude_rad, config.timing.period, site.random,
                "world_sensors/" + site.name + "/attitude"},
      dropouts_{config.dropouts, site.random.stream("world_sensors/" + site.name + "/dropouts")} {}

bool MotionCapture::measure(const Truth& truth, Sample& sample) {
  sample.stamp = truth.time;
  sample.p_W = position_.apply(truth.body.p_W);
  const Vector3 half_B = 0.5 * attitude_.apply(Vector3::Zero());
  const Quaternion error(1.0, half_B.x(), half_B.y(), half_B.z());
  sample.q_WB = truth.body.q_WB * error;
  sample.q_WB.coeffs() /= sample.q_WB.norm();
  return !dropouts_.active(truth.time) && truth.body.p_W.norm() <= config_.max_m;
}

}  // namespace rosflight::sim
