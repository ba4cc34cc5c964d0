// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sensors/gnss.hpp"

namespace rosflight::sim::sensors {
namespace {
constexpr std::int64_t kMicrosecondsPerSecond = 1'000'000;
}

Gnss::Gnss(const Config& config, const Geodetic& origin, std::int64_t start_unix_s,
           const RandomSource& source)
    : config_{config},
      frame_{origin},
      start_unix_s_{start_unix_s},
      north_{config.horizontal_m, config.timing.period, source, "sensors/gnss/north"},
      east_{config.horizontal_m, config.timing.period, source, "sensors/gnss/east"},
      down_{config.vertical_m, config.timing.period, source, "sensors/gnss/down"},
      velocity_{config.velocity_m_s, config.timing.period, source, "sensors/gnss/velocity"},
      dropouts_{source.stream("sensors/gnss/dropouts")},
      change_{Time{static_cast<std::int64_t>(config.first_fix_s * 1e6)}} {}

Time Gnss::random_duration(double mean_s) {
  const double seconds = -mean_s * portable::log(1.0 - dropouts_.uniform());
  return Time{static_cast<std::int64_t>(seconds * 1e6)};
}

bool Gnss::has_fix(Time now) {
  while (now >= change_) {
    fix_ = !fix_;
    if (fix_ && config_.dropout_interval_s <= 0.0) {
      change_ = Time::max();
    } else {
      const double mean_s = fix_ ? config_.dropout_interval_s : config_.dropout_duration_s;
      change_ += random_duration(mean_s) + Time{1};
    }
  }
  return fix_;
}

bool Gnss::measure(const Truth& truth, Sample& sample) {
  const Vector3& r = config_.position_m;
  const Vector3 p_W = truth.body.p_W + truth.body.q_WB * r;
  const Vector3 v_W = truth.body.q_WB * (truth.body.v_B + truth.body.w_B.cross(r));
  const Vector3 measured_p_W{north_.apply(p_W.x()), east_.apply(p_W.y()), down_.apply(p_W.z())};
  const Vector3 measured_v_W = velocity_.apply(v_W);
  const std::int64_t time_us = truth.time.count();

  sample = {};
  sample.stamp = truth.time;
  sample.unix_s = start_unix_s_ + time_us / kMicrosecondsPerSecond;
  sample.unix_ns = static_cast<std::int32_t>(time_us % kMicrosecondsPerSecond * 1000);
  if (has_fix(truth.time)) {
    last_ = frame_.to_geodetic(measured_p_W);
    sample.fix = hal::GnssFix::k3d;
    sample.satellites = static_cast<std::uint8_t>(config_.satellites);
    sample.velocity_ned_m_s = to_floats(measured_v_W);
    sample.horizontal_accuracy_m = static_cast<float>(config_.horizontal_accuracy_m);
    sample.vertical_accuracy_m = static_cast<float>(config_.vertical_accuracy_m);
    sample.speed_accuracy_m_s = static_cast<float>(config_.speed_accuracy_m_s);
  } else {
    sample.horizontal_accuracy_m = kNoAccuracy;
    sample.vertical_accuracy_m = kNoAccuracy;
    sample.speed_accuracy_m_s = kNoAccuracy;
  }
  sample.latitude_deg = last_.latitude_deg;
  sample.longitude_deg = last_.longitude_deg;
  sample.height_msl_m = static_cast<float>(last_.altitude_m);
  return true;
}

}  // namespace rosflight::sim::sensors
