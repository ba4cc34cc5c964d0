// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>

#include "firmware/hal/samples.hpp"
#include "flight/gyro_spectrum.hpp"
#include "link/messages.hpp"

namespace rosflight::flight {

/// What the IMU gave and what the controller was given of it: pairs the samples
/// that went to the board with the rates that came back in attitude messages, by their stamps.
class GyroRecord {
 public:
  /// A sample on its way to the board; its stamp is the firmware's time. The same again is nothing.
  void sent(const hal::ImuSample& sample);
  /// Rates of the sample with the same millisecond; none of the last few: left out.
  void received(const link::Attitude& attitude);

  GyroSpectrum spectrum() const;

 private:
  static constexpr std::size_t kKept = 64;  ///< More than a real-time link is late.

  std::array<hal::ImuSample, kKept> sent_{};
  std::size_t count_{0};
  Spectrum spectrum_;
  hal::Time last_{-1};
  hal::Time joined_{};  ///< Time between samples that follow each other, summed.
  hal::Time period_{};  ///< The shortest seen.
  std::size_t joins_{0};
};

}  // namespace rosflight::flight
