// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

#include "firmware/core/math.hpp"

namespace rosflight::core {

/// Filters of the rate gyro: a second-order Butterworth low-pass and a static notch, three axes.
///
///     low-pass   H(s) = W^2 / (s^2 + sqrt(2) W s + W^2)                                   (1)
///     notch      H(s) = (s^2 + W0^2) / (s^2 + B s + W0^2)                                 (2)
///
/// made discrete by the bilinear transform, prewarped: the low-pass is 1/sqrt(2) at its cut-off and
/// the notch 0 at its centre and 1/sqrt(2) at two frequencies its width apart, at every sample
/// rate. S. Orfanidis, Introduction to Signal Processing (2010), sec. 12.3 for (1), 11.3 for (2).
///
/// For a board that reads its gyro at 1 or 2 kHz and hands over every n-th sample, or for samples
/// at the IMU rate. Owns 0.2 kB; 27 multiplications a section and sample.
class GyroChain {
 public:
  /// Frequencies must be below this fraction of the sample rate: half of it, less the error of a
  /// measured rate.
  static constexpr float kMaxFrequencyRatio = 0.49f;

  struct Config {
    float sample_rate_Hz{0.0f};
    float low_pass_Hz{0.0f};       ///< 0: off.
    float notch_Hz{0.0f};          ///< 0: off.
    float notch_width_Hz{30.0f};   ///< Between the -3 dB points.
    float full_scale_rad_s{0.0f};  ///< Full scale of the sensor; 0: clipping is not counted.
  };

  /// The filters that configure() left off: their frequency is not below kMaxFrequencyRatio, or a
  /// number makes no filter.
  struct Refused {
    bool low_pass{false};
    bool notch{false};
  };

  GyroChain() = default;
  /// As configure().
  explicit GyroChain(const Config& config) { static_cast<void>(configure(config)); }

  /// Applies new settings. The first sample afterwards initialises the filters at its value.
  Refused configure(const Config& config);
  /// The next sample initialises the filters at its value.
  void reset() { settled_ = false; }

  /// @returns the filtered sample. A sample that is not finite is returned unchanged and not stored.
  Vector3 step(const Vector3& rate_rad_s);

  bool on() const { return low_pass_.on || notch_.on; }
  /// Samples of which an axis was at full scale.
  std::uint32_t clipped() const { return clipped_; }
  /// Delay by both filters of the envelope of an oscillation [s]; 0 from half the sample rate on.
  float group_delay_s(float frequency_Hz) const;

 private:
  /// H(z) = (b0 + b1 z^-1 + b2 z^-2) / (1 + a1 z^-1 + a2 z^-2), with b2 = b0: transposed direct
  /// form II.
  struct Section {
    bool on{false};
    float b0{1.0f}, b1{0.0f}, a1{0.0f}, a2{0.0f};
    Vector3 z1{Vector3::Zero()}, z2{Vector3::Zero()};

    void settle(const Vector3& x);
    Vector3 step(const Vector3& x);
    float delay_samples(float angle_rad) const;
  };

  Section low_pass_;
  Section notch_;
  float sample_rate_Hz_{0.0f};
  float clip_rad_s_{0.0f};
  std::uint32_t clipped_{0};
  bool settled_{false};
};

}  // namespace rosflight::core
