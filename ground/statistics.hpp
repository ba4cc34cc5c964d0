// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>
#include <cstddef>

namespace rosflight::ground {

/// Mean and standard deviation of a series, by Welford's recurrence (Knuth, The Art of Computer
/// Programming, vol. 2, 3rd ed., sec. 4.2.2).
class Statistics {
 public:
  /// Adds a sample.
  void add(double x) {
    ++count_;
    const double before = x - mean_;
    mean_ += before / static_cast<double>(count_);
    squares_ += before * (x - mean_);
  }
  std::size_t count() const { return count_; }
  double mean() const { return mean_; }
  /// Standard deviation of the sample; 0 below two samples.
  double deviation() const {
    return count_ < 2 ? 0.0 : std::sqrt(squares_ / static_cast<double>(count_ - 1));
  }

 private:
  std::size_t count_{0};
  double mean_{0.0};
  double squares_{0.0};
};

}  // namespace rosflight::ground
