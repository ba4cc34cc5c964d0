// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gyro_record.hpp"

#include <algorithm>

namespace rosflight::flight {

void GyroRecord::sent(const hal::ImuSample& sample) {
  if (count_ > 0 && sent_[(count_ - 1) % kKept].stamp == sample.stamp) return;
  sent_[count_++ % kKept] = sample;
}

void GyroRecord::received(const link::Attitude& attitude) {
  for (std::size_t k = 1; k <= std::min(count_, kKept); ++k) {
    const hal::ImuSample& sample = sent_[(count_ - k) % kKept];
    if (hal::to_ms(sample.stamp) != static_cast<std::int64_t>(attitude.time_boot_ms)) continue;
    const hal::Time step = sample.stamp - last_;
    if (step == hal::Time{0}) return;
    const bool first = last_ < hal::Time{0} || step < hal::Time{0};
    if (!first && (period_ == hal::Time{0} || step < period_)) period_ = step;
    const bool joins = !first && 2 * step < 3 * period_;
    if (joins) {
      joined_ += step;
      ++joins_;
    } else {
      spectrum_.gap();
    }
    last_ = sample.stamp;
    spectrum_.add(sample.gyro_rad_s, attitude.rates_rad_s);
    return;
  }
}

GyroSpectrum GyroRecord::spectrum() const {
  if (joins_ == 0) return {};
  constexpr double kMicroseconds = 1e6;
  return spectrum_.result(kMicroseconds * static_cast<double>(joins_) /
                          static_cast<double>(joined_.count()));
}

}  // namespace rosflight::flight
