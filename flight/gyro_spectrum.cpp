// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gyro_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <unsupported/Eigen/FFT>

#include "base/constants.hpp"

namespace rosflight::flight {

struct Spectrum::Transform {
  Transform() { engine.SetFlag(Eigen::FFT<double>::HalfSpectrum); }
  Eigen::FFT<double> engine;
};

Spectrum::Spectrum(Spectrum&&) noexcept = default;
Spectrum& Spectrum::operator=(Spectrum&&) noexcept = default;
Spectrum::~Spectrum() = default;

Spectrum::Spectrum() : transform_{std::make_unique<Transform>()} {
  for (std::size_t n = 0; n < kSegment; ++n) {
    const double angle = 2.0 * base::kPi * static_cast<double>(n) / kSegment;
    window_[n] = 0.5 - 0.5 * std::cos(angle);
  }
}

void Spectrum::add(const Rates& before, const Rates& after) {
  for (std::size_t axis = 0; axis < before.size(); ++axis) {
    if (!std::isfinite(before[axis]) || !std::isfinite(after[axis])) return gap();
    before_[axis][filled_] = static_cast<double>(before[axis]);
    after_[axis][filled_] = static_cast<double>(after[axis]);
  }
  if (++filled_ == kSegment) take_segment();
}

void Spectrum::transform(const Segment& x, std::array<Complex, kLines>& out) {
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / kSegment;
  Segment windowed{};
  for (std::size_t n = 0; n < kSegment; ++n) windowed[n] = window_[n] * (x[n] - mean);
  transform_->engine.fwd(out.data(), windowed.data(), kSegment);
}

void Spectrum::take_segment() {
  std::array<Complex, kLines> x;
  std::array<Complex, kLines> y;
  for (std::size_t axis = 0; axis < before_.size(); ++axis) {
    transform(before_[axis], x);
    transform(after_[axis], y);
    for (std::size_t k = 0; k < kLines; ++k) {
      power_before_[k] += std::norm(x[k]);
      power_after_[k] += std::norm(y[k]);
      cross_[k] += std::conj(x[k]) * y[k];
    }
    constexpr auto kHalf = static_cast<std::ptrdiff_t>(kSegment / 2);
    std::copy(before_[axis].begin() + kHalf, before_[axis].end(), before_[axis].begin());
    std::copy(after_[axis].begin() + kHalf, after_[axis].end(), after_[axis].begin());
  }
  filled_ = kSegment / 2;
  ++segments_;
}

GyroSpectrum Spectrum::result(double rate_Hz) const {
  GyroSpectrum out;
  if (segments_ == 0 || !(rate_Hz > 0.0)) return out;
  const double window_power =
      std::inner_product(window_.begin(), window_.end(), window_.begin(), 0.0);
  const double scale = 2.0 / (rate_Hz * window_power * static_cast<double>(segments_));
  double weighted_phase = 0.0;
  double weight = 0.0;
  double common = 0.0;
  double all = 0.0;
  for (std::size_t k = 1; k < kLines; ++k) {  // the mean is gone
    const double f = rate_Hz * static_cast<double>(k) / kSegment;
    out.frequency_Hz.push_back(f);
    out.before.push_back(std::sqrt(scale * power_before_[k]));
    out.after.push_back(std::sqrt(scale * power_after_[k]));
    if (f > kMaxDelay_Hz) continue;
    const double both = std::sqrt(power_before_[k] * power_after_[k]);
    if (!(both > 0.0)) continue;
    const double c = std::abs(cross_[k]) / both;
    weighted_phase += c * f * std::arg(cross_[k]);
    weight += c * f * f;
    common += c;
    all += 1.0;
  }
  constexpr double kAlike = 0.7;
  if (weight > 0.0 && common > kAlike * all) {
    out.latency_s = -weighted_phase / (2.0 * base::kPi * weight);
  }
  return out;
}

}  // namespace rosflight::flight
