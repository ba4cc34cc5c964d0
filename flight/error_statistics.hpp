// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace rosflight::flight {

/// Root mean square and largest magnitude of errors, in the unit of the errors added.
struct ErrorStatistics {
  std::uint64_t count{};
  double sum_sq{};
  double max{};
  void add(double error) {
    ++count;
    sum_sq += error * error;
    max = std::max(max, std::abs(error));
  }
  /// 0 if nothing was added.
  double rms() const { return count == 0 ? 0.0 : std::sqrt(sum_sq / static_cast<double>(count)); }
};

}  // namespace rosflight::flight
