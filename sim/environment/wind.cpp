// SPDX-License-Identifier: BSD-3-Clause
#include "sim/environment/wind.hpp"

#include <cmath>

#include "sim/portable_math.hpp"

namespace rosflight::sim {
namespace {

constexpr double kTwoPi = 6.283185307179586;

double exponential(RandomStream& stream, double mean) {
  return -mean * portable::log(1.0 - stream.uniform());
}

Vector3 normal_vector(RandomStream& stream) {
  const double x = stream.normal();
  const double y = stream.normal();
  const double z = stream.normal();
  return {x, y, z};
}

}  // namespace

Wind::Wind(const WindParameters& parameters, const RandomSource& source)
    : gust_parameters_{parameters.gusts},
      steady_W_{parameters.steady_W_m_s},
      gust_stream_{source.stream("wind/gusts")},
      calm_{parameters.turbulence_w20_m_s <= 0.0 && parameters.gusts.mean_interval_s <= 0.0} {
  RandomStream draw = source.stream("wind/steady");
  steady_W_ += parameters.random_std_W_m_s.cwiseProduct(normal_vector(draw));
  set_steady(steady_W_);
  if (parameters.turbulence_w20_m_s > 0.0)
    turbulence_.emplace(parameters.turbulence_w20_m_s, source);
  if (gust_parameters_.mean_interval_s > 0.0) {
    gusts_.reserve(kMaxGusts);
    next_gust_s_ = exponential(gust_stream_, gust_parameters_.mean_interval_s);
  }
}

void Wind::set_steady(const Vector3& steady_W) {
  steady_W_ = steady_W;
  const double speed = steady_W_.norm();
  direction_W_ = speed > 1e-9 ? Vector3(steady_W_ / speed) : Vector3(Vector3::Zero());
  const double horizontal =
      std::sqrt(steady_W_.x() * steady_W_.x() + steady_W_.y() * steady_W_.y());
  if (horizontal > 1e-9) along_W_ = Vector3(steady_W_.x(), steady_W_.y(), 0.0) / horizontal;
  velocity_W_ = steady_W_;
}

void Wind::set(const Vector3& steady_W_m_s, double w20_m_s, const RandomSource& source) {
  set_steady(steady_W_m_s);
  turbulence_.reset();
  if (w20_m_s > 0.0) turbulence_.emplace(w20_m_s, source);
  calm_ = !turbulence_ && gust_parameters_.mean_interval_s <= 0.0;
}

void Wind::add_gust(const Vector3& peak_W_m_s, double duration_s) {
  if (gusts_.size() < kMaxGusts) gusts_.push_back({peak_W_m_s, duration_s, 0.0});
}

Wind::Gust Wind::draw_gust(double age_s) {
  double magnitude = -1.0;
  while (magnitude < 0.0) {
    magnitude = gust_parameters_.magnitude_mean_m_s +
                gust_parameters_.magnitude_std_m_s * gust_stream_.normal();
  }
  Vector3 direction = direction_W_;
  const double spread = direction_W_.isZero() ? 1.0 : gust_parameters_.direction_std;
  do {
    direction = direction_W_ + spread * normal_vector(gust_stream_);
  } while (direction.squaredNorm() < 1e-12);
  const double duration = gust_stream_.uniform(gust_parameters_.min_s, gust_parameters_.max_s);
  return {magnitude * direction.normalized(), duration, age_s};
}

void Wind::step_gusts(double dt_s) {
  for (auto& gust : gusts_) gust.age_s += dt_s;
  if (gust_parameters_.mean_interval_s > 0.0) next_gust_s_ -= dt_s;
  while (gust_parameters_.mean_interval_s > 0.0 && next_gust_s_ <= 0.0) {
    const Gust gust = draw_gust(-next_gust_s_);
    if (gusts_.size() < kMaxGusts) gusts_.push_back(gust);
    next_gust_s_ += exponential(gust_stream_, gust_parameters_.mean_interval_s);
  }
  std::erase_if(gusts_, [](const Gust& gust) { return gust.age_s >= gust.duration_s; });
  for (const auto& gust : gusts_) {
    const double phase = kTwoPi * gust.age_s / gust.duration_s;
    velocity_W_ += 0.5 * (1.0 - portable::sin_cos(phase).cos) * gust.peak_W;
  }
}

const Vector3& Wind::step(double dt_s, double height_m, double airspeed_m_s) {
  if (calm()) return velocity_W_;
  velocity_W_ = steady_W_;
  if (turbulence_) {
    const Vector3 gust = turbulence_->step(dt_s, height_m, airspeed_m_s);
    const Vector3 right_W(-along_W_.y(), along_W_.x(), 0.0);
    velocity_W_ += gust.x() * along_W_ + gust.y() * right_W + Vector3(0.0, 0.0, gust.z());
  }
  if (gust_parameters_.mean_interval_s > 0.0 || !gusts_.empty()) step_gusts(dt_s);
  return velocity_W_;
}

}  // namespace rosflight::sim
